"""The kernel of the CPU: blocks of poses, one contact candidate after the other.

A block's lanes are poses in their heading frames, ordered so that those that touch a circle are
neighbours. From the first to the last of them, lanes are solved in vectors; a few are searched one
by one. Each lane adds its contacts in the same order and in the same arithmetic wherever it stands
and whatever its neighbours are: results do not depend on the batch.
"""

import numpy as np

from simulator.checks import FloatArray
from simulator.compiled import Record, inlined, kernel, scalar
from simulator.engine.batch import Found, Given
from simulator.engine.blocking import find_ends, stand_on_walls
from simulator.engine.circle import edge_circle, rim_circle
from simulator.engine.exchange import give, prefetch_part, take_geometries, take_poses
from simulator.engine.lanes import BLOCK, VECTOR
from simulator.engine.loads import Wrench, contact_load
from simulator.engine.order import order_lanes
from simulator.engine.plain import (
    Contact,
    edge_contact,
    edge_is_near,
    rim_contact,
    rim_direction,
    rim_is_near,
)
from simulator.engine.search import searched_contact
from simulator.engine.table import EDGE_COLUMNS, RIM_COLUMNS, SHAFT_COLUMNS, WALL_COLUMNS, Table

_NONE, _ONE, _FIRST = np.uint64(0), np.uint64(1), np.uint64(0)


@inlined
def _screen_rim(lane: Record, columns: FloatArray, rim: int, used: int) -> None:
    for j in range(used):
        lane.near[j] = rim_is_near(
            lane.sin[j], lane.cos[j], lane.x[j], lane.y[j], lane.z[j],
            columns[0, j], columns[1, j], columns[rim, j], columns[rim + 1, j],
        )  # fmt: skip


@inlined
def _screen_edge(lane: Record, columns: FloatArray, edge: int, wall: int, used: int) -> None:
    for j in range(used):
        lane.near[j] = edge_is_near(
            lane.sin[j], lane.cos[j], lane.x[j], lane.y[j], lane.z[j],
            columns[edge, j], columns[edge + 1, j], columns[edge + 2, j],
            columns[wall, j], columns[wall + 1, j], columns[wall + 2, j],
        )  # fmt: skip


@inlined
def _leave_out_blocked(lane: Record, wall: int, used: int) -> None:
    for j in range(used):
        lane.near[j] &= np.int64(((lane.blocked[j] >> np.uint64(wall)) & _ONE) ^ _ONE)


@scalar
def _span(lane: Record, used: int) -> tuple[np.uint64, np.uint64]:
    """The lanes from the first that is near to the last, in whole vectors."""
    first, end = used, 0
    for j in range(used):
        first = min(first, j if lane.near[j] else used)
        end = max(end, j + 1 if lane.near[j] else 0)
    end = (end + VECTOR - 1) // VECTOR * VECTOR
    # Loops over unsigned indices are known not to count from the end.
    return np.uint64(min(first // VECTOR * VECTOR, end)), np.uint64(end)


@inlined
def _fill(
    field: FloatArray,
    columns: FloatArray,
    row: int,
    first: np.uint64,
    end: np.uint64,
    alike: bool,
) -> None:
    """Copy a number of the geometry for lanes `first` to `end` - 1: loops then read fields only."""
    if alike:
        number = columns[row, 0]
        for j in range(first, end):
            field[j] = number
    else:
        for j in range(first, end):
            field[j] = columns[row, j]


@scalar
def _fill_shaft(lane: Record, columns: FloatArray, used: int, alike: bool) -> None:
    first, end = _FIRST, np.uint64(used)
    _fill(lane.shaft, columns, 0, first, end, alike)
    _fill(lane.length, columns, 1, first, end, alike)
    _fill(lane.first, columns, 2, first, end, alike)
    _fill(lane.per_first, columns, 3, first, end, alike)
    _fill(lane.last, columns, 4, first, end, alike)
    _fill(lane.per_last, columns, 5, first, end, alike)
    _fill(lane.rounding, columns, 6, first, end, alike)


@inlined
def _note(lane: Record, j: int, contact: Contact) -> None:
    """Note a contact, without penetration where it is not one or has to be searched."""
    point, normal, penetration, search = contact
    search &= lane.near[j] != 0
    lane.point_x[j], lane.point_y[j], lane.point_z[j] = point
    lane.normal_x[j], lane.normal_y[j], lane.normal_z[j] = normal
    lane.effective[j] = 0.0 if search or not lane.near[j] else penetration
    lane.search[j] = search


@inlined
def _add(
    lane: Record,
    j: int,
    wrench: Wrench,
    penetration: float,
    upper: np.uint64,
    lower: np.uint64,
) -> None:
    """Add a contact to its lane, with the bits of its station in `upper` and `lower`."""
    touches = penetration > 0.0
    lane.force_x[j] += wrench[0] if touches else 0.0
    lane.force_y[j] += wrench[1] if touches else 0.0
    lane.force_z[j] += wrench[2] if touches else 0.0
    lane.torque_x[j] += wrench[3] if touches else 0.0
    lane.torque_y[j] += wrench[4] if touches else 0.0
    lane.torque_z[j] += wrench[5] if touches else 0.0
    before = lane.penetration[j]
    lane.penetration[j] = penetration if penetration > before else before
    lane.upper[j] |= upper if touches else _NONE
    lane.lower[j] |= lower if touches else _NONE


@scalar
def _load(
    lane: Record, first: np.uint64, end: np.uint64, upper: np.uint64, lower: np.uint64
) -> None:
    """Add the loads of the contacts noted: a loop of its own, as short chains of operations
    overlap."""
    for j in range(first, end):
        point = lane.point_x[j], lane.point_y[j], lane.point_z[j]
        normal = lane.normal_x[j], lane.normal_y[j], lane.normal_z[j]
        sliding = lane.slide_x[j], lane.slide_y[j], lane.slide_z[j]
        load = contact_load(point, normal, lane.effective[j], sliding, lane.friction[j])
        _add(lane, j, load, lane.effective[j], upper, lower)


@inlined
def _solve_rim(
    lane: Record, columns: FloatArray, table: Table, rim: int, row: int, used: int, alike: bool
) -> None:
    first, end = _span(lane, used)
    if first == end:
        return
    bit = _ONE << np.uint64(table.rim_walls[rim])
    upper, lower = (_NONE, bit) if table.rim_stations[rim] else (bit, _NONE)
    _fill(lane.a, columns, row, first, end, alike)
    _fill(lane.b, columns, row + 1, first, end, alike)
    # Two loops, as short chains of operations overlap.
    for j in range(first, end):
        lane.e1[j], lane.e2[j], lane.ratio[j] = rim_direction(
            lane.sin[j], lane.cos[j], lane.x[j], lane.y[j], lane.z[j], lane.a[j], lane.b[j]
        )
    for j in range(first, end):
        contact = rim_contact(
            (lane.e1[j], lane.e2[j], lane.ratio[j]),
            lane.sin[j], lane.cos[j], lane.x[j], lane.y[j], lane.z[j],
            lane.shaft[j], lane.length[j],
            lane.first[j], lane.per_first[j], lane.last[j], lane.per_last[j],
            lane.a[j], lane.b[j],
        )  # fmt: skip
        _note(lane, j, contact)
    _load(lane, first, end, upper, lower)
    for j in range(first, end):
        if lane.search[j]:
            circle = rim_circle(
                lane.sin[j], lane.cos[j], lane.x[j], lane.y[j], lane.z[j],
                lane.shaft[j], lane.length[j], lane.rounding[j], lane.a[j], lane.b[j],
            )  # fmt: skip
            faces = table.shaft_faces[lane.geometry[j]]
            sliding = lane.slide_x[j], lane.slide_y[j], lane.slide_z[j]
            wrench, penetration = searched_contact(circle, faces, sliding, lane.friction[j])
            _add(lane, j, wrench, penetration, upper, lower)


@inlined
def _solve_edge(
    lane: Record, columns: FloatArray, table: Table, edge: int, wall: int, row: int, wall_row: int,
    used: int, alike: bool,
) -> None:  # fmt: skip
    first, end = _span(lane, used)
    if first == end:
        return
    trailing, bit = table.edge_trailing[edge], _ONE << np.uint64(wall)
    upper, lower = (bit, _NONE) if trailing else (_NONE, bit)
    _fill(lane.a, columns, row, first, end, alike)
    _fill(lane.b, columns, row + 1, first, end, alike)
    _fill(lane.c, columns, row + 2, first, end, alike)
    _fill(lane.d, columns, wall_row, first, end, alike)
    _fill(lane.e, columns, wall_row + 1, first, end, alike)
    _fill(lane.f, columns, wall_row + 2, first, end, alike)
    _fill(lane.g, columns, wall_row + 3, first, end, alike)
    _fill(lane.h, columns, wall_row + 4, first, end, alike)
    for j in range(first, end):
        contact = edge_contact(
            lane.sin[j], lane.cos[j], lane.x[j], lane.y[j], lane.z[j],
            lane.a[j], lane.b[j], lane.c[j], trailing,
            lane.d[j], lane.e[j], lane.f[j], lane.g[j], lane.h[j],
        )  # fmt: skip
        _note(lane, j, contact)
    _load(lane, first, end, upper, lower)
    for j in range(first, end):
        if lane.search[j]:
            circle = edge_circle(
                lane.sin[j], lane.cos[j], lane.x[j], lane.y[j], lane.z[j],
                lane.a[j], lane.b[j], lane.c[j], trailing, lane.d[j], lane.e[j],
            )  # fmt: skip
            faces = table.wall_faces[lane.geometry[j], wall]
            sliding = lane.slide_x[j], lane.slide_y[j], lane.slide_z[j]
            wrench, penetration = searched_contact(circle, faces, sliding, lane.friction[j])
            _add(lane, j, wrench, penetration, upper, lower)


@kernel
def solve_blocks(
    table: Table, given: Given, found: Found, first: int, last: int,
    lanes: Record, columns: FloatArray,
) -> None:  # fmt: skip
    """Solve poses `first` to `last` - 1.

    `lanes`, of one element, and `columns`, one row per column of the table and one column per lane,
    are working memory.
    """
    lane = lanes[0]
    rims, edges, walls = len(table.rim_walls), len(table.edge_trailing), len(table.mouths)
    first_edge = SHAFT_COLUMNS + RIM_COLUMNS * rims
    first_wall = first_edge + EDGE_COLUMNS * edges
    candidates = rims + edges * walls
    blocking = len(given.entered) > 0
    alike = len(given.geometry) == 1
    if alike:
        take_geometries(lane, columns, given, table, 0, 1, BLOCK)
        _fill_shaft(lane, columns, BLOCK, alike)
    for start in range(first, last, BLOCK):
        count = min(BLOCK, last - start)
        used = (count + VECTOR - 1) // VECTOR * VECTOR
        order_lanes(lane, given, table, start, count)
        take_poses(lane, given, start, count, used)
        if not alike:
            take_geometries(lane, columns, given, table, start, count, used)
            _fill_shaft(lane, columns, used, alike)
        if blocking:
            find_ends(lane, columns, first_edge, used)
            for wall in range(walls):
                mouth = SHAFT_COLUMNS + RIM_COLUMNS * table.mouths[wall]
                stand_on_walls(lane, columns, mouth, wall, given.entered, start, count)
        for rim in range(rims):
            row, wall = SHAFT_COLUMNS + RIM_COLUMNS * rim, table.rim_walls[rim]
            _screen_rim(lane, columns, row, used)
            if blocking:
                _leave_out_blocked(lane, wall, used)
            prefetch_part(given, found, start, count, rim, candidates)
            _solve_rim(lane, columns, table, rim, row, used, alike)
        for edge in range(edges):
            row = first_edge + EDGE_COLUMNS * edge
            for wall in range(walls):
                wall_row = first_wall + WALL_COLUMNS * wall
                _screen_edge(lane, columns, row, wall_row, used)
                if blocking:
                    _leave_out_blocked(lane, wall, used)
                prefetch_part(given, found, start, count, rims + edge * walls + wall, candidates)
                _solve_edge(lane, columns, table, edge, wall, row, wall_row, used, alike)
        give(lane, columns, first_wall, walls, found, start, count, used)
