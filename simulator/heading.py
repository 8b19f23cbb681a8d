"""Poses in the heading frame: M turned about z so that the shaft leans along x."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from simulator.checks import FloatArray

_SMALLEST = 1e-150


@dataclass(frozen=True, slots=True)
class Heading:
    """Columns of P poses, turned about z into the heading frame."""

    turn: FloatArray
    """(2, P): horizontal unit vector of the tilt in M; (1, 0) for an upright shaft."""
    centre: FloatArray
    """(3, P) [m]: centre of B2 in the heading frame."""
    sin: FloatArray
    """(P,): sine of the angle between the shaft's axis and z."""
    cos: FloatArray
    """(P,): cosine of that angle."""

    @classmethod
    def of(cls, columns: FloatArray) -> "Heading":
        """Heading of poses given as columns, shape (5, P)."""
        sin_xy, cos_xy = np.sin(columns[3:]), np.cos(columns[3:])
        turn = np.negative(sin_xy[::-1])
        np.multiply(sin_xy[1], cos_xy[0], out=turn[0])
        sin = np.hypot(turn[0], turn[1])
        upright = sin < _SMALLEST
        turn /= np.maximum(sin, _SMALLEST)
        if np.logical_or.reduce(upright):
            turn[0, upright], turn[1, upright] = 1.0, 0.0
        centre = columns[:3].copy()
        np.multiply(turn[0], columns[0], out=centre[0])
        centre[0] += turn[1] * columns[1]
        np.multiply(turn[0], columns[1], out=centre[1])
        centre[1] -= turn[1] * columns[0]
        return cls(turn, centre, sin, cos_xy[0] * cos_xy[1])

    def at(self, pose: npt.NDArray[np.intp]) -> "Heading":
        """The headings of some of the poses, by number."""
        return Heading(self.turn[:, pose], self.centre[:, pose], self.sin[pose], self.cos[pose])

    def to_part(self, vectors: FloatArray) -> None:
        """Turn `vectors`, shape (3, ..., P), from the heading frame into M, in place."""
        x, y = vectors[0], vectors[1]
        crossed = self.turn[1] * x
        x *= self.turn[0]
        x -= self.turn[1] * y
        y *= self.turn[0]
        y += crossed
