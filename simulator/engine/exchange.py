"""Between the arrays of a batch and the lanes of a block."""

import numpy as np

from simulator.checks import FloatArray
from simulator.compiled import Record, scalar
from simulator.engine.batch import Found, Given
from simulator.engine.pose import heading, is_valid
from simulator.engine.states import INVALID, contact_state
from simulator.engine.table import WALL_COLUMNS, Table

_NONE = np.uint64(0)


@scalar
def take_poses(lane: Record, given: Given, start: int, count: int, used: int) -> None:
    """Poses and sliding directions in the heading frames; lanes left over repeat the first."""
    for j in range(used):
        i = start + (j if j < count else 0)
        pose = given.poses[i]
        lane.x[j], lane.y[j], lane.z[j] = pose[0], pose[1], pose[2]
        lane.turn_x[j], lane.turn_y[j] = pose[3], pose[4]
    for j in range(used):
        i = start + (j if j < count else 0)
        slide = given.sliding[i if len(given.sliding) > 1 else 0]
        lane.slide_x[j], lane.slide_y[j], lane.slide_z[j] = slide[0], slide[1], slide[2]
    for j in range(used):
        i = start + (j if j < count else 0)
        lane.stiffness[j] = given.stiffness[i if len(given.stiffness) > 1 else 0]
        lane.friction[j] = given.friction[i if len(given.friction) > 1 else 0]
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
    for j in range(used):
        i = start + (j if j < count else 0)
        lane.geometry[j] = given.geometry[i if len(given.geometry) > 1 else 0]
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
        state, points = contact_state(
            lane.upper[j], lane.lower[j], lane.z[j], columns[wall + 1, j], second_entry
        )
        lane.state[j], lane.points[j] = state if lane.valid[j] else INVALID, points
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
    for j in range(count):
        i, nothing = start + j, lane.nothing[j]
        found.wrench[i, 0] = lane.force_x[j] + nothing
        found.wrench[i, 1] = lane.force_y[j] + nothing
        found.wrench[i, 2] = lane.force_z[j] + nothing
        found.wrench[i, 3] = lane.torque_x[j] + nothing
        found.wrench[i, 4] = lane.torque_y[j] + nothing
        found.wrench[i, 5] = lane.torque_z[j] + nothing
        found.penetration[i] = lane.penetration[j] + nothing
        found.state[i], found.points[i] = lane.state[j], lane.points[j]
