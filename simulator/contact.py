"""Contact of a rigid shaft with elastic walls: penetration, force and torque.

Two kinds of candidate (paper section 3): a rim of the part against the shaft's surface
(shaft-based), and an edge circle of the shaft against a wall (hole-based). For N holes there are
4N: the rims A1..A2N, then the leading edge B2 against each wall, then the trailing edge B1 against
each wall. Forces are those of the shaft ON THE PART, in M.

The penetration of a circle is the greatest effective one on it, and acts at the circle's radially
deepest point, also while that point itself has not entered the other solid. A ring of contact (a
coaxial shaft thicker than its hole) is therefore not modelled: where the deepest point is undefined
the force is zero, which is the resultant by symmetry.
"""

from dataclasses import dataclass
from enum import IntEnum
from functools import lru_cache

import numpy as np
import numpy.typing as npt

from simulator.checks import FloatArray, finite_array, non_negative, positive, read_only
from simulator.deepest import Heading, deepest_points
from simulator.entering import effective_penetration
from simulator.extremum import Search, exact_search
from simulator.geometry import POSE_SIZE, Part, Shaft, checked_poses
from simulator.wrench import friction_direction, resultant

IntArray = npt.NDArray[np.int64]


class Kind(IntEnum):
    """Which two features meet."""

    RIM = 0
    LEADING_EDGE = 1
    TRAILING_EDGE = 2


class Station(IntEnum):
    """Where along a wall a candidate acts.

    The upper rim and B1 form one station, B2 and the lower rim the other.
    """

    UPPER = 0
    LOWER = 1


@dataclass(frozen=True, slots=True)
class Candidates:
    """What each of the C = 4N candidates is; read-only integer arrays of shape (C,)."""

    kind: IntArray
    hole: IntArray
    station: IntArray


@lru_cache(maxsize=32)
def candidates(holes: int) -> Candidates:
    """The candidates of a part with `holes` holes, in the order of the arrays in `Contacts`."""
    wall = np.arange(holes)
    kind = np.repeat([Kind.RIM, Kind.LEADING_EDGE, Kind.TRAILING_EDGE], [2 * holes, holes, holes])
    station = np.concatenate([np.tile([0, 1], holes), np.ones(holes), np.zeros(holes)])
    table = [kind, np.concatenate([np.repeat(wall, 2), wall, wall]), station]
    rows = [column.astype(np.int64) for column in table]
    for row in rows:
        row.setflags(write=False)
    return Candidates(*rows)


@dataclass(frozen=True, slots=True)
class ContactLaw:
    """Linear contact stiffness [N/m] and Coulomb friction coefficient."""

    stiffness_N_m: float = 4e3
    friction: float = 0.2

    def __post_init__(self) -> None:
        positive("ContactLaw.stiffness_N_m", self.stiffness_N_m)
        non_negative("ContactLaw.friction", self.friction)


@dataclass(frozen=True, slots=True)
class Contacts:
    """Contacts of a batch of poses (...): read-only arrays, in M."""

    candidates: Candidates
    overlap: FloatArray
    """(..., C) [m]: radial overlap at the deepest point of endless surfaces; < 0 is clearance."""
    penetration: FloatArray
    """(..., C) [m]: greatest effective penetration, at least 0; this one makes the force."""
    point: FloatArray
    """(..., C, 3) [m]: deepest point of endless surfaces; there the force acts."""
    normal: FloatArray
    """(..., C, 3): unit direction in which the shaft pushes the part, or zero if undefined."""
    force: FloatArray
    """(..., C, 3) [N]: force on the part."""
    wrench: FloatArray
    """(..., 6) [N, N*m]: resultant force, and torque about the origin of M."""


def solve(
    part: Part,
    shaft: Shaft,
    poses: npt.ArrayLike,
    sliding: npt.ArrayLike,
    law: ContactLaw = ContactLaw(),
    search: Search = exact_search,
) -> Contacts:
    """Contacts of `shaft` with `part` for `poses`, shape (..., 5).

    `sliding`, shape (3,) or (..., 3), is the direction of the shaft's motion relative to the part,
    of any length; a zero vector means no friction. Each force is k*penetration*(n + mu*t), t the
    unit vector of the sliding direction's component tangential to the contact: friction drags the
    part along with the shaft. `search` finds the best points of circles: `exact_search`, or the
    paper's `discretised_search(n)`. Raises `ValueError` for a pose or sliding direction that is not
    finite or has the wrong shape, and for a tilt of a quarter turn or more.
    """
    poses = checked_poses(poses)
    batch = poses.shape[:-1]
    direction = _sliding_columns(sliding, batch)
    columns = np.ascontiguousarray(poses.reshape(-1, POSE_SIZE).T)
    heading = Heading.of(columns)
    found = deepest_points(part, shaft, heading, search)
    penetration = effective_penetration(part, shaft, heading, found, search)

    force = found.normal
    if law.friction > 0.0:
        force = friction_direction(found.normal, direction)
        force *= law.friction
        force += found.normal
    force = (law.stiffness_N_m * penetration) * force
    if found.undefined is not None:
        force[:, found.undefined] = 0.0

    lead = (*batch, len(penetration))
    return Contacts(
        candidates=candidates(len(part.holes)),
        overlap=read_only(found.overlap.T.reshape(lead)),
        penetration=read_only(penetration.T.reshape(lead)),
        point=read_only(found.point.T.reshape(*lead, 3)),
        normal=read_only(found.normal.T.reshape(*lead, 3)),
        force=read_only(force.T.reshape(*lead, 3)),
        wrench=read_only(resultant(found.point, force).T.reshape(*batch, 6)),
    )


def _sliding_columns(sliding: npt.ArrayLike, batch: tuple[int, ...]) -> FloatArray:
    """`sliding` as (3, 1, 1) if one direction serves all poses, else (3, 1, P)."""
    direction = finite_array("sliding", sliding, 3)
    if direction.ndim == 1:
        return direction.reshape(3, 1, 1)
    if direction.shape != (*batch, 3):
        raise ValueError(
            f"sliding has shape {direction.shape}; it must be (3,) or, as the poses, {(*batch, 3)}"
        )
    return np.ascontiguousarray(direction.reshape(-1, 3).T)[:, np.newaxis]
