"""Shaft, holes and part, and the pose of the shaft in the part's frame M.

Frame M: origin at the centre of the first hole's upper rim (A1), +z into the hole along its axis.
All holes share that axis. Edges are sharp: no chamfers.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from simulator.checks import FloatArray, finite_array, non_negative, positive, read_only

POSE_SIZE = 5
"""A pose is x, y, z of the centre of the leading end circle B2 in M [m], and tilt rx, ry [rad]."""


_POSE_LIMITS = read_only(np.array([np.inf, np.inf, np.inf, 0.5 * np.pi, 0.5 * np.pi]))


@dataclass(frozen=True, slots=True)
class Shaft:
    """A straight cylinder along p - s*u: leading end B2 at s = 0, trailing end B1 at its length."""

    diameter_m: float
    length_m: float

    def __post_init__(self) -> None:
        positive("Shaft.diameter_m", self.diameter_m)
        positive("Shaft.length_m", self.length_m)

    @property
    def radius_m(self) -> float:
        """Half the diameter."""
        return 0.5 * self.diameter_m


@dataclass(frozen=True, slots=True)
class Hole:
    """A cylindrical hole through one wall.

    `gap_m` is the free space between the previous hole's lower rim and this hole's upper rim; 0 for
    the first hole.
    """

    diameter_m: float
    thickness_m: float
    gap_m: float = 0.0

    def __post_init__(self) -> None:
        positive("Hole.diameter_m", self.diameter_m)
        positive("Hole.thickness_m", self.thickness_m)
        non_negative("Hole.gap_m", self.gap_m)


@dataclass(frozen=True, slots=True)
class Part:
    """One or more coaxial holes, listed along +z.

    The arrays are read-only. A shaft thicker than a hole (interference) is valid.
    """

    holes: tuple[Hole, ...]
    wall_radii_m: FloatArray = field(init=False, repr=False, compare=False)
    """Shape (N,): radius of each hole."""
    wall_entries_m: FloatArray = field(init=False, repr=False, compare=False)
    """Shape (N,): z of each hole's upper rim in M."""
    wall_exits_m: FloatArray = field(init=False, repr=False, compare=False)
    """Shape (N,): z of each hole's lower rim in M."""
    rim_depths_m: FloatArray = field(init=False, repr=False, compare=False)
    """Shape (2N,): z of the rims A1, A2, A3, ... in M."""
    rim_radii_m: FloatArray = field(init=False, repr=False, compare=False)
    """Shape (2N,): radius of the rims A1, A2, A3, ..."""

    def __post_init__(self) -> None:
        holes: Sequence[Hole] = self.holes
        if not isinstance(holes, tuple) or not holes:
            raise ValueError(f"Part.holes is {holes!r}; it must be a tuple of at least one Hole")
        if holes[0].gap_m != 0.0:
            raise ValueError(
                f"Part.holes[0].gap_m is {holes[0].gap_m!r}; it must be 0: z = 0 is its upper rim"
            )
        lengths = np.array([(hole.gap_m, hole.thickness_m) for hole in holes])
        rims = np.cumsum(lengths.ravel())
        radii = np.array([0.5 * hole.diameter_m for hole in holes])
        for name, array in (
            ("wall_radii_m", radii),
            ("wall_entries_m", rims[0::2].copy()),
            ("wall_exits_m", rims[1::2].copy()),
            ("rim_depths_m", rims),
            ("rim_radii_m", np.repeat(radii, 2)),
        ):
            object.__setattr__(self, name, read_only(array))


def checked_poses(poses: npt.ArrayLike) -> FloatArray:
    """Return `poses`, shape (..., 5), if every entry is finite and both tilts are under pi/2."""
    array = np.asarray(poses, dtype=np.float64)
    if array.shape[-1:] == (POSE_SIZE,) and np.logical_and.reduce(
        np.abs(array) < _POSE_LIMITS, axis=None
    ):
        return array
    finite_array("poses", array, POSE_SIZE)
    largest = float(np.abs(array[..., 3:]).max())
    raise ValueError(f"poses hold a tilt of {largest} rad; tilts must lie inside (-pi/2, pi/2)")


def shaft_axis(poses: npt.ArrayLike) -> FloatArray:
    """Unit vector of the insertion direction in M, shape (..., 3), for poses of shape (..., 5).

    The tilt turns +z about x by rx, then about the fixed y by ry: u = Ry(ry) Rx(rx) e_z (the
    paper's eq. 3 with R_z = 1). Raises `ValueError` for a pose that is not finite or tilted by a
    quarter turn or more.
    """
    tilt = checked_poses(poses)[..., 3:]
    sin, cos = np.sin(tilt), np.cos(tilt)
    return np.stack([sin[..., 1] * cos[..., 0], -sin[..., 0], cos[..., 1] * cos[..., 0]], axis=-1)


def tilt_of(axis: npt.ArrayLike) -> FloatArray:
    """Tilt (rx, ry) [rad], shape (..., 2), of an axis (..., 3) in M: the inverse of `shaft_axis`.

    `axis` need not be of unit length, but it must be finite and point down the hole (z > 0).
    """
    u = finite_array("axis", axis, 3)
    if u.size and u[..., 2].min() <= 0.0:
        raise ValueError(
            f"axis has a z of {float(u[..., 2].min())}; it must point into the hole (z > 0)"
        )
    rx = np.arctan2(-u[..., 1], np.hypot(u[..., 0], u[..., 2]))
    return np.stack([rx, np.arctan2(u[..., 0], u[..., 2])], axis=-1)
