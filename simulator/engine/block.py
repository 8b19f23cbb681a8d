"""The kernel of the CPU: blocks of poses, one contact candidate after the other.

A block's lanes are poses in their heading frames. For every circle the lanes near it are packed, so
that only they are solved, in vectors; of these, a few are searched one by one. Each lane adds its
contacts in the same order and in the same arithmetic wherever it stands and whatever its neighbours
are: results do not depend on the batch.
"""

import numpy as np

from simulator.checks import FloatArray
from simulator.compiled import Record, inlined, kernel, scalar
from simulator.engine.batch import Found, Given
from simulator.engine.blocking import find_ends, stand_on_walls
from simulator.engine.circle import edge_circle, rim_circle
from simulator.engine.exchange import give, take_geometries, take_poses
from simulator.engine.lanes import BLOCK, VECTOR
from simulator.engine.loads import Vector, Wrench, contact_load
from simulator.engine.plain import edge_contact, edge_is_near, rim_contact, rim_is_near
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
def _pack(lane: Record, pair: Record, used: int) -> tuple[int, int]:
    """Pack the lanes that are near: how many there are, and how many with the filling."""
    count = 0
    for j in range(used):
        pair.lane[count] = j
        count += lane.near[j]
    filled = (count + VECTOR - 1) // VECTOR * VECTOR
    for j in range(count, filled):
        pair.lane[j] = pair.lane[0]
    for j in range(filled):
        i = pair.lane[j]
        pair.sin[j], pair.cos[j] = lane.sin[i], lane.cos[i]
        pair.x[j], pair.y[j], pair.z[j] = lane.x[i], lane.y[i], lane.z[i]
        pair.slide_x[j], pair.slide_y[j] = lane.slide_x[i], lane.slide_y[i]
        pair.slide_z[j] = lane.slide_z[i]
        pair.friction[j] = lane.friction[i]
    return count, filled


@inlined
def _put(pair: Record, j: int, wrench: Wrench, penetration: float) -> None:
    pair.force_x[j], pair.force_y[j], pair.force_z[j] = wrench[0], wrench[1], wrench[2]
    pair.torque_x[j], pair.torque_y[j], pair.torque_z[j] = wrench[3], wrench[4], wrench[5]
    pair.penetration[j] = penetration


@inlined
def _load(pair: Record, j: int, point: Vector, normal: Vector, penetration: float) -> None:
    sliding = pair.slide_x[j], pair.slide_y[j], pair.slide_z[j]
    _put(pair, j, contact_load(point, normal, penetration, sliding, pair.friction[j]), penetration)


@scalar
def _solve_rim(
    lane: Record,
    pair: Record,
    near: int,
    filled: int,
    columns: FloatArray,
    rim: int,
    table: Table,
    alike: bool,
) -> None:
    if alike:
        for j in range(filled):
            pair.a[j] = columns[0, 0]
            pair.b[j] = columns[1, 0]
            pair.c[j] = columns[2, 0]
            pair.d[j] = columns[3, 0]
            pair.e[j] = columns[4, 0]
            pair.f[j] = columns[5, 0]
            pair.g[j] = columns[rim, 0]
            pair.h[j] = columns[rim + 1, 0]
    else:
        for j in range(filled):
            i = pair.lane[j]
            pair.a[j] = columns[0, i]
            pair.b[j] = columns[1, i]
            pair.c[j] = columns[2, i]
            pair.d[j] = columns[3, i]
            pair.e[j] = columns[4, i]
            pair.f[j] = columns[5, i]
            pair.g[j] = columns[rim, i]
            pair.h[j] = columns[rim + 1, i]
    for j in range(filled):
        point, normal, penetration, search = rim_contact(
            pair.sin[j], pair.cos[j], pair.x[j], pair.y[j], pair.z[j],
            pair.a[j], pair.b[j], pair.c[j], pair.d[j], pair.e[j], pair.f[j],
            pair.g[j], pair.h[j],
        )  # fmt: skip
        _load(pair, j, point, normal, penetration)
        pair.search[j] = search
    for j in range(near):
        if pair.search[j]:
            i = pair.lane[j]
            circle = rim_circle(
                pair.sin[j], pair.cos[j], pair.x[j], pair.y[j], pair.z[j],
                pair.a[j], pair.b[j], columns[6, i], pair.g[j], pair.h[j],
            )  # fmt: skip
            faces = table.shaft_faces[lane.geometry[i]]
            wrench, penetration = searched_contact(
                circle, faces, (pair.slide_x[j], pair.slide_y[j], pair.slide_z[j]), pair.friction[j]
            )
            _put(pair, j, wrench, penetration)


@scalar
def _solve_edge(
    lane: Record,
    pair: Record,
    near: int,
    filled: int,
    columns: FloatArray,
    edge: int,
    wall: int,
    number: int,
    trailing: int,
    table: Table,
    alike: bool,
) -> None:
    if alike:
        for j in range(filled):
            pair.a[j] = columns[edge, 0]
            pair.b[j] = columns[edge + 1, 0]
            pair.c[j] = columns[edge + 2, 0]
            pair.d[j] = columns[wall, 0]
            pair.e[j] = columns[wall + 1, 0]
            pair.f[j] = columns[wall + 2, 0]
            pair.g[j] = columns[wall + 3, 0]
            pair.h[j] = columns[wall + 4, 0]
    else:
        for j in range(filled):
            i = pair.lane[j]
            pair.a[j] = columns[edge, i]
            pair.b[j] = columns[edge + 1, i]
            pair.c[j] = columns[edge + 2, i]
            pair.d[j] = columns[wall, i]
            pair.e[j] = columns[wall + 1, i]
            pair.f[j] = columns[wall + 2, i]
            pair.g[j] = columns[wall + 3, i]
            pair.h[j] = columns[wall + 4, i]
    for j in range(filled):
        point, normal, penetration, search = edge_contact(
            pair.sin[j], pair.cos[j], pair.x[j], pair.y[j], pair.z[j],
            pair.a[j], pair.b[j], pair.c[j], trailing,
            pair.d[j], pair.e[j], pair.f[j], pair.g[j], pair.h[j],
        )  # fmt: skip
        _load(pair, j, point, normal, penetration)
        pair.search[j] = search
    for j in range(near):
        if pair.search[j]:
            circle = edge_circle(
                pair.sin[j], pair.cos[j], pair.x[j], pair.y[j], pair.z[j],
                pair.a[j], pair.b[j], pair.c[j], trailing, pair.d[j], pair.e[j],
            )  # fmt: skip
            faces = table.wall_faces[lane.geometry[pair.lane[j]], number]
            wrench, penetration = searched_contact(
                circle, faces, (pair.slide_x[j], pair.slide_y[j], pair.slide_z[j]), pair.friction[j]
            )
            _put(pair, j, wrench, penetration)


@scalar
def _add(lane: Record, pair: Record, near: int, wall: int, is_lower: bool) -> None:
    """Add contacts to their lanes, and note the stations of wall number `wall` that touch."""
    bit = _ONE << np.uint64(wall)
    upper, lower = _NONE if is_lower else bit, bit if is_lower else _NONE
    for j in range(near):
        i = pair.lane[j]
        lane.force_x[i] += pair.force_x[j]
        lane.force_y[i] += pair.force_y[j]
        lane.force_z[i] += pair.force_z[j]
        lane.torque_x[i] += pair.torque_x[j]
        lane.torque_y[i] += pair.torque_y[j]
        lane.torque_z[i] += pair.torque_z[j]
        before, now = lane.penetration[i], pair.penetration[j]
        lane.penetration[i] = now if now > before else before
        lane.upper[i] |= upper if now > 0.0 else _NONE
        lane.lower[i] |= lower if now > 0.0 else _NONE


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
        for rim in range(rims):
            row, wall = SHAFT_COLUMNS + RIM_COLUMNS * rim, table.rim_walls[rim]
            _screen_rim(lane, columns, row, used)
            if blocking:
                _leave_out_blocked(lane, wall, used)
            near, filled = _pack(lane, pair, used)
            if near:
                _solve_rim(lane, pair, near, filled, columns, row, table, alike)
                _add(lane, pair, near, wall, table.rim_stations[rim] == 1)
        for edge in range(edges):
            row, trailing = first_edge + EDGE_COLUMNS * edge, table.edge_trailing[edge]
            for wall in range(walls):
                wall_row = first_wall + WALL_COLUMNS * wall
                _screen_edge(lane, columns, row, wall_row, used)
                if blocking:
                    _leave_out_blocked(lane, wall, used)
                near, filled = _pack(lane, pair, used)
                if near:
                    _solve_edge(
                        lane,
                        pair,
                        near,
                        filled,
                        columns,
                        row,
                        wall_row,
                        wall,
                        trailing,
                        table,
                        alike,
                    )
                    _add(lane, pair, near, wall, trailing == 0)
        give(lane, columns, first_wall, walls, found, start, count, used)
