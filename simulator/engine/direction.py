"""Best direction on a circle: the unit vector e that maximises 2 m.e + b e1^2, b >= 0.

`simulator.extremum` derives the problem. A circle that nearly touches at a small tilt has b far
below |m|, so that e is m turned by a small angle; this case has no branches.
"""

import math

from simulator.compiled import inlined, scalar

NEAR = 1.0 / 32.0
"""Largest b/|m| of `near_direction`."""
_TINY = 1e-300
_FLOOR = 1e-20
_SMALLEST_SQUARE = 1e-290
_NEWTON_STEPS = 5


@inlined
def near_direction(m1: float, m2: float, b: float) -> tuple[float, float, float]:
    """The unit vector e, exact to rounding for b/|m| up to `NEAR`, and b/|m|; inf for m = 0.

    With m/|m| = (c, s) and v the sine of the angle from m to e, stationarity reads
    v + b/(2|m|) sin(2 angle(m) + 2 asin(v)) = 0. The start solves it up to third order in v; one
    step of Newton's, its slope to second order in b/|m|, leaves rounding.
    """
    square = m1 * m1 + m2 * m2
    inverse = 1.0 / math.sqrt(square if square > _SMALLEST_SQUARE else _SMALLEST_SQUARE)
    c, s = m1 * inverse, m2 * inverse
    ratio = b * inverse if square > _SMALLEST_SQUARE else math.inf
    sine, cosine = ratio * c * s, ratio * (c - s) * (c + s)
    step = 1.0 - cosine * (1.0 - cosine * (1.0 - cosine * (1.0 - cosine)))
    v = -sine * step
    v += v * v * (2.0 * sine + 0.5 * cosine * v) * step
    vv = v * v
    w = 1.0 - vv * (0.5 + vv * (0.125 + vv * 0.0625))
    change = (v + sine * (1.0 - 2.0 * vv) + cosine * v * w) * step
    v -= change * (1.0 + (4.0 * sine + 1.5 * cosine * v) * v * step)
    vv = v * v
    w = 1.0 - vv * (0.5 + vv * (0.125 + vv * 0.0625))
    return c * w - s * v, s * w + c * v, ratio


@scalar
def direction(m1: float, m2: float, b: float) -> tuple[float, float]:
    """The unit vector e for any m and b; m = 0 gives (1, 0)."""
    a, c = abs(m1), abs(m2)
    largest = a + max(b, c) + _TINY
    a += _FLOOR * largest
    scale = largest + (a * a * b) ** (1.0 / 3.0)
    a, c, b = a / scale, c / scale, b / scale
    e1, e2 = math.sqrt(1.0 - c * c), c
    for _ in range(_NEWTON_STEPS):
        e1, e2 = a + b * e1 * e1 * e1, c - b * e2 * e2 * e2
        inverse = 1.0 / math.sqrt(e1 * e1 + e2 * e2)
        e1, e2 = e1 * inverse, e2 * inverse
    return math.copysign(e1, m1), math.copysign(e2, m2)


@inlined
def best_direction(m1: float, m2: float, b: float) -> tuple[float, float]:
    """The unit vector e for any m and b, in the quickest way."""
    e1, e2, ratio = near_direction(m1, m2, b)
    if not ratio <= NEAR:
        e1, e2 = direction(m1, m2, b)
    return e1, e2
