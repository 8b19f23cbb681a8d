"""Numba's decorators with types: the only place where compiled code is untyped."""

from collections.abc import Callable
from functools import cache
from hashlib import sha256
from pathlib import Path
from typing import Any, TypeVar, cast

from llvmlite import ir  # type: ignore[import-untyped]  # has no types
from numba import njit, types
from numba.core.caching import FunctionCache
from numba.extending import intrinsic

Function = TypeVar("Function", bound=Callable[..., Any])
Record = Any
"""One element of a structured array, whose fields are arrays."""
Internal = Any
"""An object of Numba's compiler."""


def inlined(function: Function) -> Function:
    """Compile a function that its callers take in whole.

    A call proper that passes an array counts its references, as long as ten operations take.
    IEEE arithmetic, nothing contracted or reordered: the same bits in vectors and one by one.
    """
    return cast(Function, njit(function, error_model="numpy", forceinline=True))


def scalar(function: Function) -> Function:
    """Compile a function that is called where nothing can be done in vectors."""
    return cast(Function, njit(function, error_model="numpy"))


def kernel(function: Function) -> Function:
    """Compile a loop over arrays, free of the interpreter's lock, and keep it on disk."""
    dispatcher = njit(function, error_model="numpy", nogil=True)
    dispatcher._cache = _PackageCache(function)
    return cast(Function, dispatcher)


@intrinsic
def _prefetch(typing: Internal, address: Internal) -> Internal:
    def generate(
        context: Internal, builder: Internal, signature: Internal, given: Internal
    ) -> Internal:
        byte, number = ir.IntType(8).as_pointer(), ir.IntType(32)
        kind = ir.FunctionType(ir.VoidType(), [byte, number, number, number])
        function = builder.module.declare_intrinsic("llvm.prefetch", [byte], kind)
        to_write, to_the_nearest_cache, data = (ir.Constant(number, flag) for flag in (1, 3, 1))
        pointer = builder.inttoptr(given[0], byte)
        builder.call(function, [pointer, to_write, to_the_nearest_cache, data])
        return context.get_dummy_value()

    return types.void(types.uintp), generate


prefetch = cast(Callable[[int], None], _prefetch)
"""Have the cache fetch the line at an address, to be written to; nothing waits for it."""


class _PackageCache(FunctionCache):
    """Keeps compiled code until any file of the kernel's folder changes, not only its own."""

    def __init__(self, function: Callable[..., Any]) -> None:
        super().__init__(function)  # type: ignore[no-untyped-call]  # in numba
        self._source = _source(Path(function.__code__.co_filename).parent)

    def _index_key(self, sig: object, codegen: object) -> tuple[object, ...]:
        key = super()._index_key(sig, codegen)  # type: ignore[no-untyped-call]  # in numba
        return (*key, self._source)


@cache
def _source(folder: Path) -> str:
    """Digest of all Python files of a folder."""
    return sha256(b"".join(path.read_bytes() for path in sorted(folder.glob("*.py")))).hexdigest()
