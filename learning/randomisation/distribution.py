"""A distribution as people write it: one key that names it, with its numbers."""

from dataclasses import dataclass
from typing import Annotated

from annotated_types import Ge, Gt, Le, MinLen
from pydantic import (
    AfterValidator,
    GetCoreSchemaHandler,
    TypeAdapter,
    ValidationError,
    model_validator,
)
from pydantic_core import CoreSchema, PydanticCustomError, core_schema

from drivers.contract.configuration.describe import Accepted
from drivers.contract.configuration.problems import INVALID
from drivers.contract.settings import Scale, Settings
from simulator.randomisation.distributions import (
    Choice,
    Constant,
    Distribution,
    LogUniform,
    TruncatedNormal,
    Uniform,
)

Pair = tuple[float, float]


def _in_order(pair: Pair) -> Pair:
    if not pair[0] < pair[1]:
        raise PydanticCustomError(INVALID, "a low and a high end, low less than high")
    return pair


def _above_zero(pair: Pair) -> Pair:
    if not 0.0 < pair[0] < pair[1]:
        raise PydanticCustomError(INVALID, "a low and a high end, 0 less than low less than high")
    return pair


class TruncatedNormalSettings(Settings):
    """A normal distribution, cut at both ends."""

    mean: float
    """Before it is cut."""
    std: Annotated[float, Gt(0)]
    """Before it is cut."""
    low: float
    high: float

    @model_validator(mode="after")
    def _check(self) -> "TruncatedNormalSettings":
        if not (self.low < self.high and self.low <= self.mean <= self.high):
            raise PydanticCustomError(INVALID, "such that low < high and low <= mean <= high")
        return self


class DistributionSettings(Settings):
    """What a number is drawn from. Exactly one of the keys is set."""

    constant: float | None = None
    uniform: Annotated[Pair, AfterValidator(_in_order)] | None = None
    log_uniform: Annotated[Pair, AfterValidator(_above_zero)] | None = None
    truncated_normal: TruncatedNormalSettings | None = None
    choice: Annotated[tuple[float, ...], MinLen(1)] | None = None

    @model_validator(mode="after")
    def _check(self) -> "DistributionSettings":
        if len(self.model_fields_set) != 1:
            valid = ", ".join(type(self).model_fields)
            raise PydanticCustomError(INVALID, f"exactly one of {valid}")
        return self

    @property
    def ends(self) -> Pair:
        """The least and the greatest value that can be drawn, in the unit of the numbers."""
        match self.distribution():
            case Constant(value):
                return value, value
            case Choice(values):
                return min(values), max(values)
            case Uniform(low, high) | LogUniform(low, high) | TruncatedNormal(_, _, low, high):
                return low, high

    def scaled(self, scale: Scale) -> "DistributionSettings":
        """Return the same with all its numbers in the SI unit."""
        (name,) = self.model_fields_set
        value = getattr(self, name)
        if isinstance(value, TruncatedNormalSettings):
            numbers = {key: scale.to_si(number) for key, number in value.model_dump().items()}
            return self.model_copy(update={name: value.model_copy(update=numbers)})
        return self.model_copy(update={name: scale.to_si(value)})

    def distribution(self) -> Distribution:
        """Return the distribution as the simulator takes it."""
        if self.constant is not None:
            return Constant(self.constant)
        if self.uniform is not None:
            return Uniform(*self.uniform)
        if self.log_uniform is not None:
            return LogUniform(*self.log_uniform)
        if self.truncated_normal is not None:
            return TruncatedNormal(**self.truncated_normal.model_dump())
        if self.choice is not None:
            return Choice(self.choice)
        raise LookupError("none of the keys is set")


OFF = DistributionSettings(constant=0.0)


@dataclass(frozen=True, slots=True)
class Spread:
    """Refuses a distribution that reaches beyond a range, in the key's unit, and makes it SI."""

    lowest: Ge | Gt
    highest: Le
    scale: Scale

    def __get_pydantic_core_schema__(
        self, source: object, handler: GetCoreSchemaHandler
    ) -> CoreSchema:
        return core_schema.no_info_after_validator_function(self._in_si, handler(source))

    def _in_si(self, written: DistributionSettings) -> DistributionSettings:
        ends = TypeAdapter(Annotated[float, self.lowest, self.highest])
        try:
            for end in written.ends:
                ends.validate_python(end)
        except ValidationError as error:
            valid = Accepted.of(float, (self.lowest, self.highest)).range
            raise PydanticCustomError(INVALID, f"{valid} throughout") from error
        return written.scaled(self.scale)
