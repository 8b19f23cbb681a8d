"""Circles in the frame of the solid that they enter: depth below its faces, and how far entered.

Of a rim this solid is the shaft, of an edge circle of the shaft it is a wall. A circle's plane is
tilted against the solid's axis; a point of it is a unit vector e with a component along the tilt
and one across it. With rho the distance from the solid's axis and a the axial coordinate, linear in
e, a face is met at the depth

    rim:          offset - n_0 rho - n_1 a
    edge circle:  n_0 rho + n_1 a - offset, plus the radius of the edge's tube.

At a point with the depth f below the least deep face that has entered by g, axially, a solid of
length l, the effective penetration is

    rim:          min(f, g, l - g)
    edge circle:  min(f, g) - max(0, g - l).

Both f and the penetration are greatest on the half circle, cut along the tilt, on which rho favours
them: the other half has the same a. With x = cos t along that half, rho^2 of an edge circle is
concave in x, so there is one peak. Of a rim, with offsets A along and C across the tilt, radius r,
r cos along the tilt and s = r sin,

    (rho^2)'/2 = A r cos - s^2 x + |C| r x / sqrt(1 - x^2),

and the depth below one face may have a valley, where this plus (n_1/n_0) s rho falls through zero.
It falls only for sqrt(1 - x^2)^3 > |C| r / (s^2 + (n_1/n_0 s)^2), so there is at most one valley,
and it is found by halving. Below the rounding, where rho and a are both beyond its centre, depth is
concave in x: no valley is added. No minimum of functions with one peak each has two: cut at the
valleys of all faces, a half circle falls into arcs with one peak.
"""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from simulator.candidates import Candidates, Kind
from simulator.checks import FloatArray
from simulator.extremum import Search, halved
from simulator.geometry import Part, Shaft
from simulator.heading import Heading

IndexArray = npt.NDArray[np.intp]
_SMALLEST = 1e-150


@dataclass(frozen=True, slots=True)
class Spot:
    """Points (..., n) of n circles against the least deep face of the other solid."""

    depth: FloatArray
    """Below that face [m]; negative outside. Of an edge with a tube, that of the tube."""
    normal: FloatArray
    """(2, ..., n): normal of the face, radial and axial; at an edge a mean, shorter than 1."""
    offset: FloatArray
    """(2, ..., n): from the solid's axis, along and across the tilt [m]."""
    distance: FloatArray
    """From the solid's axis [m]."""
    axial: FloatArray
    """Axial coordinate in the solid [m]."""


@dataclass(frozen=True, slots=True)
class Circles:
    """n circles; arrays (n,), lengths in m."""

    is_rim: npt.NDArray[np.bool_]
    is_trailing: npt.NDArray[np.bool_]
    """Edges that enter a wall from behind."""
    radius: FloatArray
    shortened: FloatArray
    """Radius along the tilt, as seen along the solid's axis."""
    along: FloatArray
    """Offset of the centre from the solid's axis, along the tilt."""
    across: FloatArray
    """Offset of the centre from the solid's axis, across the tilt."""
    axial: FloatArray
    """Axial coordinate of the centre in the solid: s behind the leading plane, or z - z0."""
    slope: FloatArray
    """Axial coordinate of the point farthest along the tilt, less that of the centre."""
    length: FloatArray
    """Axial length of the solid."""
    tube: FloatArray
    """Radius of the tube about the circle."""
    normals: FloatArray
    """(2, F, n): normals of the solid's faces, radial and axial."""
    offsets: FloatArray
    """(F, n): offsets of the solid's faces."""
    rounding: tuple[float, float]
    """Radius of the shaft's rounded leading end, 0 without one, and of the circle of its centres:
    the face that a rim meets there."""
    frame: FloatArray
    """(3, n): centre in the heading frame."""
    tilt: FloatArray
    """(2, n): cosine and sine of the shaft's tilt."""

    @classmethod
    def of(
        cls,
        part: Part,
        shaft: Shaft,
        heading: Heading,
        table: Candidates,
        candidate: IndexArray,
        pose: IndexArray,
    ) -> "Circles":
        """The circles of n candidates (n,) of `table` in n poses (n,) of `heading`."""
        is_rim, hole = table.kind[candidate] == Kind.RIM, table.hole[candidate]
        rim = np.where(is_rim, table.circle[candidate], 0)
        edge = np.where(is_rim, 0, table.circle[candidate])
        sin, cos, (x, y, z) = heading.sin[pose], heading.cos[pose], heading.centre[:, pose]
        entry, behind, depth = (
            part.wall_entries_m[hole],
            shaft.edge_stations_m[edge],
            part.rim_depths_m[rim],
        )
        height, end_x, end_z = depth - z, x - behind * sin, z - behind * cos
        radius = np.where(is_rim, part.rim_radii_m[rim], shaft.edge_radii_m[edge])
        normals, offsets = _faces(part, shaft, is_rim, hole)
        return cls(
            is_rim=is_rim,
            is_trailing=table.kind[candidate] == Kind.TRAILING_EDGE,
            radius=radius,
            shortened=cos * radius,
            along=np.where(is_rim, -cos * x - sin * height, end_x),
            across=np.where(is_rim, -y, y),
            axial=np.where(is_rim, sin * x - cos * height, end_z - entry),
            slope=-sin * radius,
            length=np.where(is_rim, shaft.length_m, part.wall_exits_m[hole] - entry),
            tube=np.where(is_rim, 0.0, shaft.edge_tubes_m[edge]),
            normals=normals,
            offsets=offsets,
            rounding=(shaft.rounding_m, shaft.radius_m - shaft.rounding_m),
            frame=np.where(is_rim, [0.0 * x, 0.0 * x, depth], [end_x, y, end_z]),
            tilt=np.stack([cos, sin]),
        )

    def spot(self, e: FloatArray) -> Spot:
        """The points of unit vectors e, shape (2, ..., n)."""
        q = np.stack([self.along + self.shortened * e[0], self.across + self.radius * e[1]])
        rho, axial = np.hypot(q[0], q[1]), self.axial + self.slope * e[0]
        depth, normal = self._below_face(0, rho, axial)
        for number in range(1, len(self.offsets)):
            below, face = self._below_face(number, rho, axial)
            least = below < depth
            depth, normal = np.where(least, below, depth), np.where(least, face, normal)
        if self.rounding[0] > 0.0:
            below, arc = self._below_rounding(rho, axial)
            least = self.is_rim & (below < depth)
            depth, normal = np.where(least, below, depth), np.where(least, arc, normal)
        return Spot(depth + self.tube, normal, q, np.maximum(rho, _SMALLEST), axial)

    def _below_face(
        self, number: int, rho: FloatArray, axial: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """Depth below a straight face of each solid, and its normal (2, ...)."""
        normal = self.normals[:, number].reshape(2, *[1] * (rho.ndim - 1), -1)
        height = normal[0] * rho + normal[1] * axial - self.offsets[number]
        return np.where(self.is_rim, -height, height), np.broadcast_to(normal, (2, *rho.shape))

    def _below_rounding(self, rho: FloatArray, s: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Depth below the rounded end and its normal (2, ...): of all its tangents the nearest."""
        t, centre = self.rounding
        out, ahead = np.maximum(rho - centre, 0.0), np.maximum(t - s, 0.0)
        reach = np.hypot(out, ahead)
        at_arc = reach > 0.0
        aside, before = centre + t - rho, s
        depth = np.where(at_arc, t - reach, np.minimum(aside, before))
        scale = np.maximum(reach, _SMALLEST)
        radial = np.where(at_arc, out / scale, aside <= before)
        axial = np.where(at_arc, ahead / scale, aside > before)
        return depth, np.stack([radial, -axial])

    def entered(self, axial: FloatArray) -> FloatArray:
        """How far points with these axial coordinates have entered the solid, from the front."""
        return np.where(self.is_trailing, self.length - axial, axial)

    def overlap(self, *e: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Depth f [m] at points of unit vectors, and its slope: a `Height`."""
        spot = self.spot(np.stack(e))
        return spot.depth, self._slope(spot, *e)

    def penetration(self, *e: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Effective penetration [m] at points of unit vectors, and its slope: a `Height`."""
        spot = self.spot(np.stack(e))
        entered, rise = self.entered(spot.axial), -self.slope * e[1]
        rise = np.where(self.is_trailing, -rise, rise)
        left = self.length - entered
        shallow = entered < spot.depth
        least = np.where(shallow, entered, spot.depth)
        slope = np.where(shallow, rise, self._slope(spot, *e))
        late = left < np.where(self.is_rim, least, 0.0)
        value = np.where(late, np.where(self.is_rim, left, least + left), least)
        return value, np.where(late, np.where(self.is_rim, 0.0, slope) - rise, slope)

    def _slope(self, spot: Spot, along: FloatArray, across: FloatArray) -> FloatArray:
        """Slope of the depth f with the angle."""
        half_square = self.across * self.radius * along - self.along * self.shortened * across
        half_square = half_square + self.slope * self.slope * along * across
        slope = spot.normal[0] * half_square / spot.distance
        slope -= spot.normal[1] * self.slope * across
        return np.asarray(np.where(self.is_rim, -slope, slope))

    def side(self) -> FloatArray:
        """Sign of the component across the tilt on the half circle of the deepest point."""
        return np.copysign(1.0, np.where(self.is_rim, -self.across, self.across))

    def arc_ends(self) -> FloatArray:
        """Angles from the tilt, (A + 1, n), between which depth and penetration have one peak."""
        ends = [np.zeros(self.radius.shape), np.full(self.radius.shape, np.pi)]
        pull = np.abs(self.across) * self.radius
        for radial, axial in self.normals.swapaxes(0, 1):
            ratio = axial / np.where(radial > 0.0, radial, 1.0) * self.slope
            fall = self.slope * self.slope + ratio * ratio
            if not np.logical_or.reduce(falls := self.is_rim & (radial > 0.0) & (pull < fall)):
                continue
            edge = np.arcsin(np.cbrt(np.where(falls, pull / np.where(falls, fall, 1.0), 0.0)))

            def is_before(angle: FloatArray, ratio: FloatArray = ratio) -> npt.NDArray[np.bool_]:
                x, y = np.cos(angle), np.sin(angle)
                rise = self.along * self.shortened - self.slope * self.slope * x + pull * x / y
                q = self.along + self.shortened * x, np.abs(self.across) - self.radius * y
                before: npt.NDArray[np.bool_] = rise + ratio * np.hypot(*q) < 0.0
                return before

            valley = halved(is_before, edge, np.pi - edge)[0]
            ends.insert(-1, np.where(falls, valley, 0.0))
        return np.sort(ends, axis=0)

    def best(self, search: Search) -> tuple[FloatArray, Spot]:
        """Unit vectors (2, n) of the greatest depth f, and the spots there.

        At an edge between two faces, where f rises on one and falls on the other, their normals
        are weighted such that the point's way along the circle does no work. So the force stays the
        gradient of the energy, and turns as the edge goes by.
        """
        e = search.peak(self.overlap, self.side(), self.arc_ends())
        spot, slope = self.spot(e), self.overlap(*e)[1] * self.side()
        rise, fall = np.maximum(slope[0], 0.0), np.maximum(-slope[1], 0.0)
        behind = rise / np.maximum(rise + fall, _SMALLEST)
        normal = spot.normal[:, 0] + behind * (spot.normal[:, 1] - spot.normal[:, 0])
        return e[:, 0], Spot(
            spot.depth[0], normal, spot.offset[:, 0], spot.distance[0], spot.axial[0]
        )

    def greatest_penetration(self, search: Search) -> FloatArray:
        """The greatest effective penetration (n,) [m]; negative outside."""
        e = search.peak(self.penetration, self.side(), self.arc_ends())
        return self.penetration(*e[:, 0])[0]

    def place(self, e: FloatArray, spot: Spot) -> tuple[FloatArray, FloatArray]:
        """Points [m] and normals, both (3, ..., n), in the heading frame."""
        cos, sin = self.tilt
        level, zero = np.ones(cos.shape), np.zeros(cos.shape)
        leaning = np.stack([cos, zero, -sin])
        upright = np.stack([level, zero, zero])
        behind = np.stack([-sin, zero, -cos])
        down = np.stack([zero, zero, level])
        shape = (3, *[1] * (e.ndim - 2), -1)
        across = np.array([0.0, 1.0, 0.0]).reshape(3, *[1] * (e.ndim - 1))
        ring, ray, axis = (
            np.where(self.is_rim, of_rim, of_edge).reshape(shape)
            for of_rim, of_edge in ((upright, leaning), (leaning, upright), (behind, down))
        )
        radial = spot.offset / spot.distance
        normal = spot.normal[0] * (radial[0] * ray + radial[1] * across)
        normal += spot.normal[1] * axis
        point = self.radius * (e[0] * ring + e[1] * across) + self.frame.reshape(shape)
        return point + self.tube * normal, normal


def _faces(
    part: Part, shaft: Shaft, is_rim: npt.NDArray[np.bool_], hole: npt.NDArray[np.int64]
) -> tuple[FloatArray, FloatArray]:
    """Normals (2, F, n) and offsets (F, n) of the faces that n circles meet.

    A solid with fewer faces than another gets faces that no point is below the least.
    """
    solids = [*part.wall_faces, shaft.faces]
    most = max(len(faces.offsets_m) for faces in solids)
    normals, offsets = np.zeros((len(solids), most, 2)), np.full((len(solids), most), -np.inf)
    offsets[-1] = np.inf
    for row, faces in enumerate(solids):
        normals[row, : len(faces.offsets_m)] = faces.normals
        offsets[row, : len(faces.offsets_m)] = faces.offsets_m
    solid = np.where(is_rim, len(solids) - 1, hole)
    return np.moveaxis(normals[solid], 0, -1).swapaxes(0, 1), offsets[solid].T
