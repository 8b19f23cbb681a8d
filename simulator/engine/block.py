"""The kernel of the CPU: blocks of poses, one contact candidate after the other.

A block's lanes are poses in their heading frames. Lanes and circles near each other are listed, so
that only these pairs are solved, in vectors; of these, a few are searched one by one. Each lane
adds its contacts in the same order and in the same arithmetic wherever it stands and whatever its
neighbours are: results do not depend on the batch.
"""

import numpy as np

from simulator.checks import FloatArray
from simulator.compiled import Record, inlined, kernel, scalar
from simulator.engine.batch import Found, Given
from simulator.engine.blocking import find_ends, stand_on_walls
from simulator.engine.circle import edge_circle, rim_circle
from simulator.engine.exchange import give, take_geometries, take_poses
from simulator.engine.lanes import BLOCK, LIST, VECTOR
from simulator.engine.loads import Vector, Wrench, contact_load
from simulator.engine.plain import (
    edge_contact,
    edge_is_near,
    rim_contact,
    rim_direction,
    rim_is_near,
)
from simulator.engine.search import searched_contact
from simulator.engine.table import EDGE_COLUMNS, RIM_COLUMNS, SHAFT_COLUMNS, WALL_COLUMNS, Table

_NONE, _ONE = np.uint64(0), np.uint64(1)


@scalar
def _screen_rim(lane: Record, columns: FloatArray, rim: int, used: int) -> None:
    for j in range(used):
        lane.near[j] = rim_is_near(
            lane.sin[j], lane.cos[j], lane.x[j], lane.y[j], lane.z[j],
            columns[0, j], columns[1, j], columns[rim, j], columns[rim + 1, j],
        )  # fmt: skip


@scalar
def _screen_edge(lane: Record, columns: FloatArray, edge: int, wall: int, used: int) -> None:
    for j in range(used):
        lane.near[j] = edge_is_near(
            lane.sin[j], lane.cos[j], lane.x[j], lane.y[j], lane.z[j],
            columns[edge, j], columns[edge + 1, j], columns[edge + 2, j],
            columns[wall, j], columns[wall + 1, j], columns[wall + 2, j],
        )  # fmt: skip


@scalar
def _leave_out_blocked(lane: Record, wall: int, used: int) -> None:
    for j in range(used):
        lane.near[j] &= np.int64(((lane.blocked[j] >> np.uint64(wall)) & _ONE) ^ _ONE)


@scalar
def _list(lane: Record, pair: Record, held: int, wall: int, lower: int, used: int) -> int:
    """Append the lanes that are near to the list of pairs; return its length."""
    end = held
    for j in range(used):
        pair.lane[end] = j
        end += lane.near[j]
    for k in range(held, held + (end - held + VECTOR - 1) // VECTOR * VECTOR):
        pair.wall[k], pair.lower[k] = wall, lower
    return end


@scalar
def _fill_shaft(pair: Record, start: int, end: int, columns: FloatArray, alike: bool) -> None:
    """Fill in the numbers of the shafts for pairs `start` to `end` - 1."""
    for k in range(start, end):
        j = 0 if alike else pair.lane[k]
        pair.shaft[k], pair.length[k] = columns[0, j], columns[1, j]
        pair.first[k], pair.per_first[k] = columns[2, j], columns[3, j]
        pair.last[k], pair.per_last[k] = columns[4, j], columns[5, j]


@scalar
def _fill_rim(
    pair: Record, start: int, end: int, columns: FloatArray, rim: int, alike: bool
) -> None:
    """The same for a rim."""
    if alike:
        for k in range(start, start + (end - start + VECTOR - 1) // VECTOR * VECTOR):
            pair.a[k], pair.b[k] = columns[rim, 0], columns[rim + 1, 0]
    else:
        for k in range(start, end):
            j = pair.lane[k]
            pair.a[k], pair.b[k] = columns[rim, j], columns[rim + 1, j]


@scalar
def _fill_edge(
    pair: Record, start: int, end: int, columns: FloatArray, edge: int, wall: int, alike: bool
) -> None:
    """The same for an edge and a wall."""
    if alike:
        for k in range(start, start + (end - start + VECTOR - 1) // VECTOR * VECTOR):
            pair.a[k], pair.b[k] = columns[edge, 0], columns[edge + 1, 0]
            pair.c[k], pair.d[k] = columns[edge + 2, 0], columns[wall, 0]
            pair.e[k], pair.f[k] = columns[wall + 1, 0], columns[wall + 2, 0]
            pair.g[k], pair.h[k] = columns[wall + 3, 0], columns[wall + 4, 0]
    else:
        for k in range(start, end):
            j = pair.lane[k]
            pair.a[k], pair.b[k] = columns[edge, j], columns[edge + 1, j]
            pair.c[k], pair.d[k] = columns[edge + 2, j], columns[wall, j]
            pair.e[k], pair.f[k] = columns[wall + 1, j], columns[wall + 2, j]
            pair.g[k], pair.h[k] = columns[wall + 3, j], columns[wall + 4, j]


@inlined
def _note(
    pair: Record, k: int, point: Vector, normal: Vector, penetration: float, search: bool
) -> None:
    pair.point_x[k], pair.point_y[k], pair.point_z[k] = point
    pair.normal_x[k], pair.normal_y[k], pair.normal_z[k] = normal
    pair.penetration[k] = penetration
    pair.search[k] = search


@inlined
def _put(pair: Record, k: int, wrench: Wrench, penetration: float) -> None:
    pair.force_x[k], pair.force_y[k], pair.force_z[k] = wrench[0], wrench[1], wrench[2]
    pair.torque_x[k], pair.torque_y[k], pair.torque_z[k] = wrench[3], wrench[4], wrench[5]
    pair.penetration[k] = penetration


@scalar
def _gather(lane: Record, pair: Record, held: int) -> None:
    """Copy the poses of the lanes to their pairs."""
    for k in range(held):
        j = pair.lane[k]
        pair.sin[k], pair.cos[k] = lane.sin[j], lane.cos[j]
        pair.x[k], pair.y[k], pair.z[k] = lane.x[j], lane.y[j], lane.z[j]
        pair.slide_x[k], pair.slide_y[k] = lane.slide_x[j], lane.slide_y[j]
        pair.slide_z[k], pair.friction[k] = lane.slide_z[j], lane.friction[j]


@scalar
def _load(pair: Record, held: int) -> None:
    """Loads of the contacts found: a loop of its own, as short chains of operations overlap."""
    for k in range((held + VECTOR - 1) // VECTOR * VECTOR):
        point = pair.point_x[k], pair.point_y[k], pair.point_z[k]
        normal = pair.normal_x[k], pair.normal_y[k], pair.normal_z[k]
        sliding = pair.slide_x[k], pair.slide_y[k], pair.slide_z[k]
        penetration = pair.penetration[k]
        load = contact_load(point, normal, penetration, sliding, pair.friction[k])
        _put(pair, k, load, penetration)


@scalar
def _solve_rims(lane: Record, pair: Record, held: int, columns: FloatArray, table: Table) -> None:
    # Two loops, as short chains of operations overlap.
    _gather(lane, pair, held)
    for k in range((held + VECTOR - 1) // VECTOR * VECTOR):
        pair.e1[k], pair.e2[k], pair.ratio[k] = rim_direction(
            pair.sin[k], pair.cos[k], pair.x[k], pair.y[k], pair.z[k], pair.a[k], pair.b[k]
        )
    for k in range((held + VECTOR - 1) // VECTOR * VECTOR):
        point, normal, penetration, search = rim_contact(
            (pair.e1[k], pair.e2[k], pair.ratio[k]),
            pair.sin[k], pair.cos[k], pair.x[k], pair.y[k], pair.z[k],
            pair.shaft[k], pair.length[k],
            pair.first[k], pair.per_first[k], pair.last[k], pair.per_last[k],
            pair.a[k], pair.b[k],
        )  # fmt: skip
        _note(pair, k, point, normal, penetration, search)
    _load(pair, held)
    for k in range(held):
        if pair.search[k]:
            j = pair.lane[k]
            circle = rim_circle(
                pair.sin[k], pair.cos[k], pair.x[k], pair.y[k], pair.z[k],
                pair.shaft[k], pair.length[k], columns[6, j], pair.a[k], pair.b[k],
            )  # fmt: skip
            faces = table.shaft_faces[lane.geometry[j]]
            sliding = pair.slide_x[k], pair.slide_y[k], pair.slide_z[k]
            wrench, penetration = searched_contact(circle, faces, sliding, pair.friction[k])
            _put(pair, k, wrench, penetration)


@scalar
def _solve_edges(lane: Record, pair: Record, held: int, table: Table) -> None:
    _gather(lane, pair, held)
    for k in range((held + VECTOR - 1) // VECTOR * VECTOR):
        point, normal, penetration, search = edge_contact(
            pair.sin[k], pair.cos[k], pair.x[k], pair.y[k], pair.z[k],
            pair.a[k], pair.b[k], pair.c[k], pair.lower[k] == _NONE,
            pair.d[k], pair.e[k], pair.f[k], pair.g[k], pair.h[k],
        )  # fmt: skip
        _note(pair, k, point, normal, penetration, search)
    _load(pair, held)
    for k in range(held):
        if pair.search[k]:
            j = pair.lane[k]
            circle = edge_circle(
                pair.sin[k], pair.cos[k], pair.x[k], pair.y[k], pair.z[k],
                pair.a[k], pair.b[k], pair.c[k], pair.lower[k] == _NONE, pair.d[k], pair.e[k],
            )  # fmt: skip
            faces = table.wall_faces[lane.geometry[j], pair.wall[k]]
            sliding = pair.slide_x[k], pair.slide_y[k], pair.slide_z[k]
            wrench, penetration = searched_contact(circle, faces, sliding, pair.friction[k])
            _put(pair, k, wrench, penetration)


@scalar
def _add(lane: Record, pair: Record, held: int) -> None:
    """Add contacts to their lanes, and note the stations that touch."""
    for k in range(held):
        j = pair.lane[k]
        lane.force_x[j] += pair.force_x[k]
        lane.force_y[j] += pair.force_y[k]
        lane.force_z[j] += pair.force_z[k]
        lane.torque_x[j] += pair.torque_x[k]
        lane.torque_y[j] += pair.torque_y[k]
        lane.torque_z[j] += pair.torque_z[k]
        before, now = lane.penetration[j], pair.penetration[k]
        lane.penetration[j] = now if now > before else before
        touches, lower = np.uint64(now > 0.0), pair.lower[k]
        lane.upper[j] |= (touches & (lower ^ _ONE)) << pair.wall[k]
        lane.lower[j] |= (touches & lower) << pair.wall[k]


@kernel
def solve_blocks(
    table: Table, given: Given, found: Found, first: int, last: int,
    lanes: Record, pairs: Record, columns: FloatArray,
) -> None:  # fmt: skip
    """Solve poses `first` to `last` - 1.

    `lanes` and `pairs`, of one element, and `columns`, one row per column of the table and one
    column per lane, are working memory.
    """
    lane, pair = lanes[0], pairs[0]
    rims, edges, walls = len(table.rim_walls), len(table.edge_trailing), len(table.mouths)
    first_edge = SHAFT_COLUMNS + RIM_COLUMNS * rims
    first_wall = first_edge + EDGE_COLUMNS * edges
    blocking = len(given.entered) > 0
    alike = len(given.geometry) == 1
    if alike:
        take_geometries(lane, columns, given, table, 0, 1, BLOCK)
        _fill_shaft(pair, 0, LIST, columns, alike)
    for start in range(first, last, BLOCK):
        count = min(BLOCK, last - start)
        used = (count + VECTOR - 1) // VECTOR * VECTOR
        take_poses(lane, given, start, count, used)
        if not alike:
            take_geometries(lane, columns, given, table, start, count, used)
        if blocking:
            find_ends(lane, columns, first_edge, used)
            for wall in range(walls):
                mouth = SHAFT_COLUMNS + RIM_COLUMNS * table.mouths[wall]
                stand_on_walls(lane, columns, mouth, wall, given.entered, start, count)
        held = 0
        for rim in range(rims):
            row, wall = SHAFT_COLUMNS + RIM_COLUMNS * rim, table.rim_walls[rim]
            _screen_rim(lane, columns, row, used)
            if blocking:
                _leave_out_blocked(lane, wall, used)
            end = _list(lane, pair, held, wall, table.rim_stations[rim], used)
            _fill_rim(pair, held, end, columns, row, alike)
            if not alike:
                _fill_shaft(pair, held, end, columns, alike)
            held = end
            if held > LIST - BLOCK or rim == rims - 1:
                _solve_rims(lane, pair, held, columns, table)
                _add(lane, pair, held)
                held = 0
        for edge in range(edges):
            row, lower = first_edge + EDGE_COLUMNS * edge, 1 - table.edge_trailing[edge]
            for wall in range(walls):
                wall_row = first_wall + WALL_COLUMNS * wall
                _screen_edge(lane, columns, row, wall_row, used)
                if blocking:
                    _leave_out_blocked(lane, wall, used)
                end = _list(lane, pair, held, wall, lower, used)
                _fill_edge(pair, held, end, columns, row, wall_row, alike)
                held = end
                if held > LIST - BLOCK or (wall == walls - 1 and edge == edges - 1):
                    _solve_edges(lane, pair, held, table)
                    _add(lane, pair, held)
                    held = 0
        give(lane, columns, first_wall, walls, found, start, count, used)
