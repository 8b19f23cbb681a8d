"""A pose: whether it is one, and its heading."""

import math

from simulator.compiled import inlined
from simulator.engine.trigonometry import sin_cos

_UPRIGHT_SQUARE = 1e-290
_HALF_PI = 0.5 * math.pi
_LARGEST = 1e100


@inlined
def is_valid(
    x: float, y: float, z: float, rx: float, ry: float, dx: float, dy: float, dz: float
) -> bool:
    """Whether both tilts are under a quarter turn, and place and sliding direction finite.

    The latter two may be as large as 1e100, so that their squares are finite too.
    """
    size = abs(x) + abs(y) + abs(z) + abs(dx) + abs(dy) + abs(dz)
    return (size < _LARGEST) & (abs(rx) < _HALF_PI) & (abs(ry) < _HALF_PI)


@inlined
def heading(rx: float, ry: float) -> tuple[float, float, float, float]:
    """Unit vector of the tilt in M, (1, 0) if upright, and sine and cosine of the whole tilt."""
    sin_x, cos_x = sin_cos(rx)
    sin_y, cos_y = sin_cos(ry)
    x, y = sin_y * cos_x, -sin_x
    square = x * x + y * y
    sin = math.sqrt(square)
    upright = square < _UPRIGHT_SQUARE
    inverse = 1.0 / (1.0 if upright else sin)
    return 1.0 if upright else x * inverse, 0.0 if upright else y * inverse, sin, cos_y * cos_x
