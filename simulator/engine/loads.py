"""Force and torque of a contact with friction."""

import math

from simulator.compiled import inlined

_PARALLEL = 1e-9
_TINY = 1e-150

Vector = tuple[float, float, float]
Wrench = tuple[float, float, float, float, float, float]


@inlined
def contact_load(
    point: Vector, normal: Vector, penetration: float, sliding: Vector, friction: float
) -> Wrench:
    """Wrench about the origin of a contact at `point` and its friction, per unit of stiffness.

    As in `simulator.wrench.friction_direction`, friction fades where the sliding direction comes
    within 1e-9 rad of the normal.
    """
    (x, y, z), (nx, ny, nz), (dx, dy, dz) = point, normal, sliding
    along = nx * dx + ny * dy + nz * dz
    tx, ty, tz = dx - along * nx, dy - along * ny, dz - along * nz
    length = math.sqrt(tx * tx + ty * ty + tz * tz)
    least = abs(along) * _PARALLEL + _TINY
    drag = friction / (length if length > least else least)
    fx, fy, fz = (
        penetration * (nx + drag * tx),
        penetration * (ny + drag * ty),
        penetration * (nz + drag * tz),
    )
    return fx, fy, fz, y * fz - z * fy, z * fx - x * fz, x * fy - y * fx
