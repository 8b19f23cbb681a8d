"""Shaft, holes and part, and the pose of the shaft in the part's frame M.

Frame M: origin at the centre of the first hole's upper rim (A1), +z into the hole along its axis.
All holes share that axis.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from simulator.checks import FloatArray, finite_array, non_negative, positive, read_only
from simulator.profile import Chamfer, Faces, Points, Rounding, checked_profile, worked_cylinder

POSE_SIZE = 5
"""A pose is x, y, z of the centre of the leading end circle B2 in M [m], and tilt rx, ry [rad]."""


_POSE_LIMITS = read_only(np.array([np.inf, np.inf, np.inf, 0.5 * np.pi, 0.5 * np.pi]))


@dataclass(frozen=True, slots=True)
class Shaft:
    """A convex solid of revolution along p - s*u: leading plane at s = 0, trailing at its length.

    A cylinder with sharp ends, unless an end is worked; `Shaft.of_profile` takes any convex
    meridian. `diameter_m` is the greatest one. The arrays are read-only. Its edge circles are
    listed from the leading end; of a rounded end this is the circle of the centres of the rounding,
    and the rounding's radius is the circle's tube.
    """

    diameter_m: float
    length_m: float
    leading: Chamfer | Rounding | None = None
    trailing: Chamfer | None = None
    profile_m: Points = ()
    """Corners (s, radius) of a meridian other than that of a cylinder with worked ends."""
    faces: Faces = field(init=False, repr=False, compare=False)
    edge_stations_m: FloatArray = field(init=False, repr=False, compare=False)
    """Shape (E,): s of each edge circle."""
    edge_radii_m: FloatArray = field(init=False, repr=False, compare=False)
    """Shape (E,): radius of each edge circle."""
    edge_tubes_m: FloatArray = field(init=False, repr=False, compare=False)
    """Shape (E,): radius of the tube about each edge circle, 0 for a sharp edge."""
    leading_edges: int = field(init=False, repr=False, compare=False)
    """How many of the edges, from the first, are up to the greatest diameter; at least 1."""
    is_plain: bool = field(init=False, repr=False, compare=False)
    """Whether it is a cylinder with sharp ends."""

    def __post_init__(self) -> None:
        radius = 0.5 * positive("Shaft.diameter_m", self.diameter_m)
        length = positive("Shaft.length_m", self.length_m)
        if self.profile_m:
            corners = self._checked_profile()
        else:
            self._check_ends()
            chamfer = self.leading if isinstance(self.leading, Chamfer) else None
            corners = worked_cylinder(radius, length, chamfer, self.trailing)
        edges = np.array([(s, rho, 0.0) for s, rho in corners])
        if (t := self.rounding_m) > 0.0:
            edges[0] = t, radius - t, t
        for name, value in (
            ("faces", Faces.through(corners)),
            ("edge_stations_m", read_only(edges[:, 0].copy())),
            ("edge_radii_m", read_only(edges[:, 1].copy())),
            ("edge_tubes_m", read_only(edges[:, 2].copy())),
            ("leading_edges", 1 + int(np.argmax([rho for _, rho in corners]))),
            ("is_plain", t == 0.0 and {rho for _, rho in corners} == {radius}),
        ):
            object.__setattr__(self, name, value)

    @classmethod
    def of_profile(cls, points: Points) -> "Shaft":
        """A shaft with the corners `points` (s, radius) [m], n >= 2, s from 0 and increasing.

        Raises `ValueError` for a profile that is not convex.
        """
        corners = checked_profile("Shaft.profile_m", points)
        return cls(2.0 * max(rho for _, rho in corners), corners[-1][0], profile_m=corners)

    @property
    def radius_m(self) -> float:
        """Half the diameter."""
        return 0.5 * self.diameter_m

    @property
    def rounding_m(self) -> float:
        """Radius of the rounded leading end, 0 without one."""
        return self.leading.radius_m if isinstance(self.leading, Rounding) else 0.0

    def _checked_profile(self) -> Points:
        corners = checked_profile("Shaft.profile_m", self.profile_m)
        if self.leading is not None or self.trailing is not None:
            raise ValueError("Shaft.profile_m holds both ends; leading and trailing must be None")
        if corners[-1][0] != self.length_m or 2.0 * max(r for _, r in corners) != self.diameter_m:
            raise ValueError(
                f"Shaft.profile_m is {corners!r}; it must end at length_m = {self.length_m!r} and "
                f"be at most, and somewhere, diameter_m = {self.diameter_m!r} wide"
            )
        return corners

    def _check_ends(self) -> None:
        taken = 0.0
        for name, end in (("leading", self.leading), ("trailing", self.trailing)):
            if isinstance(end, Rounding):
                width, height, what = end.radius_m, end.radius_m, "radius_m"
            elif end is not None:
                width, height, what = end.width_m, end.height_m, "width_m"
            else:
                continue
            if width >= self.radius_m:
                raise ValueError(
                    f"Shaft.{name}.{what} is {width!r}; it must be below the radius, "
                    f"{self.radius_m!r}"
                )
            taken += height
            if taken >= self.length_m:
                raise ValueError(
                    f"Shaft.{name} makes the worked ends {taken!r} long; they must be shorter than "
                    f"length_m, {self.length_m!r}"
                )


@dataclass(frozen=True, slots=True)
class Hole:
    """A cylindrical hole through one wall, with or without a chamfer at its mouth.

    `gap_m` is the free space between the previous hole's lower rim and this hole's mouth; 0 for
    the first hole. `diameter_m` is that of the bore.
    """

    diameter_m: float
    thickness_m: float
    gap_m: float = 0.0
    entry: Chamfer | None = None

    def __post_init__(self) -> None:
        positive("Hole.diameter_m", self.diameter_m)
        positive("Hole.thickness_m", self.thickness_m)
        non_negative("Hole.gap_m", self.gap_m)
        if self.entry is not None and self.entry.height_m >= self.thickness_m:
            raise ValueError(
                f"Hole.entry.height_m is {self.entry.height_m!r}; it must be below thickness_m, "
                f"{self.thickness_m!r}"
            )

    def meridian(self) -> Points:
        """Corners (z - z0, rho) [m] of the rims: mouth, throat if there is a chamfer, lower rim."""
        bore, end = 0.5 * self.diameter_m, self.thickness_m
        if self.entry is None:
            return ((0.0, bore), (end, bore))
        throat = (self.entry.height_m, bore)
        return ((0.0, bore + self.entry.width_m), throat, (end, bore))


@dataclass(frozen=True, slots=True)
class Part:
    """One or more coaxial holes, listed along +z.

    The arrays are read-only. A shaft thicker than a hole (interference) is valid.
    """

    holes: tuple[Hole, ...]
    wall_radii_m: FloatArray = field(init=False, repr=False, compare=False)
    """Shape (N,): radius of each bore."""
    wall_mouths_m: FloatArray = field(init=False, repr=False, compare=False)
    """Shape (N,): radius of each mouth."""
    wall_entries_m: FloatArray = field(init=False, repr=False, compare=False)
    """Shape (N,): z of each mouth's plane in M."""
    wall_exits_m: FloatArray = field(init=False, repr=False, compare=False)
    """Shape (N,): z of each hole's lower rim in M."""
    wall_faces: tuple[Faces, ...] = field(init=False, repr=False, compare=False)
    """N: the faces of each wall, in (rho, z - z0); the bore is the last one."""
    rim_depths_m: FloatArray = field(init=False, repr=False, compare=False)
    """Shape (M,): z of each rim in M: for each hole its mouth, its throat if there is a chamfer,
    and its lower rim; A1, A2, A3, ... without chamfers."""
    rim_radii_m: FloatArray = field(init=False, repr=False, compare=False)
    """Shape (M,): radius of each rim."""
    rim_holes: npt.NDArray[np.int64] = field(init=False, repr=False, compare=False)
    """Shape (M,): number of the hole that each rim belongs to."""
    is_plain: bool = field(init=False, repr=False, compare=False)
    """Whether no hole has a chamfer."""

    def __post_init__(self) -> None:
        holes: Sequence[Hole] = self.holes
        if not isinstance(holes, tuple) or not holes:
            raise ValueError(f"Part.holes is {holes!r}; it must be a tuple of at least one Hole")
        if holes[0].gap_m != 0.0:
            raise ValueError(
                f"Part.holes[0].gap_m is {holes[0].gap_m!r}; it must be 0: z = 0 is its mouth"
            )
        lengths = np.array([(hole.gap_m, hole.thickness_m) for hole in holes])
        planes = np.cumsum(lengths.ravel())
        meridians = [hole.meridian() for hole in holes]
        rims = [
            (exit_m if corner is meridian[-1] else entry_m + corner[0], corner[1], number)
            for number, (meridian, entry_m, exit_m) in enumerate(
                zip(meridians, planes[0::2], planes[1::2], strict=True)
            )
            for corner in meridian
        ]
        depths, rim_radii, numbers = (np.array(column) for column in zip(*rims, strict=True))
        numbers.setflags(write=False)
        for name, value in (
            ("wall_radii_m", read_only(np.array([0.5 * hole.diameter_m for hole in holes]))),
            ("wall_mouths_m", read_only(np.array([meridian[0][1] for meridian in meridians]))),
            ("wall_entries_m", read_only(planes[0::2].copy())),
            ("wall_exits_m", read_only(planes[1::2].copy())),
            ("wall_faces", tuple(Faces.through(meridian) for meridian in meridians)),
            ("rim_depths_m", read_only(depths)),
            ("rim_radii_m", read_only(rim_radii)),
            ("rim_holes", numbers),
            ("is_plain", all(hole.entry is None for hole in holes)),
        ):
            object.__setattr__(self, name, value)


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
