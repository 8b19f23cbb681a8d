"""Meridian of a solid of revolution: its lateral faces, and the shapes its ends can have.

Meridian coordinates are the distance rho from the axis and an axial one: of the shaft s, measured
from its leading plane backwards, of a wall z - z0, measured from its mouth's plane into the hole.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from simulator.checks import FloatArray, positive, read_only

Points = tuple[tuple[float, float], ...]
"""Corners (s, rho) [m] of a meridian."""


@dataclass(frozen=True, slots=True)
class Chamfer:
    """A cone that takes `width_m` off an edge radially and `height_m` axially."""

    width_m: float
    height_m: float

    def __post_init__(self) -> None:
        positive("Chamfer.width_m", self.width_m)
        positive("Chamfer.height_m", self.height_m)


@dataclass(frozen=True, slots=True)
class Rounding:
    """A quarter circle in place of an edge."""

    radius_m: float

    def __post_init__(self) -> None:
        positive("Rounding.radius_m", self.radius_m)


@dataclass(frozen=True, slots=True)
class Faces:
    """Straight lateral faces normal_0*rho + normal_1*axial = offset of F lines; read-only."""

    normals: FloatArray
    """(F, 2): unit vectors, radial part above 0; of a shaft they point outwards, of a wall too."""
    offsets_m: FloatArray
    """(F,) [m]."""

    @classmethod
    def through(cls, points: Sequence[tuple[float, float]]) -> "Faces":
        """The faces between consecutive points (axial, rho) of a meridian, axially increasing."""
        corners = np.array(points)
        step = np.diff(corners, axis=0)
        normals = np.stack([step[:, 0], -step[:, 1]], axis=-1)
        normals /= np.hypot(normals[:, 0], normals[:, 1])[:, np.newaxis]
        offsets = normals[:, 0] * corners[:-1, 1] + normals[:, 1] * corners[:-1, 0]
        return cls(read_only(normals), read_only(offsets))


def worked_cylinder(
    radius_m: float, length_m: float, leading: Chamfer | None, trailing: Chamfer | None
) -> Points:
    """Meridian of a cylinder with or without a chamfer at either end."""
    first, last = [(0.0, radius_m)], [(length_m, radius_m)]
    if leading is not None:
        first = [(0.0, radius_m - leading.width_m), (leading.height_m, radius_m)]
    if trailing is not None:
        last = [
            (length_m - trailing.height_m, radius_m),
            (length_m, radius_m - trailing.width_m),
        ]
    return (*first, *last)


def checked_profile(name: str, points: Points) -> Points:
    """Return `points` if they are the corners (s, rho) of a convex solid that begins at s = 0."""
    array = np.asarray(points, dtype=np.float64)
    if array.ndim != 2 or array.shape[1] != 2 or len(array) < 2:
        raise ValueError(f"{name} has shape {array.shape}; it must be (n, 2) with n of at least 2")
    if not np.isfinite(array).all():
        raise ValueError(f"{name} is {points!r}; every entry must be finite")
    step = np.diff(array, axis=0)
    if array[0, 0] != 0.0 or (step[:, 0] <= 0.0).any():
        raise ValueError(f"{name} is {points!r}; s must begin at 0 and increase")
    if (array[:, 1] <= 0.0).any():
        raise ValueError(f"{name} is {points!r}; every radius must be greater than 0")
    if (np.diff(step[:, 1] / step[:, 0]) >= 0.0).any():
        raise ValueError(f"{name} is {points!r}; it must be convex, with a corner at every point")
    return tuple((float(s), float(rho)) for s, rho in array)
