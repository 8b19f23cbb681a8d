"""1/f drift: the sum of Ornstein-Uhlenbeck processes spaced evenly in log frequency.

A process of variance s^2 and corner frequency c has the one-sided spectrum (2 s^2 / pi) c /
(c^2 + f^2). Rungs of equal variance, a distance d apart in the natural logarithm of their corners,
sum to s^2 / (d f) between the ends of the ladder. E. Milotti, "1/f noise: a pedagogical review",
arXiv:physics/0204033 (2002), derives it.
"""

import math
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from simulator.checks import FloatArray, positive
from simulator.effects.arrays import axis_sizes, none_per_axis, sum_rows

_RUNGS_PER_DECADE = 2
_MARGIN = 10.0
"""The ladder goes on by this factor beyond either end of the band."""


@dataclass(frozen=True, slots=True, eq=False)
class Ladder:
    """R Ornstein-Uhlenbeck processes per axis, all of the same deviation. The default has none.

    `rms` is the standard deviation of each, shape (..., 6) [N, N*m]. Raises `ValueError` for a
    corner that is not above zero, and a deviation of another shape, below zero or not finite.
    """

    corners_Hz: tuple[float, ...] = ()
    rms: FloatArray = field(default_factory=none_per_axis)

    def __post_init__(self) -> None:
        for index, corner in enumerate(self.corners_Hz):
            positive(f"Ladder.corners_Hz[{index}]", corner)
        object.__setattr__(self, "rms", axis_sizes("Ladder.rms", self.rms))

    def steps(self, rungs: FloatArray, dt_s: float, draws: FloatArray) -> FloatArray:
        """The rungs now and after each of T steps of `dt_s`, shape (1 + T, ..., R, 6).

        Exact for any time step. `rungs` has shape (..., R, 6), `draws` (T, ..., R, 6). Rungs are
        scaled to unit variance: standard normal draws are a state that they have when they have
        been running for long. The update is that of D. T. Gillespie, Physical Review E 54 (1996)
        2084.
        """
        if not self.corners_Hz:
            return np.zeros((1 + len(draws), *rungs.shape))
        exponents = -2.0 * math.pi * dt_s * np.array(self.corners_Hz)[:, np.newaxis]
        kept, kicks = np.exp(exponents), np.sqrt(-np.expm1(2.0 * exponents)) * draws
        path = np.empty((1 + len(draws), *rungs.shape))
        path[0] = rungs
        for k, kick in enumerate(kicks):
            path[k + 1] = kept * path[k] + kick
        return path

    def drift(self, rungs: FloatArray) -> FloatArray:
        """The sum of the rungs, shape (..., R, 6), as a wrench, shape (..., 6) [N, N*m]."""
        return self.rms * sum_rows(rungs)


def flicker(density_at_1_Hz: npt.ArrayLike, band_Hz: tuple[float, float]) -> Ladder:
    """The ladder whose one-sided amplitude density is `density_at_1_Hz` / sqrt(f) in the band.

    `density_at_1_Hz` has shape (..., 6) [N/sqrt(Hz), N*m/sqrt(Hz)]. The power spectrum is within 5
    percent of the law over the whole of a band of a decade or more, 8 percent of a narrower one, if
    it is sampled at 20 times the band's end or faster. It levels off below the band and falls
    faster above it. Raises `ValueError` for a band that is not 0 < low < high, and a density of
    another shape, below zero or not finite.
    """
    low, high = band_Hz
    if not 0.0 < low < high < math.inf:
        raise ValueError(f"band_Hz is {band_Hz!r}; it must be (low, high) with 0 < low < high")
    span = math.log(high / low) + 2.0 * math.log(_MARGIN)
    gaps = math.ceil(_RUNGS_PER_DECADE * span / math.log(10.0))
    corners = np.geomspace(low / _MARGIN, high * _MARGIN, gaps + 1)
    rms = math.sqrt(span / gaps) * axis_sizes("density_at_1_Hz", density_at_1_Hz)
    return Ladder(tuple(corners.tolist()), rms)
