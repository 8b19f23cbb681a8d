"""Rate-independent memory of a mechanism: backlash, and the hysteresis of a piezo drive.

P. Krejci and K. Kuhnen, "Inverse control of systems with hysteresis and creep", IEE Proceedings -
Control Theory and Applications 148 (2001), describe both operators.
"""

from dataclasses import dataclass, field

import numpy as np

from simulator.checks import FloatArray, read_only
from simulator.effects.arrays import AXES, axis_sizes, sum_rows

_ROUNDING = 1e-12


def play(target: FloatArray, held: FloatArray, gap: FloatArray) -> FloatArray:
    """The play operator: a follower with free travel `gap` between its two flanks.

    It stays where it was (`held`) until a flank, half the gap from `target`, pushes it. The shapes
    broadcast; the unit is any, the same for all three. `gap` must be at least 0, and with 0 the
    follower is at the target.
    """
    half = 0.5 * gap
    return np.minimum(np.maximum(held, target - half), target + half)


def _no_plays() -> FloatArray:
    return read_only(np.zeros((0, AXES)))


@dataclass(frozen=True, slots=True, eq=False)
class PrandtlIshlinskii:
    """Weighted sum of K play operators per axis. The default has none.

    `gaps` [m, rad] and `weights` have shape (..., K, 6) and entries of at least 0. The input itself
    gets what is missing of a total weight of 1, so that the weights of an axis may sum to at most 1
    and a long way has a slope of 1. Raises `ValueError` for anything else.
    """

    gaps: FloatArray = field(default_factory=_no_plays)
    weights: FloatArray = field(default_factory=_no_plays)

    def __post_init__(self) -> None:
        gaps = axis_sizes("PrandtlIshlinskii.gaps", self.gaps)
        weights = axis_sizes("PrandtlIshlinskii.weights", self.weights)
        for name, array in (("gaps", gaps), ("weights", weights)):
            if array.ndim < 2 or array.shape[-2] != gaps.shape[-2]:
                raise ValueError(
                    f"PrandtlIshlinskii.{name} has shape {array.shape}; "
                    "it must be (..., K, 6) with the same K for gaps and weights"
                )
        if (sum_rows(weights) > 1.0 + _ROUNDING).any():
            raise ValueError(
                f"PrandtlIshlinskii.weights sum to {sum_rows(weights).max()} on an axis; "
                "they may sum to at most 1"
            )
        object.__setattr__(self, "gaps", gaps)
        object.__setattr__(self, "weights", weights)

    def relaxed(self, position: FloatArray) -> FloatArray:
        """The play operators at rest in mid-gap at `position`, shape (..., 6): (..., K, 6)."""
        return np.repeat(position[..., np.newaxis, :], self.gaps.shape[-2], axis=-2)

    def follow(self, target: FloatArray, plays: FloatArray) -> tuple[FloatArray, FloatArray]:
        """The output for `target`, shape (..., 6), and the new `plays`, shape (..., K, 6).

        The output is off the target by at most the weighted sum of the half gaps.
        """
        rows = target[..., np.newaxis, :]
        followed = play(rows, plays, self.gaps)
        return target + sum_rows(self.weights * (followed - rows)), followed
