"""Sine and cosine of a tilt without branches or calls, so that loops over them vectorise."""

import math

from simulator.compiled import inlined

_HALF_PI, _HALF_PI_REST = 0.5 * math.pi, 6.123233995736766e-17
_QUARTER_PI = 0.25 * math.pi


@inlined
def sin_cos(x: float) -> tuple[float, float]:
    """Sine and cosine of x in (-pi/2, pi/2), each within one unit in the last place.

    The polynomials are those of fdlibm, for up to pi/4.
    """
    size = abs(x)
    far = size > _QUARTER_PI
    r = (_HALF_PI - size) + _HALF_PI_REST if far else size
    z = r * r
    odd = 2.75573137070700676789e-06 + z * (
        -2.50507602534068634195e-08 + z * 1.58969099521155010221e-10
    )
    odd = 8.33333333332248946124e-03 + z * (-1.98412698298579493134e-04 + z * odd)
    s = r + r * z * (-1.66666666666666324348e-01 + z * odd)
    even = -2.75573143513906633035e-07 + z * (
        2.08757232129817482790e-09 - z * 1.13596475577881948265e-11
    )
    even = -1.38888888888741095749e-03 + z * (2.48015872894767294178e-05 + z * even)
    half = 0.5 * z
    one = 1.0 - half
    c = one + (((1.0 - one) - half) + z * z * (4.16666666666666019037e-02 + z * even))
    sin = c if far else s
    cos = s if far else c
    return (-sin if x < 0.0 else sin), cos
