"""Settings as people write them, values as the code uses them.

A key carries its unit (`speed_limit_mm_s`), the attribute its SI unit (`speed_limit_m_s`). Ranges
are checked in the written unit; the conversion happens once, here.
"""

import math
from dataclasses import dataclass
from itertools import chain
from typing import Annotated, TypeVar, get_args

from annotated_types import Gt
from pydantic import BaseModel, ConfigDict, GetCoreSchemaHandler
from pydantic_core import CoreSchema, core_schema

Number = TypeVar("Number", float, tuple[float, ...])


class Settings(BaseModel):
    """A strict, frozen group of settings: no unknown keys, wrong types, NaN or infinity."""

    model_config = ConfigDict(strict=True, extra="forbid", frozen=True, allow_inf_nan=False)


@dataclass(frozen=True, slots=True)
class Scale:
    """Converts a number, or each number of a tuple: SI value = written value * times / by.

    Division by a power of ten gives the float nearest to the true value, so 35 um is 3.5e-05.
    """

    times: float
    by: float

    def to_si(self, written: Number) -> Number:
        """Return the value in the SI unit."""
        if isinstance(written, tuple):
            return tuple(v * self.times / self.by for v in written)
        return written * self.times / self.by

    def to_written(self, si: Number) -> Number:
        """Return the value in the unit of the key."""
        if isinstance(si, tuple):
            return tuple(v * self.by / self.times for v in si)
        return si * self.by / self.times

    def __get_pydantic_core_schema__(
        self, source: object, handler: GetCoreSchemaHandler
    ) -> CoreSchema:
        return core_schema.no_info_after_validator_function(self.to_si, handler(source))


def written(settings: type[Settings], attribute: str, si_value: float | tuple[float, ...]) -> str:
    """Return `key = value` for an attribute of `settings`, in the key's unit."""
    field = settings.model_fields[attribute]
    # What may also be None has its unit within the union.
    options = [getattr(option, "__metadata__", ()) for option in get_args(field.annotation)]
    known = chain(field.metadata, *options)
    scale = next((m for m in known if isinstance(m, Scale)), ONE)
    if isinstance(si_value, tuple):
        shown = f"[{', '.join(f'{v:.12g}' for v in scale.to_written(si_value))}]"
    else:
        shown = f"{scale.to_written(si_value):.12g}"
    return f"{field.alias or attribute} = {shown}"


ONE = Scale(1.0, 1.0)
"""No unit, the SI unit itself, or urad/(uN m) -> rad/(N m)"""
NANO = Scale(1.0, 1e9)
"""nN m/sqrt(Hz) -> N m/sqrt(Hz)"""
MICRO = Scale(1.0, 1e6)
"""um -> m, um/N -> m/N"""
MILLI = Scale(1.0, 1e3)
"""mN -> N, mm/s -> m/s, ms -> s, um/mN -> m/N"""
PERCENT = Scale(1.0, 100.0)
"""% -> 1"""
KILO = Scale(1e3, 1.0)
"""mN/um -> N/m"""
DEGREES = Scale(math.pi, 180.0)
"""deg -> rad, deg/s -> rad/s"""

Positive = Annotated[float, Gt(0)]
PositiveTriple = tuple[Positive, Positive, Positive]
