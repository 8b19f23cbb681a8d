"""Insertion phases and the paper's contact states a to i (section 3.1), for parts with N holes.

The phase follows from depth alone. A contact point is a *station* of a wall: the rims at its mouth
and the shaft's trailing edges form one station, the leading edges and the lower rim the other. So a
contact that is handed over from the leading edge to the lower rim stays one point.
"""

from enum import IntEnum

import numpy as np
import numpy.typing as npt

from simulator.candidates import Station
from simulator.contact import Contacts
from simulator.geometry import Part

IntArray = npt.NDArray[np.int64]


class Phase(IntEnum):
    """Phase codes of a part with two holes.

    Hole number i (from 0) has the codes 2i while it is being approached and 2i + 1 while it is
    being inserted into, so parts with more holes use further codes: see `hole_of` and
    `is_inserting`.
    """

    APPROACHING_UPPER = 0
    UPPER_INSERTING = 1
    LOWER_APPROACHING = 2
    LOWER_INSERTING = 3


class ContactState(IntEnum):
    """The paper's nine states by phase and number of contact points, and FREE without contact."""

    FREE = 0
    A = 1
    """Upper hole: the upper station alone (shaft-based)."""
    B = 2
    """Upper hole: the lower station alone (hole-based)."""
    C = 3
    """Upper hole: both stations."""
    D = 4
    """Approaching the lower hole: one station of the upper hole."""
    E = 5
    """Approaching the lower hole: both stations of the upper hole."""
    F = 6
    """Lower hole: one point."""
    G = 7
    """Lower hole: two points at the same hole."""
    H = 8
    """Lower hole: two points at different holes."""
    I = 9  # noqa: E741, the name of the state in the paper
    """Lower hole: three points or more."""


_STATES = np.array(
    [
        # no point, one lower, one upper, two at one hole, two at different holes, three or more
        [ContactState[name] for name in ("FREE", "B", "A", "C", "C", "C")],
        [ContactState[name] for name in ("FREE", "D", "D", "E", "E", "E")],
        [ContactState[name] for name in ("FREE", "F", "F", "G", "H", "I")],
    ],
    dtype=np.int64,
)
"""Rows: at the first hole, approaching the second one, from inserting into the second one on."""
_FIRST_COLUMN = np.array([0, 1, 3, 5])
"""Column of 0, 1, 2 and at least 3 points; one is added for an upper point, or different holes."""


def phase_codes(part: Part, depths_m: npt.ArrayLike) -> IntArray:
    """Phase code of each depth p_z [m] of the leading end, same shape; see `Phase`.

    A rim counts as passed once the depth is beyond it. Below the last rim the phase stays that of
    inserting into the last hole. Raises `ValueError` for a depth that is not finite.
    """
    depths = np.asarray(depths_m, dtype=np.float64)
    if not np.isfinite(depths).all():
        raise ValueError("depths_m holds an entry that is not finite; every depth must be finite")
    planes = np.stack([part.wall_entries_m, part.wall_exits_m], axis=-1).ravel()
    passed = np.searchsorted(planes, depths, side="left")
    return np.minimum(passed, len(planes) - 1).astype(np.int64)


def hole_of(phase_code: int) -> int:
    """Index of the hole that a phase approaches or inserts into."""
    return phase_code // 2


def is_inserting(phase_code: int) -> bool:
    """Whether a phase inserts into its hole (else it approaches it)."""
    return phase_code % 2 == 1


def contact_states(contacts: Contacts, phases: npt.ArrayLike) -> IntArray:
    """`ContactState` codes, shape (...), of contacts (...) in the phases (...) from `phase_codes`.

    States a to e apply while only the first hole touches the shaft and the second is not yet
    being inserted into; anything further is counted as f to i. A contact while the first hole is
    still being approached (a tilted leading edge) is named like one inside it.
    """
    stations = touching_stations(contacts)
    code = np.asarray(phases, dtype=np.int64)
    if code.shape != stations.shape[:-2]:
        raise ValueError(f"phases has shape {code.shape}; it must be {stations.shape[:-2]}")
    if (code < 0).any():
        raise ValueError("phases holds a negative code; every code must be at least 0")
    points = stations.sum(axis=(-2, -1))
    upper = stations[..., Station.UPPER].any(axis=-1)
    apart = ~np.logical_and.reduce(stations, axis=-1).any(axis=-1)
    column = _FIRST_COLUMN[np.minimum(points, 3)]
    column = column + ((points == 1) & upper) + ((points == 2) & apart)
    later_holes = stations[..., 1:, :].any(axis=(-2, -1))
    row = np.where((code >= Phase.LOWER_INSERTING) | later_holes, 2, code // 2)
    return np.asarray(_STATES[row, column])


def contact_state(contacts: Contacts, phase_code: int) -> ContactState:
    """The state of a single pose: `contacts` of one pose of shape (5,), and its phase code."""
    return ContactState(int(contact_states(contacts, phase_code)))


def touching_stations(contacts: Contacts) -> npt.NDArray[np.bool_]:
    """Which stations touch: shape (..., N, 2), last axis indexed by `Station`."""
    touching, table = contacts.penetration > 0.0, contacts.candidates
    holes = int(table.hole[-1]) + 1
    stations = len(Station) * table.hole + table.station
    belongs = stations[:, np.newaxis] == np.arange(len(Station) * holes)
    found: npt.NDArray[np.bool_] = touching @ belongs
    return found.reshape(*touching.shape[:-1], holes, len(Station))
