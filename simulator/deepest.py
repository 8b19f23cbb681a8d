"""Deepest point of every contact candidate.

Worked in the heading frame: M turned about z so that the shaft's axis is u = (sin, 0, cos). With e
the unit vector to a point of the circle, a rim of radius R at height h above B2's centre p has

    (distance to the shaft's axis)^2 = const - R (2 m.e + R sin^2 e1^2)
    with m = (cos (cos p1 + sin h), p2),

and an edge circle of the shaft with centre c, points c + r (e1 (0, 1, 0) + e2 (cos, 0, -sin)), has

    (distance to the hole's axis)^2 = const + r (2 m.e + r sin^2 e1^2)
    with m = (p2, cos c1):

the smallest distance of the first and the largest of the second are the same search.
"""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from simulator.checks import FloatArray
from simulator.extremum import Search
from simulator.geometry import Part, Shaft

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

    def to_part(self, vectors: FloatArray) -> None:
        """Turn `vectors`, shape (3, ..., P), from the heading frame into M, in place."""
        x, y = vectors[0], vectors[1]
        crossed = self.turn[1] * x
        x *= self.turn[0]
        x -= self.turn[1] * y
        y *= self.turn[0]
        y += crossed


@dataclass(frozen=True, slots=True)
class Deepest:
    """Deepest points of C candidates for P poses."""

    overlap: FloatArray
    """(C, P) [m]: radial overlap there; negative is clearance."""
    entered: FloatArray
    """(C, P) [m]: how far the deepest point has come into the other solid, axially; for rims the
    distance to the shaft's nearer end."""
    passed: FloatArray
    """(C, P) [m]: how far the deepest point of a shaft edge is past the wall, at least 0; 0 for
    rims."""
    point: FloatArray
    """(3, C, P) [m]."""
    normal: FloatArray
    """(3, C, P): unit direction in which the shaft pushes the part, or zero if undefined."""
    undefined: npt.NDArray[np.bool_] | None
    """(C, P): where the circle is centred on the axis and has no deepest point; None if nowhere."""


def deepest_points(part: Part, shaft: Shaft, heading: Heading, search: Search) -> Deepest:
    """Deepest points, in M, of all 4N candidates for P poses in the heading frame."""
    rims, walls, poses = len(part.rim_radii_m), len(part.wall_radii_m), len(heading.sin)
    height = part.rim_depths_m[:, np.newaxis] - heading.centre[2]
    behind = np.array([[0.0], [shaft.length_m]])
    end_x = heading.centre[0] - behind * heading.sin
    end_z = heading.centre[2] - behind * heading.cos
    m, b = _problems(part, shaft, heading, height, end_x)
    e = search.direction(m, b)

    vectors = np.zeros((3, 2, rims + 2 * walls, poses))
    overlap, entered, passed = np.zeros((3, rims + 2 * walls, poses))
    undefined = None if m[0].all() else _centred(m, walls)
    found = Deepest(overlap, entered, passed, vectors[:, 0], vectors[:, 1], undefined)
    _place_rims(found, part, shaft, heading, height, e[:, :rims])
    _place_edges(found, part, shaft, heading, end_x, end_z, e[:, rims:])
    if undefined is not None:
        found.normal[:, undefined] = 0.0
    heading.to_part(vectors)
    return found


def _problems(
    part: Part, shaft: Shaft, heading: Heading, height: FloatArray, end_x: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """The searches m (2, 2N + 2, P) and b (2N + 2, P): those of the rims, then of B2 and B1."""
    rims, poses = height.shape
    sin, cos, centre = heading.sin, heading.cos, heading.centre
    m, b = np.empty((2, rims + 2, poses)), np.empty((rims + 2, poses))
    np.multiply(sin, height, out=m[0, :rims])
    m[0, :rims] += cos * centre[0]
    m[0, :rims] *= cos
    m[1, :rims] = m[0, rims:] = centre[1]
    np.multiply(cos, end_x, out=m[1, rims:])
    square = sin * sin
    np.multiply(part.rim_radii_m[:, np.newaxis], square, out=b[:rims])
    np.multiply(shaft.radius_m, square, out=b[rims:])
    return m, b


def _centred(m: FloatArray, walls: int) -> npt.NDArray[np.bool_] | None:
    """Candidates (C, P) whose search has m = 0; None if there is none."""
    zero = np.logical_and(m[0] == 0.0, m[1] == 0.0)
    if not zero.any():
        return None
    return np.concatenate([zero[: 2 * walls], zero[2 * walls :].repeat(walls, axis=0)])


def _place_rims(
    found: Deepest, part: Part, shaft: Shaft, heading: Heading, height: FloatArray, e: FloatArray
) -> None:
    """Fill in the rows of the rims, in the heading frame, from the best unit vectors (2, 2N, P)."""
    rims, sin, cos = len(height), heading.sin, heading.cos
    point, normal = found.point[:, :rims], found.normal[:, :rims]
    np.multiply(part.rim_radii_m[:, np.newaxis], e, out=point[:2])
    point[2] = part.rim_depths_m[:, np.newaxis]
    offset = point[:2] - heading.centre[:2, np.newaxis]
    minus_sin = -sin
    engaged = minus_sin * offset[0]
    engaged -= cos * height
    np.minimum(engaged, shaft.length_m - engaged, out=found.entered[:rims])
    offset[0] *= cos
    offset[0] -= sin * height
    distance = np.hypot(offset[0], offset[1])
    np.subtract(shaft.radius_m, distance, out=found.overlap[:rims])
    offset /= np.maximum(distance, _SMALLEST, out=distance)
    np.multiply(cos, offset[0], out=normal[0])
    normal[1] = offset[1]
    np.multiply(minus_sin, offset[0], out=normal[2])


def _place_edges(
    found: Deepest,
    part: Part,
    shaft: Shaft,
    heading: Heading,
    end_x: FloatArray,
    end_z: FloatArray,
    e: FloatArray,
) -> None:
    """Fill in the rows of B2, then B1, against each wall from the best unit vectors (2, 2, P)."""
    walls, poses = len(part.wall_radii_m), e.shape[-1]
    reach = shaft.radius_m * e
    edge = np.empty((3, 2, 1, poses))
    np.add(end_x, heading.cos * reach[1], out=edge[0, :, 0])
    np.add(heading.centre[1], reach[0], out=edge[1, :, 0])
    np.subtract(end_z, heading.sin * reach[1], out=edge[2, :, 0])
    distance = np.hypot(edge[0], edge[1])
    below = edge[2] - part.rim_depths_m[:, np.newaxis]

    by_wall = (2, walls, poses)
    entered = found.entered[2 * walls :].reshape(by_wall)
    passed = found.passed[2 * walls :].reshape(by_wall)
    entered[0], passed[0] = below[0, 0::2], below[0, 1::2]
    np.negative(below[1, 1::2], out=entered[1])
    np.negative(below[1, 0::2], out=passed[1])
    np.maximum(passed, 0.0, out=passed)
    wall_radii = part.wall_radii_m[:, np.newaxis]
    np.subtract(distance, wall_radii, out=found.overlap[2 * walls :].reshape(by_wall))
    found.point[:, 2 * walls :].reshape(3, *by_wall)[...] = edge
    edge[:2] /= distance
    found.normal[:2, 2 * walls :].reshape(2, *by_wall)[...] = edge[:2]
