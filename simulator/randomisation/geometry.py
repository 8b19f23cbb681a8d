"""Distributions of the sizes of shaft and holes [m], and draws from them as columns."""

from dataclasses import dataclass

import numpy as np

from simulator.checks import FloatArray
from simulator.randomisation.distributions import NONE, Distribution, Generators, drawn


@dataclass(frozen=True, slots=True)
class ChamferDistribution:
    """A chamfer [m]; the default is a sharp edge, of width and height 0."""

    width_m: Distribution = NONE
    height_m: Distribution = NONE


SHARP = ChamferDistribution()


@dataclass(frozen=True, slots=True)
class HoleDistribution:
    """A hole [m]; `clearance_m` is its diameter less the shaft's, below zero for interference."""

    clearance_m: Distribution
    """On top of the clearance that all holes of a part have in common."""
    thickness_m: Distribution
    gap_m: Distribution = NONE
    """Free space after the hole before; always 0 before the first."""
    entry: ChamferDistribution = SHARP

    def drawn(self, generators: Generators) -> FloatArray:
        """Clearance, thickness, gap, width and height of the chamfer; shape (n, 5)."""
        entry = (self.entry.width_m, self.entry.height_m)
        return _columns((self.clearance_m, self.thickness_m, self.gap_m, *entry), generators)


@dataclass(frozen=True, slots=True)
class ShaftDistribution:
    """A shaft [m]: a cylinder whose leading end is sharp, chamfered or rounded.

    Raises `ValueError` for a leading end that is both.
    """

    diameter_m: Distribution
    length_m: Distribution
    leading: ChamferDistribution = SHARP
    rounding_m: Distribution = NONE
    """Radius of the rounded leading end."""
    trailing: ChamferDistribution = SHARP

    def __post_init__(self) -> None:
        if self.leading != SHARP and self.rounding_m != NONE:
            raise ValueError(
                f"ShaftDistribution.rounding_m is {self.rounding_m!r}; it must be {NONE!r} where "
                "the leading end has a chamfer"
            )

    def drawn(self, generators: Generators) -> FloatArray:
        """Diameter, length, leading width and height, rounding, trailing ones; shape (n, 7)."""
        leading = (self.leading.width_m, self.leading.height_m)
        trailing = (self.trailing.width_m, self.trailing.height_m)
        sizes = (self.diameter_m, self.length_m, *leading, self.rounding_m, *trailing)
        return _columns(sizes, generators)


def _columns(sizes: tuple[Distribution, ...], generators: Generators) -> FloatArray:
    return np.hstack([drawn(size, 1, generators) for size in sizes])
