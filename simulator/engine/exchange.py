"""Between the arrays of a batch and the lanes of a block."""

from typing import Any

import numpy as np
import numpy.typing as npt

from simulator.checks import FloatArray
from simulator.compiled import Record, inlined, prefetch, scalar
from simulator.engine.batch import Found, Given
from simulator.engine.lanes import LINE
from simulator.engine.pose import heading, is_valid
from simulator.engine.states import INVALID, contact_state
from simulator.engine.table import WALL_COLUMNS, Table

_NONE = np.uint64(0)


@inlined
def _prefetch_rows(array: npt.NDArray[Any], start: int, stop: int) -> None:
    """Fetch rows `start` to `stop` - 1, as far as there are any."""
    row = array.strides[0]
    for byte in range(start * row, min(stop, len(array)) * row, LINE):
        prefetch(array.ctypes.data + byte)


@inlined
def prefetch_part(
    given: Given, found: Found, start: int, count: int, part: int, parts: int
) -> None:
    """Have the cache fetch the next block's poses, and the memory of the results of this one.

    Of `parts` calls between a block's arithmetic each asks for a share: memory takes only so many
    requests at a time.
    """
    first, last = start + count * part // parts, start + count * (part + 1) // parts
    _prefetch_rows(given.poses, first + count, last + count)
    _prefetch_rows(found.wrench, first, last)
    _prefetch_rows(found.penetration, first, last)
    _prefetch_rows(found.state, first, last)
    _prefetch_rows(found.points, first, last)


@inlined
def _take(
    field: npt.NDArray[Any],
    lane: Record,
    numbers: npt.NDArray[Any],
    start: int,
    count: int,
    used: int,
) -> None:
    """Numbers, one per pose or one for all, into a field of the lanes."""
    if len(numbers) > 1:
        for i in range(used):
            j, row = (lane.at[i], start + i) if i < count else (np.uint64(i), start)
            field[j] = numbers[row]
    else:
        for j in range(used):
            field[j] = numbers[0]


@scalar
def take_poses(lane: Record, given: Given, start: int, count: int, used: int) -> None:
    """Poses and sliding directions in the heading frames; lanes left over repeat the first."""
    poses = given.poses[start : start + count]
    for i in range(used):
        j, row = (lane.at[i], i) if i < count else (np.uint64(i), 0)
        lane.x[j], lane.y[j], lane.z[j] = poses[row, 0], poses[row, 1], poses[row, 2]
        lane.turn_x[j], lane.turn_y[j] = poses[row, 3], poses[row, 4]
    if len(given.sliding) > 1:
        for i in range(used):
            j, row = (lane.at[i], start + i) if i < count else (np.uint64(i), start)
            slide = given.sliding[row]
            lane.slide_x[j], lane.slide_y[j], lane.slide_z[j] = slide[0], slide[1], slide[2]
    else:
        slide = given.sliding[0]
        for j in range(used):
            lane.slide_x[j], lane.slide_y[j], lane.slide_z[j] = slide[0], slide[1], slide[2]
    _take(lane.stiffness, lane, given.stiffness, start, count, used)
    _take(lane.friction, lane, given.friction, start, count, used)
    for j in range(used):
        x, y, z, rx, ry = lane.x[j], lane.y[j], lane.z[j], lane.turn_x[j], lane.turn_y[j]
        dx, dy, dz = lane.slide_x[j], lane.slide_y[j], lane.slide_z[j]
        valid = is_valid(x, y, z, rx, ry, dx, dy, dz)
        lane.valid[j] = valid
        turn_x, turn_y, sin, cos = heading(rx, ry)
        lane.turn_x[j], lane.turn_y[j], lane.sin[j], lane.cos[j] = turn_x, turn_y, sin, cos
        lane.x[j] = turn_x * x + turn_y * y
        lane.y[j] = turn_x * y - turn_y * x
        lane.z[j] = z if valid else np.nan
        lane.slide_x[j] = turn_x * dx + turn_y * dy
        lane.slide_y[j] = turn_x * dy - turn_y * dx
        lane.force_x[j], lane.force_y[j], lane.force_z[j] = 0.0, 0.0, 0.0
        lane.torque_x[j], lane.torque_y[j], lane.torque_z[j] = 0.0, 0.0, 0.0
        lane.penetration[j] = 0.0
        lane.upper[j], lane.lower[j], lane.blocked[j] = _NONE, _NONE, _NONE


@scalar
def take_geometries(
    lane: Record, columns: FloatArray, given: Given, table: Table, start: int, count: int, used: int
) -> None:
    """Rows of the table for the lanes."""
    _take(lane.geometry, lane, given.geometry, start, count, used)
    for column in range(len(columns)):
        for j in range(used):
            columns[column, j] = table.columns[lane.geometry[j], column]


@scalar
def give(
    lane: Record,
    columns: FloatArray,
    wall: int,
    walls: int,
    found: Found,
    start: int,
    count: int,
    used: int,
) -> None:
    """Turn the sums into M and hand them out."""
    for j in range(used):
        second_entry = columns[wall + WALL_COLUMNS, j] if walls > 1 else np.nan
        state, touching = contact_state(
            lane.upper[j], lane.lower[j], lane.z[j], columns[wall + 1, j], second_entry
        )
        lane.state[j], lane.points[j] = state if lane.valid[j] else INVALID, touching
        nothing = 0.0 if lane.valid[j] else np.nan
        stiffness = lane.stiffness[j]
        turn_x, turn_y = lane.turn_x[j] * stiffness, lane.turn_y[j] * stiffness
        lane.force_z[j] *= stiffness
        lane.torque_z[j] *= stiffness
        x, y = lane.force_x[j], lane.force_y[j]
        lane.force_x[j], lane.force_y[j] = turn_x * x - turn_y * y, turn_x * y + turn_y * x
        x, y = lane.torque_x[j], lane.torque_y[j]
        lane.torque_x[j], lane.torque_y[j] = turn_x * x - turn_y * y, turn_x * y + turn_y * x
        lane.nothing[j] = nothing
    rows = slice(start, start + count)
    wrench, penetration = found.wrench[rows], found.penetration[rows]
    states, points = found.state[rows], found.points[rows]
    for i in range(count):
        j = lane.at[i]
        nothing = lane.nothing[j]
        wrench[i, 0] = lane.force_x[j] + nothing
        wrench[i, 1] = lane.force_y[j] + nothing
        wrench[i, 2] = lane.force_z[j] + nothing
        wrench[i, 3] = lane.torque_x[j] + nothing
        wrench[i, 4] = lane.torque_y[j] + nothing
        wrench[i, 5] = lane.torque_z[j] + nothing
        penetration[i] = lane.penetration[j] + nothing
        states[i], points[i] = lane.state[j], lane.points[j]
