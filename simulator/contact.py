"""Contact of a rigid shaft with elastic walls: penetration, force, torque and energy.

Forces are those of the shaft ON THE PART, in M. The penetration of a circle is the greatest
effective one on it, and acts at the point that is deepest below the other solid's faces, also while
that point itself has not entered the other solid. Three more points a quarter turn apart stand for
a circle that touches all around; see `simulator.ring`.
"""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from simulator.blocking import checked_entered, stand_on_faces, standing
from simulator.candidates import Candidates, candidates
from simulator.checks import FloatArray, finite_array, non_negative, positive, read_only
from simulator.deepest import deepest_points
from simulator.entering import effective_penetration, meet_faces
from simulator.extremum import Search, exact_search
from simulator.geometry import POSE_SIZE, Part, Shaft, checked_poses
from simulator.heading import Heading
from simulator.ring import ring_points
from simulator.wrench import friction_direction, resultant


@dataclass(frozen=True, slots=True)
class ContactLaw:
    """Linear contact stiffness [N/m] and Coulomb friction coefficient."""

    stiffness_N_m: float = 4e3
    friction: float = 0.2

    def __post_init__(self) -> None:
        positive("ContactLaw.stiffness_N_m", self.stiffness_N_m)
        non_negative("ContactLaw.friction", self.friction)


@dataclass(frozen=True, slots=True)
class Ring:
    """The three other points of circles that touch all around; zero where only one point touches.

    Read-only arrays, in M; on the axis after C are the points a quarter, a half and three quarters
    of a turn from the first one.
    """

    penetration: FloatArray
    """(..., C, 3) [m]: effective penetration of each point, at least 0."""
    point: FloatArray
    """(..., C, 3, 3) [m]."""
    normal: FloatArray
    """(..., C, 3, 3): unit direction in which the shaft pushes the part."""
    force: FloatArray
    """(..., C, 3, 3) [N]: force on the part."""


@dataclass(frozen=True, slots=True)
class Contacts:
    """Contacts of a batch of poses (...): read-only arrays, in M."""

    candidates: Candidates
    law: ContactLaw
    overlap: FloatArray
    """(..., C) [m]: depth of `point` below the endless faces of the other solid; < 0 is clearance.
    Of circles that clear the bore or the shaft's diameter, that clearance."""
    penetration: FloatArray
    """(..., C) [m]: greatest effective penetration, at least 0; this one makes the force."""
    point: FloatArray
    """(..., C, 3) [m]: point of the circle, or of its tube, deepest below the other solid's endless
    faces; there the force acts."""
    normal: FloatArray
    """(..., C, 3): unit direction in which the shaft pushes the part."""
    force: FloatArray
    """(..., C, 3) [N]: force on the part at `point`, without that of the ring."""
    wrench: FloatArray
    """(..., 6) [N, N*m]: resultant of all forces, and torque about the origin of M."""
    ring: Ring

    @property
    def energy(self) -> FloatArray:
        """Elastic energy (...) [J]: the sum of stiffness * penetration^2 / 2 over all points."""
        depths = np.concatenate([self.penetration[..., np.newaxis], self.ring.penetration], axis=-1)
        squares = depths.reshape(*depths.shape[:-2], -1)
        squares = squares * squares
        total = np.zeros(squares.shape[:-1])
        for index in range(squares.shape[-1]):  # in this order for any batch
            total += squares[..., index]
        return 0.5 * self.law.stiffness_N_m * total


def solve(
    part: Part,
    shaft: Shaft,
    poses: npt.ArrayLike,
    sliding: npt.ArrayLike,
    law: ContactLaw = ContactLaw(),
    search: Search = exact_search,
    entered: npt.ArrayLike | None = None,
) -> Contacts:
    """Contacts of `shaft` with `part` for `poses`, shape (..., 5).

    `sliding`, shape (3,) or (..., 3), is the direction of the shaft's motion relative to the part,
    of any length; a zero vector means no friction. Each force is k*penetration*(n + mu*t), t the
    unit vector of the sliding direction's component tangential to the contact: friction drags the
    part along with the shaft. (Where two faces of a surface share a contact at the edge between
    them, n is their mean and shorter than 1.) `search` finds the best points of circles:
    `exact_search`, or the paper's `discretised_search(n)`.

    With `entered`, shape (..., N), an end that reaches out over the mouth of a wall not entered
    stands on its face: that contact, in the row of the first edge, then is the wall's only one
    (`update_entered` keeps the state). Without, no wall blocks the way.

    Raises `ValueError` for a pose or sliding direction that is not finite or has the wrong shape,
    for a tilt of a quarter turn or more, and for an `entered` of another type or shape.
    """
    poses = checked_poses(poses)
    batch = poses.shape[:-1]
    direction = _sliding_columns(sliding, batch)
    columns = np.ascontiguousarray(poses.reshape(-1, POSE_SIZE).T)
    heading = Heading.of(columns)
    table = candidates(part, shaft)
    found = deepest_points(part, shaft, heading, search)
    if not (part.is_plain and shaft.is_plain):
        meet_faces(part, shaft, heading, table, found, search)
    penetration = effective_penetration(part, shaft, heading, table, found, search)
    if entered is not None:
        has_entered = checked_entered(part, poses, entered).reshape(-1, len(part.holes)).T
        standing_m = standing(part, shaft, heading, has_entered)
        penetration[(standing_m > 0.0)[table.hole]] = 0.0
    others = ring_points(part, shaft, heading, table, found, penetration)
    if entered is not None:
        stand_on_faces(part, shaft, heading, standing_m, found)
        first_edge = penetration[len(part.rim_holes) :][: len(part.holes)]
        np.maximum(first_edge, standing_m, out=first_edge)

    force = _forces(found.normal, penetration * found.share, direction, law)
    wrench = resultant(found.point, force)
    lead = (*batch, len(penetration))
    if others is None:
        ring = _no_ring(lead)
    else:
        depth, point, normal = others
        push = _forces(normal, depth, direction[:, np.newaxis], law)
        wrench += resultant(_in_rows(point), _in_rows(push))
        ring = Ring(
            read_only(depth.transpose(2, 1, 0).reshape(*lead, 3)),
            *(
                read_only(a.transpose(3, 2, 1, 0).reshape(*lead, 3, 3))
                for a in (point, normal, push)
            ),
        )
    return Contacts(
        candidates=table,
        law=law,
        overlap=read_only(found.overlap.T.reshape(lead)),
        penetration=read_only(penetration.T.reshape(lead)),
        point=read_only(found.point.T.reshape(*lead, 3)),
        normal=read_only(found.normal.T.reshape(*lead, 3)),
        force=read_only(force.T.reshape(*lead, 3)),
        wrench=read_only(wrench.T.reshape(*batch, 6)),
        ring=ring,
    )


def _forces(
    normal: FloatArray, penetration: FloatArray, direction: FloatArray, law: ContactLaw
) -> FloatArray:
    """Forces (3, ...) of contacts with these unit normals (3, ...) and penetrations (...)."""
    force = normal
    if law.friction > 0.0:
        force = friction_direction(normal, direction)
        force *= law.friction
        force += normal
    return np.asarray((law.stiffness_N_m * penetration) * force)


def _in_rows(vectors: FloatArray) -> FloatArray:
    """Vectors (3, 3, C, P) of a ring's points as (3, 3C, P)."""
    return vectors.reshape(3, -1, vectors.shape[-1])


def _no_ring(lead: tuple[int, ...]) -> Ring:
    scalars, vectors = read_only(np.zeros((*lead, 3))), read_only(np.zeros((*lead, 3, 3)))
    return Ring(scalars, vectors, vectors, vectors)


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
