"""One pose through all candidates: what a thread of the GPU does."""

import math

import numpy as np

from simulator.compiled import inlined, scalar
from simulator.engine.circle import edge_circle, rim_circle
from simulator.engine.loads import Vector, Wrench, contact_load
from simulator.engine.plain import (
    edge_contact,
    edge_is_near,
    rim_contact,
    rim_direction,
    rim_is_near,
)
from simulator.engine.pose import heading, is_valid
from simulator.engine.search import searched_contact
from simulator.engine.states import INVALID, contact_state
from simulator.engine.table import EDGE_COLUMNS, RIM_COLUMNS, SHAFT_COLUMNS, WALL_COLUMNS, Table

_NONE, _ONE = np.uint64(0), np.uint64(1)


@inlined
def _sum(a: Wrench, b: Wrench) -> Wrench:
    return a[0] + b[0], a[1] + b[1], a[2] + b[2], a[3] + b[3], a[4] + b[4], a[5] + b[5]


@scalar
def _rim(
    table: Table, row: int, rim: int, frame: tuple[float, float, float, float, float],
    sliding: Vector, friction: float,
) -> tuple[Wrench, float]:  # fmt: skip
    """Wrench, per unit of stiffness, and penetration of a rim."""
    sin, cos, x, y, z = frame
    numbers, column = table.columns[row], SHAFT_COLUMNS + RIM_COLUMNS * rim
    shaft, length, plane, radius = numbers[0], numbers[1], numbers[column], numbers[column + 1]
    if not rim_is_near(sin, cos, x, y, z, shaft, length, plane, radius):
        return (0.0, 0.0, 0.0, 0.0, 0.0, 0.0), 0.0
    best = rim_direction(sin, cos, x, y, z, plane, radius)
    point, normal, penetration, search = rim_contact(
        best, sin, cos, x, y, z, shaft, length,
        numbers[2], numbers[3], numbers[4], numbers[5], plane, radius,
    )  # fmt: skip
    if search:
        circle = rim_circle(sin, cos, x, y, z, shaft, length, numbers[6], plane, radius)
        return searched_contact(circle, table.shaft_faces[row], sliding, friction)
    return contact_load(point, normal, penetration, sliding, friction), penetration


@scalar
def _edge(
    table: Table, row: int, edge: int, wall: int,
    frame: tuple[float, float, float, float, float], sliding: Vector, friction: float,
) -> tuple[Wrench, float]:  # fmt: skip
    """Wrench, per unit of stiffness, and penetration of a shaft edge in a wall."""
    sin, cos, x, y, z = frame
    numbers, trailing = table.columns[row], table.edge_trailing[edge]
    first = SHAFT_COLUMNS + RIM_COLUMNS * len(table.rim_walls)
    column = first + EDGE_COLUMNS * edge
    behind, radius, tube = numbers[column], numbers[column + 1], numbers[column + 2]
    column = first + EDGE_COLUMNS * len(table.edge_trailing) + WALL_COLUMNS * wall
    entry, exit_, bore = numbers[column], numbers[column + 1], numbers[column + 2]
    if not edge_is_near(sin, cos, x, y, z, behind, radius, tube, entry, exit_, bore):
        return (0.0, 0.0, 0.0, 0.0, 0.0, 0.0), 0.0
    point, normal, penetration, search = edge_contact(
        sin, cos, x, y, z, behind, radius, tube, trailing,
        entry, exit_, bore, numbers[column + 3], numbers[column + 4],
    )  # fmt: skip
    if search:
        circle = edge_circle(sin, cos, x, y, z, behind, radius, tube, trailing, entry, exit_)
        return searched_contact(circle, table.wall_faces[row, wall], sliding, friction)
    return contact_load(point, normal, penetration, sliding, friction), penetration


@scalar
def solve_one(
    table: Table, row: int, place: Vector, rx: float, ry: float,
    sliding: Vector, stiffness: float, friction: float,
) -> tuple[Wrench, float, int, int]:  # fmt: skip
    """Wrench, largest penetration, state and number of touching stations; see `solve.Batch`."""
    (x, y, z), (dx, dy, dz) = place, sliding
    if not is_valid(x, y, z, rx, ry, dx, dy, dz):
        nothing = math.nan
        return (nothing, nothing, nothing, nothing, nothing, nothing), nothing, INVALID, 0
    turn_x, turn_y, sin, cos = heading(rx, ry)
    frame = sin, cos, turn_x * x + turn_y * y, turn_x * y - turn_y * x, z
    slide = turn_x * dx + turn_y * dy, turn_x * dy - turn_y * dx, dz
    total, deepest, upper, lower = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0), 0.0, _NONE, _NONE
    for rim in range(len(table.rim_walls)):
        wrench, penetration = _rim(table, row, rim, frame, slide, friction)
        if penetration > 0.0:
            total, deepest = _sum(total, wrench), max(deepest, penetration)
            bit = _ONE << np.uint64(table.rim_walls[rim])
            if table.rim_stations[rim] == 1:
                lower |= bit
            else:
                upper |= bit
    walls = len(table.mouths)
    for edge in range(len(table.edge_trailing)):
        for wall in range(walls):
            wrench, penetration = _edge(table, row, edge, wall, frame, slide, friction)
            if penetration > 0.0:
                total, deepest = _sum(total, wrench), max(deepest, penetration)
                bit = _ONE << np.uint64(wall)
                if table.edge_trailing[edge] == 0:
                    lower |= bit
                else:
                    upper |= bit
    numbers = table.columns[row]
    first = len(numbers) - WALL_COLUMNS * walls
    second_entry = numbers[first + WALL_COLUMNS] if walls > 1 else math.nan
    state, points = contact_state(upper, lower, z, numbers[first + 1], second_entry)
    turn_x, turn_y = turn_x * stiffness, turn_y * stiffness
    fx, fy, fz, mx, my, mz = total
    wrench = (
        turn_x * fx - turn_y * fy,
        turn_x * fy + turn_y * fx,
        stiffness * fz,
        turn_x * mx - turn_y * my,
        turn_x * my + turn_y * mx,
        stiffness * mz,
    )
    return wrench, deepest, state, points
