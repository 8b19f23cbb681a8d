"""Geometries as rows of numbers: what the kernels read of parts and shafts."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from simulator.checks import FloatArray, read_only
from simulator.geometry import Part, Shaft
from simulator.profile import Faces

IntArray = npt.NDArray[np.int64]

SHAFT_COLUMNS, RIM_COLUMNS, EDGE_COLUMNS, WALL_COLUMNS = 7, 2, 3, 5
MOST_WALLS = 64
MOST_RIMS = 3 * MOST_WALLS

Geometry = tuple[Part, Shaft]


class Table(NamedTuple):
    """G geometries with N walls, K rims, E shaft edges, F shaft faces; read-only.

    Where geometries differ in these numbers, the rows of the smaller ones hold NaN: a circle or
    wall of NaN touches nothing.
    """

    columns: FloatArray
    """(G, 7 + 2K + 3E + 5N) [m]. Shaft: radius, length, then the numbers a, b, c, d for which the
    cylinder is the least deep face at overlap f as long as a + b f <= s <= c - d f, rounding.
    Rims: z, radius. Edges: s, radius, tube. Walls: z of entry and exit, radius, and a, b for which
    the bore is the least deep face from z - z_entry = a + b f on."""
    shaft_faces: FloatArray
    """(G, F, 3): depth under face (c, p, q) is c + p rho + q s; unused rows (inf, 0, 0)."""
    wall_faces: FloatArray
    """(G, N, 2, 3): the same, in rho and z - z_entry."""
    rim_walls: IntArray
    """(K,): wall of each rim."""
    rim_stations: IntArray
    """(K,): `simulator.contact.Station` of each rim."""
    mouths: IntArray
    """(N,): rim at the mouth of each wall."""
    edge_trailing: IntArray
    """(E,): 1 for edges of the trailing end, else 0."""


def tabulate(geometries: Sequence[Geometry]) -> Table:
    """The table of `geometries`, one or more (part, shaft).

    Raises `ValueError` for an empty sequence, or a part with more than 64 holes.
    """
    if not geometries:
        raise ValueError("geometries is empty; it must hold at least one (part, shaft)")
    walls = max(len(part.holes) for part, _ in geometries)
    if walls > MOST_WALLS:
        raise ValueError(
            f"geometries hold a part with {walls} holes; at most {MOST_WALLS} are valid"
        )
    throats = [any(_has_throat(part, wall) for part, _ in geometries) for wall in range(walls)]
    leading = max(shaft.leading_edges for _, shaft in geometries)
    trailing = max(len(shaft.edge_radii_m) - shaft.leading_edges for _, shaft in geometries)
    faces = max(len(shaft.faces.offsets_m) for _, shaft in geometries)
    columns = [
        [
            *_shaft(shaft),
            *_rims(part, throats),
            *_edges(shaft, leading, trailing),
            *_walls(part, walls),
        ]
        for part, shaft in geometries
    ]
    rim_walls = np.repeat(np.arange(walls), [2 + throat for throat in throats])
    rim_stations = np.concatenate([[0] * (1 + throat) + [1] for throat in throats])
    return Table(
        read_only(np.array(columns)),
        read_only(np.array([_padded(shaft.faces, faces, -1.0) for _, shaft in geometries])),
        read_only(np.array([_wall_faces(part, walls) for part, _ in geometries])),
        rim_walls.astype(np.int64),
        rim_stations.astype(np.int64),
        np.searchsorted(rim_walls, np.arange(walls)).astype(np.int64),
        np.repeat([0, 1], [leading, trailing]).astype(np.int64),
    )


def _has_throat(part: Part, wall: int) -> bool:
    return wall < len(part.holes) and part.holes[wall].entry is not None


def _shaft(shaft: Shaft) -> list[float]:
    """Seven numbers; see `Table.columns`. The cylinder is that of the greatest diameter."""
    radius, first, last = shaft.radius_m, (-np.inf, 0.0), (np.inf, 0.0)
    for (radial, axial), offset in zip(shaft.faces.normals, shaft.faces.offsets_m, strict=True):
        reach = (radial * radius - offset) / abs(axial) if axial else -np.inf
        per_depth = (1.0 - radial) / abs(axial) if axial else 0.0
        if axial < 0.0:
            first = max(first[0], reach), max(first[1], per_depth)
        elif axial > 0.0:
            last = min(last[0], -reach), max(last[1], per_depth)
    if shaft.rounding_m:
        first = max(first[0], shaft.rounding_m), max(first[1], 1.0)
    return [radius, shaft.length_m, *first, *last, shaft.rounding_m]


def _rims(part: Part, throats: Sequence[bool]) -> list[float]:
    numbers: list[float] = []
    for wall, throat in enumerate(throats):
        of_wall = part.rim_holes == wall
        rims = np.stack([part.rim_depths_m, part.rim_radii_m], axis=-1)[of_wall].tolist()
        if len(rims) < 2 + throat:
            missing = 2 + throat - len(rims)
            rims[1:1] = [[np.nan] * RIM_COLUMNS] * missing
        numbers += [number for rim in rims for number in rim]
    return numbers


def _edges(shaft: Shaft, leading: int, trailing: int) -> list[float]:
    edges = np.full((leading + trailing, EDGE_COLUMNS), np.nan)
    rows = np.stack([shaft.edge_stations_m, shaft.edge_radii_m, shaft.edge_tubes_m], axis=-1)
    behind = len(rows) - shaft.leading_edges
    edges[: shaft.leading_edges] = rows[: shaft.leading_edges]
    edges[leading : leading + behind] = rows[shaft.leading_edges :]
    return [float(number) for number in edges.ravel()]


def _walls(part: Part, walls: int) -> list[float]:
    rows = np.full((walls, WALL_COLUMNS), np.nan)
    for wall, (entry, exit_, radius, faces) in enumerate(
        zip(part.wall_entries_m, part.wall_exits_m, part.wall_radii_m, part.wall_faces, strict=True)
    ):
        bore = -np.inf, 0.0
        if len(faces.offsets_m) > 1:
            radial, axial = faces.normals[0]
            bore = (faces.offsets_m[0] - radial * radius) / axial, (1.0 - radial) / axial
        rows[wall] = entry, exit_, radius, *bore
    return [float(number) for number in rows.ravel()]


def _padded(faces: Faces, count: int, sign: float) -> FloatArray:
    """Rows (c, p, q) of `faces`: depth = sign*(normal.x - offset)."""
    rows = np.zeros((count, 3))
    rows[:, 0] = np.inf
    given = len(faces.offsets_m)
    rows[:given, 0] = -sign * faces.offsets_m
    rows[:given, 1:] = sign * faces.normals
    return rows


def _wall_faces(part: Part, walls: int) -> list[FloatArray]:
    present = [_padded(faces, 2, 1.0) for faces in part.wall_faces]
    return present + [np.full((2, 3), np.nan)] * (walls - len(present))
