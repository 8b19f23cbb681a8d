"""Settings of what the sizes of shaft and holes are drawn from."""

from collections.abc import Iterator
from typing import Annotated

from annotated_types import Ge, Gt, Le
from pydantic import Field, model_validator

from drivers.contract.settings import MICRO, Settings
from learning.randomisation.distribution import OFF, DistributionSettings, Spread
from simulator.randomisation.geometry import (
    SHARP,
    ChamferDistribution,
    HoleDistribution,
    ShaftDistribution,
)

_Size = Annotated[DistributionSettings, Spread(Gt(0), Le(100_000), MICRO)]
Clearance = Annotated[DistributionSettings, Spread(Ge(-100), Le(1_000), MICRO)]


class ChamferDistributionSettings(Settings):
    """A chamfer in place of a sharp edge."""

    width_m: _Size = Field(alias="width_um")
    """What it takes off radially."""
    height_m: _Size = Field(alias="height_um")
    """What it takes off axially."""

    def distribution(self) -> ChamferDistribution:
        """Return the chamfer as the simulator takes it."""
        return ChamferDistribution(self.width_m.distribution(), self.height_m.distribution())


class ShaftDistributionSettings(Settings):
    """The shaft, a cylinder. Its ends are sharp, unless stated otherwise."""

    diameter_m: _Size = Field(alias="diameter_um")
    length_m: _Size = Field(alias="length_um")
    leading_chamfer: ChamferDistributionSettings | None = None
    leading_rounding_m: _Size | None = Field(None, alias="leading_rounding_um")
    trailing_chamfer: ChamferDistributionSettings | None = None

    @model_validator(mode="after")
    def _check(self) -> "ShaftDistributionSettings":
        if problems := [*self._problems()]:
            raise ValueError("\n".join(problems))
        return self

    def _problems(self) -> Iterator[str]:
        if self.leading_chamfer is not None and self.leading_rounding_m is not None:
            yield (
                "leading_rounding_um is not valid beside leading_chamfer: the leading end has one "
                "of the two"
            )
            return
        radius_m = 0.5 * self.diameter_m.ends[0]
        taken_m = 0.0
        for key, width, height in self._worked_ends():
            if (widest_m := width.ends[1]) >= radius_m:
                yield (
                    f"{key} reaches {_um(widest_m)}: must be below {_um(radius_m)} throughout, "
                    "the radius of the thinnest shaft"
                )
            taken_m += height.ends[1]
        if taken_m >= (shortest_m := self.length_m.ends[0]):
            yield (
                f"length_um reaches {_um(shortest_m)}: must be above {_um(taken_m)} throughout, "
                "the length of the worked ends"
            )

    def _worked_ends(self) -> Iterator[tuple[str, DistributionSettings, DistributionSettings]]:
        """The key that states the width of each end that is not sharp, its width and its height."""
        if self.leading_chamfer is not None:
            chamfer = self.leading_chamfer
            yield "leading_chamfer.width_um", chamfer.width_m, chamfer.height_m
        if self.leading_rounding_m is not None:
            yield "leading_rounding_um", self.leading_rounding_m, self.leading_rounding_m
        if self.trailing_chamfer is not None:
            chamfer = self.trailing_chamfer
            yield "trailing_chamfer.width_um", chamfer.width_m, chamfer.height_m

    def distribution(self) -> ShaftDistribution:
        """Return the shaft as the simulator takes it."""
        return ShaftDistribution(
            self.diameter_m.distribution(),
            self.length_m.distribution(),
            leading=_chamfer(self.leading_chamfer),
            rounding_m=(self.leading_rounding_m or OFF).distribution(),
            trailing=_chamfer(self.trailing_chamfer),
        )


class HoleDistributionSettings(Settings):
    """A hole through one wall."""

    clearance_m: Clearance = Field(alias="clearance_um")
    """The hole's diameter less the shaft's; below 0 for interference."""
    thickness_m: _Size = Field(alias="thickness_um")
    gap_m: _Size | None = Field(None, alias="gap_um")
    """Free space after the hole before; none before the first."""
    entry_chamfer: ChamferDistributionSettings | None = None

    @model_validator(mode="after")
    def _check(self) -> "HoleDistributionSettings":
        thinnest_m, _ = self.thickness_m.ends
        if self.entry_chamfer is not None:
            _, deepest_m = self.entry_chamfer.height_m.ends
            if deepest_m >= thinnest_m:
                raise ValueError(
                    f"entry_chamfer.height_um reaches {_um(deepest_m)}: must be below "
                    f"{_um(thinnest_m)} throughout, the thickness of the thinnest wall"
                )
        return self

    def distribution(self) -> HoleDistribution:
        """Return the hole as the simulator takes it."""
        return HoleDistribution(
            self.clearance_m.distribution(),
            self.thickness_m.distribution(),
            (self.gap_m or OFF).distribution(),
            _chamfer(self.entry_chamfer),
        )


def _chamfer(settings: ChamferDistributionSettings | None) -> ChamferDistribution:
    return SHARP if settings is None else settings.distribution()


def _um(length_m: float) -> str:
    return f"{MICRO.to_written(length_m):.12g}"
