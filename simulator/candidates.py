"""Which circles may touch what: the contact candidates of a part and a shaft.

Two kinds (paper section 3): a rim of the part against the shaft's surface (shaft-based), and an
edge circle of the shaft against a wall (hole-based).
"""

from dataclasses import dataclass
from enum import IntEnum
from functools import lru_cache

import numpy as np
import numpy.typing as npt

from simulator.geometry import Part, Shaft

IntArray = npt.NDArray[np.int64]


class Kind(IntEnum):
    """Which two features meet."""

    RIM = 0
    LEADING_EDGE = 1
    TRAILING_EDGE = 2


class Station(IntEnum):
    """Where along a wall a candidate acts.

    The rims at the mouth and the shaft's trailing edges form one station, its leading edges and the
    lower rim the other.
    """

    UPPER = 0
    LOWER = 1


@dataclass(frozen=True, slots=True)
class Candidates:
    """What each of the C = M + E*N candidates is; read-only integer arrays of shape (C,).

    M rims come first, in the order of `Part.rim_depths_m`, then each of the shaft's E edges, in the
    order of `Shaft.edge_stations_m`, against each of the N walls. Sharp edges everywhere make 4N:
    the rims A1..A2N, then B2 against each wall, then B1 against each wall.
    """

    kind: IntArray
    hole: IntArray
    station: IntArray
    circle: IntArray
    """Number of the rim among the part's, or of the edge among the shaft's."""


@lru_cache(maxsize=256)
def candidates(part: Part, shaft: Shaft) -> Candidates:
    """The candidates of `shaft` in `part`, in the order of the arrays in `Contacts`."""
    rims, walls, edges = len(part.rim_holes), len(part.holes), len(shaft.edge_stations_m)
    lower_rim = np.append(np.diff(part.rim_holes), 1)
    edge = np.repeat(np.arange(edges), walls)
    is_leading = edge < shaft.leading_edges
    rows = (
        np.concatenate([np.zeros(rims), np.where(is_leading, 1, 2)]),
        np.concatenate([part.rim_holes, np.tile(np.arange(walls), edges)]),
        np.concatenate([lower_rim, is_leading]),
        np.concatenate([np.arange(rims), edge]),
    )
    columns = [row.astype(np.int64) for row in rows]
    for column in columns:
        column.setflags(write=False)
    return Candidates(*columns)
