"""Radially deepest point of every contact candidate, in closed form.

That is the deepest point against the bore and against the cylinder of the shaft's diameter. Worked
in the heading frame, in which the shaft's axis is u = (sin, 0, cos). With e the unit vector to a
point of the circle, a rim of radius R at height h above the leading plane's centre p has

    (distance to the shaft's axis)^2 = const - R (2 m.e + R sin^2 e1^2)
    with m = (cos (cos p1 + sin h), p2),

and an edge circle of the shaft with centre c, points c + r (e1 (0, 1, 0) + e2 (cos, 0, -sin)), has

    (distance to the hole's axis)^2 = const + r (2 m.e + r sin^2 e1^2)
    with m = (p2, cos c1):

the smallest distance of the first and the largest of the second are the same search. A circle that
is centred on the axis and not tilted has e = (1, 0).
"""

from dataclasses import dataclass

import numpy as np

from simulator.checks import FloatArray
from simulator.extremum import Search
from simulator.geometry import Part, Shaft
from simulator.heading import Heading

_SMALLEST = 1e-150


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
    """(3, C, P): unit direction in which the shaft pushes the part."""
    share: FloatArray
    """(C, P): share of stiffness * penetration that acts along the normal: 1, but less at an edge
    between two faces, each of which takes a part."""
    e: FloatArray
    """(2, C, P): unit vector to the point, from the circle's centre, along the tilt and across."""


def deepest_points(part: Part, shaft: Shaft, heading: Heading, search: Search) -> Deepest:
    """Radially deepest points, in M, of all C candidates for P poses in the heading frame."""
    rims, walls, poses = len(part.rim_radii_m), len(part.wall_radii_m), len(heading.sin)
    edges = len(shaft.edge_radii_m)
    height = part.rim_depths_m[:, np.newaxis] - heading.centre[2]
    behind = shaft.edge_stations_m[:, np.newaxis]
    end_x = heading.centre[0] - behind * heading.sin
    end_z = heading.centre[2] - behind * heading.cos
    m, b = _problems(part, shaft, heading, height, end_x)
    best = search.direction(m, b)

    count = rims + edges * walls
    vectors = np.zeros((3, 2, count, poses))
    overlap, entered, passed = np.zeros((3, count, poses))
    share = np.ones((count, poses))
    e = np.empty((2, count, poses))
    e[:, :rims] = best[:, :rims]
    e[:, rims:].reshape(2, edges, walls, poses)[...] = best[::-1, rims:, np.newaxis]
    found = Deepest(overlap, entered, passed, vectors[:, 0], vectors[:, 1], share, e)
    _place_rims(found, part, shaft, heading, height, best[:, :rims])
    _place_edges(found, part, shaft, heading, end_x, end_z, best[:, rims:])
    heading.to_part(vectors)
    return found


def _problems(
    part: Part, shaft: Shaft, heading: Heading, height: FloatArray, end_x: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """The searches m (2, M + E, P) and b (M + E, P): of the rims, then of the shaft's edges."""
    rims, poses = height.shape
    sin, cos, centre = heading.sin, heading.cos, heading.centre
    count = rims + len(end_x)
    m, b = np.empty((2, count, poses)), np.empty((count, poses))
    np.multiply(sin, height, out=m[0, :rims])
    m[0, :rims] += cos * centre[0]
    m[0, :rims] *= cos
    m[1, :rims] = m[0, rims:] = centre[1]
    np.multiply(cos, end_x, out=m[1, rims:])
    square = sin * sin
    np.multiply(part.rim_radii_m[:, np.newaxis], square, out=b[:rims])
    np.multiply(shaft.edge_radii_m[:, np.newaxis], square, out=b[rims:])
    return m, b


def _place_rims(
    found: Deepest, part: Part, shaft: Shaft, heading: Heading, height: FloatArray, e: FloatArray
) -> None:
    """Fill in the rows of the rims, in the heading frame, from the best unit vectors (2, M, P)."""
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
    """Fill in the rows of the edges against each wall from the best unit vectors (2, E, P)."""
    rims, walls = len(part.rim_radii_m), len(part.wall_radii_m)
    edges, poses = e.shape[1:]
    reach = shaft.edge_radii_m[:, np.newaxis] * e
    edge = np.empty((3, edges, 1, poses))
    np.add(end_x, heading.cos * reach[1], out=edge[0, :, 0])
    np.add(heading.centre[1], reach[0], out=edge[1, :, 0])
    np.subtract(end_z, heading.sin * reach[1], out=edge[2, :, 0])
    distance = np.hypot(edge[0], edge[1])

    by_wall, leading = (edges, walls, poses), shaft.leading_edges
    entered = found.entered[rims:].reshape(by_wall)
    passed = found.passed[rims:].reshape(by_wall)
    np.subtract(edge[2], part.wall_entries_m[:, np.newaxis], out=entered)
    np.subtract(edge[2], part.wall_exits_m[:, np.newaxis], out=passed)
    behind = -passed[leading:]
    np.negative(entered[leading:], out=passed[leading:])
    entered[leading:] = behind
    np.maximum(passed, 0.0, out=passed)
    wall_radii = part.wall_radii_m[:, np.newaxis]
    np.subtract(distance, wall_radii, out=found.overlap[rims:].reshape(by_wall))
    point = found.point[:, rims:].reshape(3, *by_wall)
    point[...] = edge
    edge[:2] /= distance
    found.normal[:2, rims:].reshape(2, *by_wall)[...] = edge[:2]
    if shaft.rounding_m > 0.0:
        found.overlap[rims : rims + walls] += shaft.rounding_m
        point[:2, 0] += shaft.rounding_m * edge[:2, 0]
