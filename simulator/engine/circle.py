"""A circle of either kind against the faces of the other solid, one point at a time.

The circle is worked in the frame of the solid that it enters; see `simulator.circle`.
"""

import math
from typing import NamedTuple

from simulator.checks import FloatArray
from simulator.compiled import inlined, scalar
from simulator.engine.loads import Vector

RIM, LEADING_EDGE, TRAILING_EDGE = range(3)
SMALLEST = 1e-150


class Circle(NamedTuple):
    """A circle in the frame of the other solid; lengths in m. See `simulator.circle.Circles`."""

    kind: int
    radius: float
    tube: float
    sin: float
    cos: float
    along: float
    across: float
    axial: float
    length: float
    x: float
    y: float
    z: float
    """Centre in the heading frame."""
    rounding: float
    """Radius of the shaft's rounded end, and below of the circle of its centres."""
    core: float


class Spot(NamedTuple):
    """A point of a circle: depth below the least deep face, and its growth outwards and axially."""

    depth: float
    radial: float
    axial: float
    out: Vector
    """Distance from the solid's axis, and unit vector from it along and across the tilt."""
    at: float
    """Axial coordinate."""


class Pieces(NamedTuple):
    """The least of several functions at a point and its slope with the angle, and the second."""

    value: float
    slope: float
    second: float
    second_slope: float


@scalar
def rim_circle(
    sin: float, cos: float, x: float, y: float, z: float,
    shaft: float, length: float, rounding: float, plane: float, radius: float,
) -> Circle:  # fmt: skip
    """The circle of a rim."""
    height = plane - z
    along, axial = -(cos * x + sin * height), sin * x - cos * height
    return Circle(
        RIM,
        radius,
        0.0,
        sin,
        cos,
        along,
        -y,
        axial,
        length,
        0.0,
        0.0,
        plane,
        rounding,
        shaft - rounding,
    )


@scalar
def edge_circle(
    sin: float, cos: float, x: float, y: float, z: float,
    behind: float, radius: float, tube: float, trailing: int, entry: float, exit_: float,
) -> Circle:  # fmt: skip
    """The circle of a shaft edge."""
    x, z = x - behind * sin, z - behind * cos
    kind = TRAILING_EDGE if trailing else LEADING_EDGE
    return Circle(kind, radius, tube, sin, cos, x, y, z - entry, exit_ - entry, x, y, z, 0.0, 0.0)


@inlined
def spot(circle: Circle, faces: FloatArray, e1: float, e2: float) -> Spot:
    """The point of the unit vector (e1 along, e2 across the tilt)."""
    a = circle.along + circle.cos * circle.radius * e1
    b = circle.across + circle.radius * e2
    rho = math.sqrt(a * a + b * b)
    at = circle.axial - circle.sin * circle.radius * e1
    depth, radial, axial = math.inf, 0.0, 0.0
    for face in range(len(faces)):
        below = faces[face, 0] + faces[face, 1] * rho + faces[face, 2] * at
        if below < depth:
            depth, radial, axial = below, faces[face, 1], faces[face, 2]
    if circle.rounding > 0.0:
        out, ahead = max(rho - circle.core, 0.0), max(circle.rounding - at, 0.0)
        reach = math.sqrt(out * out + ahead * ahead)
        aside = circle.core + circle.rounding - rho
        below = circle.rounding - reach if reach > 0.0 else min(aside, at)
        if below < depth:
            depth = below
            if reach > 0.0:
                radial, axial = -out / reach, ahead / reach
            else:
                radial, axial = (-1.0, 0.0) if aside <= at else (0.0, 1.0)
    inverse = 1.0 / max(rho, SMALLEST)
    return Spot(depth + circle.tube, radial, axial, (rho, a * inverse, b * inverse), at)


@inlined
def depth_slope(circle: Circle, point: Spot, e1: float, e2: float) -> float:
    """Slope of the depth with the angle."""
    lift = circle.sin * circle.radius
    half_square = circle.across * circle.radius * e1
    half_square += (lift * lift * e1 - circle.along * circle.cos * circle.radius) * e2
    return point.radial * half_square / max(point.out[0], SMALLEST) + point.axial * lift * e2


@inlined
def _lower(least: Pieces, value: float, slope: float) -> Pieces:
    """The two least of three functions."""
    if value < least.value:
        return Pieces(value, slope, least.value, least.slope)
    if value < least.second:
        return Pieces(least.value, least.slope, value, slope)
    return least


@inlined
def effective(circle: Circle, point: Spot, depth_slope: float, e2: float) -> Pieces:
    """Effective penetration at a point, from the slope of the depth there."""
    entered, rise = point.at, circle.sin * circle.radius * e2
    if circle.kind == TRAILING_EDGE:
        entered, rise = circle.length - entered, -rise
    left = circle.length - entered
    least = _lower(Pieces(point.depth, depth_slope, math.inf, 0.0), entered, rise)
    if circle.kind == RIM:
        return _lower(least, left, -rise)
    least = _lower(least, point.depth + left, depth_slope - rise)
    return _lower(least, entered + left, 0.0)


@inlined
def place(circle: Circle, point: Spot, e1: float, e2: float) -> tuple[Vector, Vector]:
    """Point and normal in the heading frame."""
    sin, cos = circle.sin, circle.cos
    _, out_1, out_2 = point.out
    if circle.kind == RIM:
        radial, axial = -point.radial, -point.axial
        normal = (
            radial * cos * out_1 - axial * sin,
            radial * out_2,
            -radial * sin * out_1 - axial * cos,
        )
        return (circle.radius * e1, circle.radius * e2, circle.z), normal
    normal = point.radial * out_1, point.radial * out_2, point.axial
    return (
        circle.x + circle.radius * cos * e1 + circle.tube * normal[0],
        circle.y + circle.radius * e2 + circle.tube * normal[1],
        circle.z - circle.radius * sin * e1 + circle.tube * normal[2],
    ), normal
