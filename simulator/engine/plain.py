"""Contact of one circle where a closed form gives it: two screens and two solutions.

All in the heading frame of `simulator.deepest`. Rims are those of the part, against the shaft's
cylinder; edges are those of the shaft, against a bore.
"""

import math

from simulator.compiled import inlined
from simulator.engine.direction import NEAR, near_direction
from simulator.engine.loads import Vector

_SMALLEST = 1e-150

Contact = tuple[Vector, Vector, float, bool]
"""Point, normal, penetration, and whether a search has to find them instead."""


@inlined
def rim_is_near(
    sin: float, cos: float, x: float, y: float, z: float,
    shaft: float, length: float, plane: float, radius: float,
) -> bool:  # fmt: skip
    """Whether the rim can touch the shaft's cylinder between its ends."""
    height = plane - z
    along = cos * x + sin * height
    m = along * cos
    lift = radius * sin
    excess = along * along + y * y + (radius - shaft) * (radius + shaft) - lift * lift
    square = 4.0 * radius * radius * (m * m + y * y)
    touches = (excess < 0.0) | (excess * excess < square)
    entered = sin * x - cos * height
    return touches & (entered + lift > 0.0) & (entered - lift < length)


@inlined
def edge_is_near(
    sin: float, cos: float, x: float, y: float, z: float,
    behind: float, radius: float, tube: float, entry: float, exit_: float, bore: float,
) -> bool:  # fmt: skip
    """Whether the edge can touch the bore between, or past either end no more than it overlaps."""
    x -= behind * sin
    z -= behind * cos
    m = x * cos
    lift = radius * sin
    wall = bore - tube
    excess = x * x + y * y + (radius - wall) * (radius + wall)
    square = 4.0 * radius * radius * (m * m + y * y)
    touches = (excess > 0.0) | (excess * excess < square) | (wall < 0.0)
    beyond = lift + abs(x) + abs(y) + radius - wall
    return touches & (z + beyond > entry) & (z - beyond < exit_)


@inlined
def rim_direction(
    sin: float, cos: float, x: float, y: float, z: float, plane: float, radius: float
) -> Vector:
    """Direction of a rim's deepest point, and its ratio; see `near_direction`."""
    along = -(cos * x + sin * (plane - z))
    return near_direction(-along * cos, y, radius * sin * sin)


@inlined
def rim_contact(
    best: Vector, sin: float, cos: float, x: float, y: float, z: float,
    shaft: float, length: float, first: float, per_first: float, last: float, per_last: float,
    plane: float, radius: float,
) -> Contact:  # fmt: skip
    """Contact of a rim with the cylinder at the point in its best direction.

    The numbers of the shaft are as in `Table.columns`.
    """
    height = plane - z
    along = -(cos * x + sin * height)
    bulge = radius * sin * sin
    e1, e2, ratio = best
    a, b = along + cos * radius * e1, radius * e2 - y
    distance = math.sqrt(a * a + b * b)
    overlap = shaft - distance
    entered = sin * x - cos * height - sin * radius * e1
    left = length - entered
    depth = entered if entered < left else left
    depth = overlap if overlap < depth else depth
    penetration = depth if depth > 0.0 else 0.0
    could_be = depth + 2.0 * radius * sin
    could_be = could_be if could_be < overlap else overlap
    around = along * along + y * y + (radius - shaft) * (radius + shaft) < 2.0 * radius * bulge
    is_cylinder = (entered >= first + per_first * overlap) & (entered <= last - per_last * overlap)
    search = (could_be > penetration) | around | (not is_cylinder)
    search = (overlap > 0.0) & search | (not ratio <= NEAR)
    inverse = 1.0 / (distance if distance > _SMALLEST else _SMALLEST)
    a, b = a * inverse, b * inverse
    point = radius * e1, radius * e2, plane
    return point, (cos * a, b, -sin * a), penetration, search


@inlined
def edge_contact(
    sin: float, cos: float, x: float, y: float, z: float,
    behind: float, radius: float, tube: float, trailing: int,
    entry: float, exit_: float, bore: float, first: float, per_first: float,
) -> Contact:  # fmt: skip
    """Contact of a shaft edge with the bore of a wall; its numbers are as in `Table.columns`."""
    x -= behind * sin
    z -= behind * cos
    bulge = radius * sin * sin
    e1, e2, ratio = near_direction(y, x * cos, bulge)
    a, b, c = x + cos * radius * e2, y + radius * e1, z - sin * radius * e2
    distance = math.sqrt(a * a + b * b)
    bare = distance - bore
    overlap = bare + tube
    above, below = c - entry, exit_ - c
    entered = below if trailing else above
    passed = above if trailing else below
    depth = (overlap if overlap < entered else entered) + (passed if passed < 0.0 else 0.0)
    penetration = depth if depth > 0.0 else 0.0
    could_be = depth + 2.0 * radius * sin
    could_be = could_be if could_be < overlap else overlap
    wall = bore - tube
    around = x * x + y * y + (radius - wall) * (radius + wall) > -2.0 * radius * bulge
    search = (could_be > penetration) | around | (above < first + per_first * bare)
    search = (overlap > 0.0) & search | (not ratio <= NEAR)
    inverse = 1.0 / (distance if distance > _SMALLEST else _SMALLEST)
    a, b, u, v = a * inverse, b * inverse, a, b
    return (u + tube * a, v + tube * b, c), (a, b, 0.0), penetration, search
