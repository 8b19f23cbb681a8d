"""Numba's decorators with types: the only place where compiled code is untyped."""

from collections.abc import Callable
from functools import cache
from hashlib import sha256
from pathlib import Path
from typing import Any, TypeVar, cast

from numba import njit
from numba.core.caching import FunctionCache

Function = TypeVar("Function", bound=Callable[..., Any])
Record = Any
"""One element of a structured array, whose fields are arrays."""


def inlined(function: Function) -> Function:
    """Compile a function of numbers that its callers take in whole.

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
