"""Effective penetration of a circle, also while only a part of it has entered the other solid.

A circle is worked in the frame of the solid that it enters: of a rim this is the shaft, of an edge
circle of the shaft the wall. Its plane is tilted against that solid's axis, so the circle enters
over a range of travel, and its deepest point radially may still be outside while others are inside.

At a point with radial overlap f that has entered by g, axially, a solid of length l, the effective
penetration is

    rim:          min(f, g, l - g)
    edge circle:  min(f, g) - max(0, g - l).

Its greatest value is on the half circle, cut along the tilt, of the deepest point: the other half
has the same g and less f. Along a half g only rises or falls, and so the penetration has one peak
wherever f has one: of an edge both are concave in the component along the tilt, of a rim no minimum
of functions with one peak has two. Only the overlap of a rim can have two peaks on a half.
"""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from simulator.checks import FloatArray
from simulator.deepest import Deepest, Heading
from simulator.extremum import Search
from simulator.geometry import Part, Shaft

IndexArray = npt.NDArray[np.intp]

CREST_STEPS = 12


def effective_penetration(
    part: Part, shaft: Shaft, heading: Heading, found: Deepest, search: Search
) -> FloatArray:
    """Greatest effective penetration [m] on each circle, at least 0: shape (C, P).

    Without a tilt, or where all of the overlap is effective, the deepest point has it. A circle is
    searched only where the change of g from one side to the other could lift another point above.
    """
    bound = np.minimum(found.overlap, found.entered)
    bound -= found.passed
    penetration = np.maximum(bound, 0.0)
    widest_m = max(2.0 * shaft.radius_m, 2.0 * float(part.wall_radii_m.max()))
    bound += widest_m * heading.sin
    np.minimum(bound, found.overlap, out=bound)
    cut = bound > penetration
    if np.logical_or.reduce(cut, axis=None):
        circles = _circles(part, shaft, heading, *np.nonzero(cut))
        best = search.highest(circles.penetration, circles.side(), circles.arc_ends())
        penetration[cut] = np.maximum(penetration[cut], best)
    return penetration


@dataclass(frozen=True, slots=True)
class Circles:
    """n circles, each in the frame of the solid that it enters; arrays (n,), lengths in m.

    A point of a circle is a unit vector with one component along the tilt and one across it.
    """

    is_rim: npt.NDArray[np.bool_]
    """A rim overlaps the shaft more the closer it is to the axis; an edge the wall the farther."""
    radius: FloatArray
    shortened: FloatArray
    """Radius along the tilt, as seen along the solid's axis."""
    along: FloatArray
    """Offset of the centre from the solid's axis, along the tilt."""
    across: FloatArray
    """Offset of the centre from the solid's axis, across the tilt."""
    surface: FloatArray
    """Radius of the solid's surface."""
    entered: FloatArray
    """Axial distance by which the centre has entered."""
    slope: FloatArray
    """What the point farthest along the tilt has entered more than the centre."""
    length: FloatArray
    """Axial length of the solid."""

    def penetration(self, along: FloatArray, across: FloatArray) -> FloatArray:
        """Effective penetration [m] at points with these components, (..., n); negative outside."""
        distance = np.hypot(self.along + self.shortened * along, self.across + self.radius * across)
        overlap = distance - self.surface
        overlap = np.where(self.is_rim, -overlap, overlap)
        entered = self.entered + self.slope * along
        left = self.length - entered
        effective = np.minimum(overlap, entered)
        return np.where(self.is_rim, np.minimum(effective, left), effective + np.minimum(left, 0.0))

    def side(self) -> FloatArray:
        """Sign of the component across the tilt on the half circle of the deepest point."""
        return np.copysign(1.0, np.where(self.is_rim, -self.across, self.across))

    def arc_ends(self) -> FloatArray:
        """Angles from the tilt, (2, n) or (3, n), between which the overlap has one peak each.

        Over a half circle, the squared distance of a rim from the shaft's axis is, but for a
        factor and a constant, -2 a cos t - 2 c sin t - b cos^2 t with a, b, c >= 0 if t starts at
        the end nearer to the deepest point. It has a second valley for b^(2/3) > a^(2/3) + c^(2/3).
        The crest before it, at |cos t| = v, is the smaller root of a + c v/sqrt(1 - v^2) - b v,
        which is convex: Newton's method from v = 0 rises to it monotonically.
        """
        half = np.stack([np.zeros(self.radius.shape), np.full(self.radius.shape, np.pi)])
        a = np.abs(self.along) * self.shortened / self.radius
        b, c = self.slope * self.slope / self.radius, np.abs(self.across)
        twin = self.is_rim & (np.cbrt(a * a) + np.cbrt(c * c) < np.cbrt(b * b))
        if not np.logical_or.reduce(twin):
            return half
        a, b, c = a[twin], b[twin], c[twin]
        v = np.zeros(a.shape)
        for _ in range(CREST_STEPS):
            sin = np.sqrt(1.0 - v * v)
            v += (a + c * v / sin - b * v) / (b - c / sin**3)
        crest = half[1].copy()
        crest[twin] = np.arccos(np.copysign(v, self.along[twin]))
        return np.insert(half, 1, crest, axis=0)


def _circles(
    part: Part, shaft: Shaft, heading: Heading, candidate: IndexArray, pose: IndexArray
) -> Circles:
    """The circles of n candidates (n,), numbered as in `Deepest`, in n poses (n,) of `heading`."""
    walls, entries, exits = len(part.wall_radii_m), part.wall_entries_m, part.wall_exits_m
    is_rim, is_trailing = candidate < 2 * walls, candidate >= 3 * walls
    plane = np.concatenate([part.rim_depths_m, entries, exits])[candidate]
    hole_radius = np.concatenate([part.rim_radii_m, *[part.wall_radii_m] * 2])[candidate]
    length = np.concatenate([np.full(2 * walls, shaft.length_m), *[exits - entries] * 2])[candidate]

    sin, cos, (x, y, z) = heading.sin[pose], heading.cos[pose], heading.centre[:, pose]
    height = plane - z
    behind = np.where(is_trailing, shaft.length_m, 0.0)
    inward = np.where(is_trailing, -1.0, 1.0)
    radius = np.where(is_rim, hole_radius, shaft.radius_m)
    return Circles(
        is_rim=is_rim,
        radius=radius,
        shortened=cos * radius,
        along=np.where(is_rim, -cos * x - sin * height, x - behind * sin),
        across=np.where(is_rim, -y, y),
        surface=np.where(is_rim, shaft.radius_m, hole_radius),
        entered=np.where(is_rim, sin * x - cos * height, -inward * (height + behind * cos)),
        slope=-inward * sin * radius,
        length=length,
    )
