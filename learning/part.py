"""The settings of a kind of part: geometry, contact, alignment, insertion and own limits."""

from collections.abc import Iterator
from typing import Annotated

from annotated_types import Ge, Gt, Le, MaxLen, MinLen
from pydantic import Field, model_validator

from controllers.limits import PartLimits
from controllers.settings import InsertionSettings
from drivers.contract.settings import DEGREES, KILO, MICRO, Settings, written
from simulator.contact import ContactLaw
from simulator.geometry import Hole, Part, Shaft

_GAP = "greater than 0 and at most 100000"
_Size = Annotated[float, Gt(0), Le(100_000), MICRO]


class ShaftSettings(Settings):
    """The shaft, a straight cylinder."""

    diameter_m: _Size = Field(alias="diameter_um")
    length_m: _Size = Field(alias="length_um")


class HoleSettings(Settings):
    """A hole through one wall."""

    diameter_m: _Size = Field(alias="diameter_um")
    thickness_m: _Size = Field(alias="thickness_um")
    gap_m: Annotated[float, Ge(0), Le(100_000), MICRO] = Field(0.0, alias="gap_um")
    """Free space after the hole before; none before the first."""


class ContactSettings(Settings):
    """How walls and shaft answer to contact."""

    stiffness_N_m: Annotated[float, Gt(0), Le(1_000), KILO] = Field(alias="stiffness_mN_um")
    friction: Annotated[float, Ge(0), Le(2)]


class AlignmentSettings(Settings):
    """What alignment leaves for the insertion to make good."""

    position_error_m: Annotated[float, Ge(0), Le(1_000), MICRO] = Field(alias="position_error_um")
    tilt_error_rad: Annotated[float, Ge(0), Le(5), DEGREES] = Field(alias="tilt_error_deg")


class PartSettings(Settings):
    """All that a cell knows of one kind of part. A shaft thicker than a hole is valid."""

    name: Annotated[str, MinLen(1), MaxLen(80)]
    shaft: ShaftSettings
    holes: Annotated[tuple[HoleSettings, ...], MinLen(1)]
    """From the one entered first."""
    contact: ContactSettings
    alignment: AlignmentSettings
    insertion: InsertionSettings
    limits: PartLimits = PartLimits()

    @model_validator(mode="after")
    def _check(self) -> "PartSettings":
        if problems := [*self._problems()]:
            raise ValueError("\n".join(problems))
        return self

    def _problems(self) -> Iterator[str]:
        first, *others = self.holes
        if first.gap_m > 0.0:
            gap = written(HoleSettings, "gap_m", first.gap_m)
            yield f"holes[0].{gap} is not valid: must be 0, there is no hole before the first"
        for number, hole in enumerate(others, start=1):
            if "gap_m" not in hole.model_fields_set:
                yield f"holes[{number}].gap_um is missing: must be a number {_GAP}, in um"
            elif hole.gap_m == 0.0:
                yield f"holes[{number}].gap_um = 0 is not valid: must be {_GAP}"
        stroke = written(InsertionSettings, "stroke_m", self.insertion.stroke_m)
        if self.insertion.stroke_m > self.shaft.length_m:
            length = written(ShaftSettings, "length_m", self.shaft.length_m)
            yield f"insertion.{stroke} is not valid: must not exceed shaft.{length}"
        if self.insertion.stroke_m <= (rim := self._last_upper_rim_m):
            yield (
                f"insertion.{stroke} is not valid: must be greater than {rim * 1e6:.12g}, "
                "the depth at which the last hole begins"
            )

    @property
    def _last_upper_rim_m(self) -> float:
        before = sum(hole.thickness_m for hole in self.holes[:-1])
        return before + sum(hole.gap_m for hole in self.holes)

    def simulated_shaft(self) -> Shaft:
        """Return the shaft as the simulator takes it."""
        return Shaft(diameter_m=self.shaft.diameter_m, length_m=self.shaft.length_m)

    def simulated_part(self) -> Part:
        """Return the holes as the simulator takes them."""
        return Part(
            holes=tuple(
                Hole(diameter_m=h.diameter_m, thickness_m=h.thickness_m, gap_m=h.gap_m)
                for h in self.holes
            )
        )

    def contact_law(self) -> ContactLaw:
        """Return the contact as the simulator takes it."""
        return ContactLaw(stiffness_N_m=self.contact.stiffness_N_m, friction=self.contact.friction)
