"""What a key accepts, in people's words, read from the models."""

import types
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Annotated, Any, Literal, Union, get_args, get_origin

from annotated_types import Ge, Gt, Le, Lt, MaxLen, MinLen

from drivers.contract.settings import Settings

_NOUNS = {float: "a number", int: "a whole number", bool: "true or false", str: "text"}

_UNITS = {
    "nNm_rtHz": "nN m/sqrt(Hz)",
    "uN_rtHz": "uN/sqrt(Hz)",
    "um_rts": "um/sqrt(s)",
    "deg_rts": "deg/sqrt(s)",
    "N_s2": "N/s2",
    "Nm_s2": "N m/s2",
    "N_s": "N/s",
    "mN_s": "mN s",
    "mN_um": "mN/um",
    "um_N": "um/N",
    "um_mN": "um/mN",
    "urad_uNm": "urad/(uN m)",
    "mm_s2": "mm/s2",
    "mm_s": "mm/s",
    "deg_s": "deg/s",
    "uNm": "uN m",
    "mN": "mN",
    "um": "um",
    "deg": "deg",
    "ms": "ms",
    "percent": "%",
    "Hz": "Hz",
    "s": "s",
}
"""Ends of keys and the units that they stand for; of two that fit, the longer one counts."""


def keys(model: type[Settings]) -> list[str]:
    """Return the keys of a model as they are written."""
    return [field.alias or name for name, field in model.model_fields.items()]


def unit_of(key: str) -> tuple[str, str]:
    """Split a key into its end and the unit that this stands for; both empty where it has none."""
    ends = [end for end in _UNITS if key.endswith(f"_{end}")]
    end = max(ends, key=len, default="")
    return end, _UNITS.get(end, "")


@dataclass(frozen=True, slots=True)
class Accepted:
    """The values that one key, or one entry of a list, accepts."""

    annotation: Any
    constraints: tuple[object, ...]

    @classmethod
    def of(cls, annotation: object, constraints: Sequence[object] = ()) -> "Accepted":
        """Take apart annotated and optional types."""
        origin, arguments = get_origin(annotation), get_args(annotation)
        if origin is Annotated:
            return cls.of(arguments[0], (*constraints, *arguments[1:]))
        if origin in (Union, types.UnionType):
            return cls.of(arguments[0], constraints)
        return cls(annotation, tuple(constraints))

    @property
    def is_list(self) -> bool:
        """Whether a list is accepted."""
        return get_origin(self.annotation) is tuple

    @property
    def model(self) -> type[Settings] | None:
        """The model of a group of keys; None where something else is accepted."""
        kind = self.annotation
        return kind if isinstance(kind, type) and issubclass(kind, Settings) else None

    @property
    def is_text(self) -> bool:
        """Whether any text is accepted."""
        return self.annotation is str

    @property
    def is_number(self) -> bool:
        """Whether a number is accepted."""
        return self.annotation in (float, int)

    @property
    def range(self) -> str:
        """The range in words; empty where there is none."""
        return " and ".join(_bounds(self.constraints))

    @property
    def description(self) -> str:
        """Type and range in words."""
        origin, arguments = get_origin(self.annotation), get_args(self.annotation)
        if origin is tuple and arguments[-1] is Ellipsis:
            is_demanded = any(isinstance(c, MinLen) for c in self.constraints)
            return "a list with at least one entry" if is_demanded else "a list"
        if origin is tuple:
            bounds = Accepted.of(arguments[0]).range
            things = "texts" if arguments[0] is str else "numbers"
            return f"a list of {len(arguments)} {things}{f', each {bounds}' if bounds else ''}"
        if origin is Literal:
            return " or ".join(str(a) for a in arguments)
        if origin is dict:
            return "a mapping of names to groups of keys"
        if self.model:
            return f"a group of keys: {', '.join(keys(self.model))}"
        return f"{_NOUNS[self.annotation]} {self.range}".rstrip()

    def inside(self, step: str | int) -> "Accepted":
        """Return what is accepted one step further along a path of keys and indices."""
        origin, arguments = get_origin(self.annotation), get_args(self.annotation)
        if origin is tuple:
            return Accepted.of(arguments[0])
        if origin is dict:
            return Accepted.of(arguments[1])
        if self.model:
            for name, field in self.model.model_fields.items():
                if step == (field.alias or name):
                    return Accepted.of(field.annotation, field.metadata)
        raise LookupError(f"{step} leads nowhere in {self.annotation}")


def _bounds(constraints: Sequence[object]) -> Iterator[str]:
    for constraint in constraints:
        match constraint:
            case Gt(gt=bound):
                yield f"greater than {bound:.12g}"
            case Ge(ge=bound):
                yield f"at least {bound:.12g}"
            case Lt(lt=bound):
                yield f"less than {bound:.12g}"
            case Le(le=bound):
                yield f"at most {bound:.12g}"
            case MaxLen(max_length=length):
                yield f"of 1 to {length} characters"
