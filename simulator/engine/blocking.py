"""Ends that stand on the face of a wall; see `simulator.blocking`."""

import math

import numpy as np
import numpy.typing as npt

from simulator.checks import FloatArray
from simulator.compiled import Record, inlined, scalar
from simulator.engine.direction import best_direction
from simulator.engine.loads import contact_load

_ONE = np.uint64(1)


@inlined
def _end(
    sin: float, cos: float, x: float, y: float, z: float,
    behind: float, radius: float, rounding: float, e1: float, e2: float,
) -> tuple[float, float, float, float]:  # fmt: skip
    """Point of the end's rim at e1 across and e2 along the tilt, and its distance from the axis."""
    a, b = x - behind * sin + cos * radius * e2, y + radius * e1
    return a, b, z - behind * cos - sin * radius * e2 + rounding, math.sqrt(a * a + b * b)


@scalar
def find_ends(lane: Record, columns: FloatArray, edge: int, used: int) -> None:
    """The point of each end's rim that is farthest from the holes' axis."""
    for j in range(used):
        sin, cos, x, y, z = lane.sin[j], lane.cos[j], lane.x[j], lane.y[j], lane.z[j]
        behind, radius, rounding = columns[edge, j], columns[edge + 1, j], columns[6, j]
        e1, e2 = best_direction(y, cos * (x - behind * sin), radius * sin * sin)
        end_x, end_y, end_z, reach = _end(sin, cos, x, y, z, behind, radius, rounding, e1, e2)
        lane.end_x[j], lane.end_y[j], lane.end_z[j], lane.reach[j] = end_x, end_y, end_z, reach
        lane.lowest[j] = z - behind * cos + sin * radius + rounding


@scalar
def stand_on_walls(
    lane: Record,
    columns: FloatArray,
    mouth: int,
    wall: int,
    entered: npt.NDArray[np.bool_],
    start: int,
    count: int,
) -> None:
    """Carry `entered` on for wall number `wall`, and add the contact of ends that stand on it."""
    bit = _ONE << np.uint64(wall)
    for pose in range(count):
        i, j = start + pose, lane.at[pose]
        entry, clears = columns[mouth, j], lane.reach[j] <= columns[mouth + 1, j]
        entered[i, wall] = (lane.lowest[j] > entry) & (entered[i, wall] | clears)
        depth = lane.end_z[j] - entry
        if not entered[i, wall] and not clears and depth > 0.0:
            fx, fy, fz, mx, my, mz = contact_load(
                (lane.end_x[j], lane.end_y[j], lane.end_z[j]),
                (0.0, 0.0, 1.0),
                depth,
                (lane.slide_x[j], lane.slide_y[j], lane.slide_z[j]),
                lane.friction[j],
            )
            lane.force_x[j] += fx
            lane.force_y[j] += fy
            lane.force_z[j] += fz
            lane.torque_x[j] += mx
            lane.torque_y[j] += my
            lane.torque_z[j] += mz
            lane.penetration[j] = max(lane.penetration[j], depth)
            lane.lower[j] |= bit
            lane.blocked[j] |= bit
