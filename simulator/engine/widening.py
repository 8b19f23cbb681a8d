"""One part with all its bores wider or narrower, as rows of a table."""

import numpy as np

from simulator.checks import FloatArray, read_only
from simulator.engine.table import EDGE_COLUMNS, RIM_COLUMNS, SHAFT_COLUMNS, WALL_COLUMNS, Table


def widened(table: Table, widening_m: FloatArray) -> Table:
    """The geometry of a `table` of one row, n times: its bores wider in diameter by `widening_m`.

    `widening_m` has the shape (n,); chamfers keep their size and widen with their bores. Raises
    `ValueError` for a table of several rows or a bore that is no longer there.
    """
    if len(table.columns) != 1:
        raise ValueError(f"table has {len(table.columns)} rows; it must have 1")
    rims, edges, walls = len(table.rim_walls), len(table.edge_trailing), len(table.mouths)
    first_wall = SHAFT_COLUMNS + RIM_COLUMNS * rims + EDGE_COLUMNS * edges
    radii = [SHAFT_COLUMNS + RIM_COLUMNS * rim + 1 for rim in range(rims)]
    radii += [first_wall + WALL_COLUMNS * wall + 2 for wall in range(walls)]
    n, growth = len(widening_m), 0.5 * widening_m
    columns = np.repeat(table.columns, n, axis=0)
    columns[:, radii] += growth[:, np.newaxis]
    if not ((columns[:, radii] > 0.0) & (columns[:, radii] < np.inf)).all():
        ends = float(np.min(widening_m)), float(np.max(widening_m))
        raise ValueError(f"widening_m is from {ends[0]} to {ends[1]}; it must leave a bore")
    wall_faces = np.repeat(table.wall_faces, n, axis=0)
    wall_faces[..., 0] -= growth[:, np.newaxis, np.newaxis] * wall_faces[..., 1]
    return table._replace(
        columns=read_only(columns),
        shaft_faces=read_only(np.repeat(table.shaft_faces, n, axis=0)),
        wall_faces=read_only(wall_faces),
    )
