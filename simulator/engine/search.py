"""Contact of one circle by search, where several faces matter, an end cuts it, or it is a ring.

`simulator.circle` explains why a half circle, cut at the valleys of the faces, has one peak to an
arc.
"""

import math

from simulator.checks import FloatArray
from simulator.compiled import inlined, scalar
from simulator.engine.circle import (
    RIM,
    SMALLEST,
    TRAILING_EDGE,
    Circle,
    Spot,
    depth_slope,
    effective,
    place,
    spot,
)
from simulator.engine.direction import best_direction
from simulator.engine.loads import Vector, Wrench, contact_load
from simulator.engine.trigonometry import sin_cos

_TOLERANCE = 1e-14
"""Of a penetration, in radii, and of its angle."""
_MOST_STEPS = 250
_HALVINGS = 51
_HALF_PI = 0.5 * math.pi


@inlined
def _side(circle: Circle) -> float:
    """Sign of the component across the tilt on the better half circle."""
    return math.copysign(1.0, -circle.across if circle.kind == RIM else circle.across)


@scalar
def on_half(angle: float, side: float) -> tuple[float, float]:
    """The unit vector (cos, side sin) of an angle from 0 to pi."""
    sin, cos = sin_cos(angle - _HALF_PI)
    return -sin, side * cos


@scalar
def valley(circle: Circle, radial: float, axial: float) -> float:
    """Angle at which a rim's depth below a face has a valley; pi if it has none."""
    lift = circle.sin * circle.radius
    if radial == 0.0:
        return math.pi
    pull, ratio = abs(circle.across) * circle.radius, -axial / radial * lift
    fall = lift * lift + ratio * ratio
    if not pull < fall:
        return math.pi
    low = math.asin((pull / fall) ** (1.0 / 3.0))
    high = math.pi - low
    for _ in range(_HALVINGS):
        middle = 0.5 * (low + high)
        x, y = on_half(middle, 1.0)
        a, b = circle.along + circle.cos * circle.radius * x, abs(circle.across) - circle.radius * y
        rise = circle.along * circle.cos * circle.radius - lift * lift * x + pull * x / y
        if rise + ratio * math.sqrt(a * a + b * b) < 0.0:
            low = middle
        else:
            high = middle
    return 0.5 * (low + high)


@scalar
def _arc_end(circle: Circle, faces: FloatArray, start: float) -> float:
    """Where the arc ends that starts at an angle: the next valley of a rim, or pi."""
    end = math.pi
    if circle.kind == RIM:
        for face in range(len(faces)):
            angle = valley(circle, faces[face, 1], faces[face, 2])
            if start < angle < end:
                end = angle
    return end


@scalar
def deepest(circle: Circle, faces: FloatArray) -> tuple[float, float, Spot, float]:
    """Unit vector and spot of the greatest depth, to rounding, and its share of the load.

    Arcs are halved by the sign of the slope. At an edge between two faces the normals are weighted
    by the slopes on either side; see `simulator.circle.Circles.best`.
    """
    side = _side(circle)
    best, best_low, best_high = -math.inf, 0.0, 0.0
    start = 0.0
    while start < math.pi:
        low, high = start, _arc_end(circle, faces, start)
        start = high
        for _ in range(_HALVINGS):
            middle = 0.5 * (low + high)
            e1, e2 = on_half(middle, side)
            if depth_slope(circle, spot(circle, faces, e1, e2), e1, e2) * side > 0.0:
                low = middle
            else:
                high = middle
        e1, e2 = on_half(low, side)
        depth = spot(circle, faces, e1, e2).depth
        if depth > best:
            best, best_low, best_high = depth, low, high
    e1, e2 = on_half(best_high, side)
    behind = spot(circle, faces, e1, e2)
    fall = max(-depth_slope(circle, behind, e1, e2) * side, 0.0)
    e1, e2 = on_half(best_low, side)
    before = spot(circle, faces, e1, e2)
    rise = max(depth_slope(circle, before, e1, e2) * side, 0.0)
    weight = rise / max(rise + fall, SMALLEST)
    radial = before.radial + weight * (behind.radial - before.radial)
    axial = before.axial + weight * (behind.axial - before.axial)
    share = math.sqrt(radial * radial + axial * axial)
    return e1, e2, Spot(before.depth, radial, axial, before.out, before.at), share


@scalar
def greatest_penetration(circle: Circle, faces: FloatArray) -> float:
    """Greatest effective penetration on the circle.

    Nothing is higher than a point that has entered farthest and is not limited otherwise. Else arcs
    are narrowed by the sign of the slope. Most peaks are where two functions cross, and most others
    are smooth: a step goes where Newton's method puts the crossing, or else where the secant puts
    the level, if that is less than half as far as the last step went, or else to the middle.
    """
    side, best, start = _side(circle), -math.inf, 0.0
    entered = circle.length - circle.axial if circle.kind == TRAILING_EDGE else circle.axial
    if circle.kind == RIM:
        entered = min(entered, circle.length - entered)
    limit = entered + circle.sin * circle.radius
    enough = _TOLERANCE * circle.radius
    for end in (0.0, math.pi):
        e1, e2 = on_half(end, side)
        best = max(best, effective(circle, spot(circle, faces, e1, e2), 0.0, e2).value)
    while start < math.pi and best < limit - enough:
        low, high = start, _arc_end(circle, faces, start)
        start, angle = high, 0.5 * (low + high)
        rise, fall, stride = 0.0, 0.0, high - low
        for _ in range(_MOST_STEPS):
            e1, e2 = on_half(angle, side)
            point = spot(circle, faces, e1, e2)
            here = effective(circle, point, depth_slope(circle, point, e1, e2), e2)
            best = max(best, here.value)
            slope, second_slope = here.slope * side, here.second_slope * side
            apart = here.second - here.value
            if apart < enough and slope * second_slope < 0.0:
                break
            if slope > 0.0:
                low, rise = angle, slope
            else:
                high, fall = angle, -slope
            if high - low < _TOLERANCE or abs(slope) * (high - low) < enough:
                break
            target = angle + apart / (slope - second_slope)
            if not (low < target < high and abs(target - angle) < 0.5 * stride):
                target = low + (high - low) * rise / (rise + fall)
            if not (low < target < high and abs(target - angle) < 0.5 * stride):
                target = 0.5 * (low + high)
            angle, stride = target, abs(target - angle)
    return best


@scalar
def searched_contact(
    circle: Circle, faces: FloatArray, sliding: Vector, friction: float
) -> tuple[Wrench, float]:
    """Wrench of a circle's contact, with its ring, and the penetration."""
    bulge = circle.radius * circle.sin * circle.sin
    if circle.kind == RIM:
        e1, e2 = best_direction(-circle.along * circle.cos, -circle.across, bulge)
    else:
        e2, e1 = best_direction(circle.across, circle.along * circle.cos, bulge)
    point = spot(circle, faces, e1, e2)
    share, none = 1.0, (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    # No point of the circle is deeper below the face at hand, or has entered farther, by more.
    reach = 2.0 * circle.radius * circle.sin
    if min(point.depth, effective(circle, point, 0.0, e2).value + reach) + reach <= 0.0:
        return none, 0.0
    if point.axial != 0.0:
        e1, e2, point, share = deepest(circle, faces)
    value = effective(circle, point, 0.0, e2).value
    if point.depth <= 0.0:
        return none, 0.0
    penetration = max(value, 0.0)
    if min(value + reach, point.depth) > penetration:
        penetration = max(penetration, greatest_penetration(circle, faces))
    if penetration <= 0.0:
        return none, 0.0
    at, normal = place(circle, point, e1, e2)
    normal = normal[0] / share, normal[1] / share, normal[2] / share
    fx, fy, fz, mx, my, mz = contact_load(at, normal, penetration * share, sliding, friction)
    for _ in range(3):
        e1, e2 = -e2, e1
        point = spot(circle, faces, e1, e2)
        value = effective(circle, point, 0.0, e2).value
        if value > 0.0:
            at, normal = place(circle, point, e1, e2)
            more = contact_load(at, normal, value, sliding, friction)
            fx, fy, fz = fx + more[0], fy + more[1], fz + more[2]
            mx, my, mz = mx + more[3], my + more[4], mz + more[5]
    return (fx, fy, fz, mx, my, mz), penetration
