"""Hypotheses about pose and part: what they consist of, and what is believed before any contact."""

from dataclasses import dataclass
from enum import IntEnum

import numpy as np
import numpy.typing as npt

from simulator.checks import FloatArray, non_negative, positive
from simulator.initial_pose import unit_disc

BoolArray = npt.NDArray[np.bool_]


class Parameter(IntEnum):
    """Columns of an array of hypotheses."""

    OFFSET_X = 0
    """Place of the shaft in M less the one that the stage reports [m]."""
    OFFSET_Y = 1
    TILT_X = 2
    """Rotation of the shaft less the one that the stage reports, about x [rad]."""
    TILT_Y = 3
    STIFFNESS = 4
    """[N/m]"""
    CLEARANCE = 5
    """Diameter of the first hole less the shaft's [m]; the others differ from it as drawn."""
    FRICTION = 6


OFFSET = slice(0, 2)
TILT = slice(2, 4)
Range = tuple[float, float]


@dataclass(frozen=True, slots=True)
class Prior:
    """All that is known before any contact; every value within it is equally likely.

    Raises `ValueError`, naming the setting, for a range that is not in order.
    """

    position_error_m: float
    """Radius of the disc in which alignment leaves the shaft."""
    tilt_error_rad: float
    """Radius of the disc in which alignment leaves its tilt."""
    stiffness_N_m: Range
    clearance_m: Range
    friction: Range

    def __post_init__(self) -> None:
        non_negative("Prior.position_error_m", self.position_error_m)
        non_negative("Prior.tilt_error_rad", self.tilt_error_rad)
        positive("Prior.stiffness_N_m (low)", self.stiffness_N_m[0])
        non_negative("Prior.friction (low)", self.friction[0])
        for name in ("stiffness_N_m", "clearance_m", "friction"):
            low, high = getattr(self, name)
            if not (np.isfinite(low) and np.isfinite(high) and low <= high):
                raise ValueError(
                    f"Prior.{name} is from {low!r} to {high!r}; it must be finite and in order"
                )

    def drawn(self, n: int, generator: np.random.Generator) -> FloatArray:
        """`n` hypotheses, shape (n, 7)."""
        hypotheses = np.empty((n, len(Parameter)))
        hypotheses[:, OFFSET] = self.position_error_m * unit_disc(generator.random((n, 2)))
        hypotheses[:, TILT] = self.tilt_error_rad * unit_disc(generator.random((n, 2)))
        for column, (low, high) in self._ranges():
            hypotheses[:, column] = low + (high - low) * generator.random(n)
        return hypotheses

    def holds(self, hypotheses: FloatArray) -> BoolArray:
        """Which of the `hypotheses` (n, 7) are possible, shape (n,)."""
        possible = np.hypot(*hypotheses[:, OFFSET].T) <= self.position_error_m
        possible &= np.hypot(*hypotheses[:, TILT].T) <= self.tilt_error_rad
        for column, (low, high) in self._ranges():
            possible &= (hypotheses[:, column] >= low) & (hypotheses[:, column] <= high)
        return np.asarray(possible)

    @property
    def widths(self) -> FloatArray:
        """Width of each parameter's range, shape (7,)."""
        discs = 2.0 * np.repeat([self.position_error_m, self.tilt_error_rad], 2)
        return np.array([*discs, *(high - low for _, (low, high) in self._ranges())])

    def _ranges(self) -> tuple[tuple[Parameter, Range], ...]:
        return (
            (Parameter.STIFFNESS, self.stiffness_N_m),
            (Parameter.CLEARANCE, self.clearance_m),
            (Parameter.FRICTION, self.friction),
        )
