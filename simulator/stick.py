"""Sticking and sliding friction at the contacts: regularised Coulomb friction with a memory.

Each contact carries a tangential spring. The shaft's motion relative to the part at the contact
stretches it; its force is capped at mu times the normal force, and what the cap cuts off has slid
and is dissipated (a return mapping; P. A. Cundall and O. D. L. Strack, Geotechnique 29, 1979, use
it for grains). A load below the cone is held, with a displacement of load over tangential
stiffness. Sliding on in one direction gives the friction of `simulator.contact.solve`. A contact
that opens has a normal force and so a cap of 0, and forgets.

No step creates energy: the spring is turned into the present tangential plane by leaving out its
normal part and shortened by the cap, and both only shorten it. The whole of a step counts as made
in contact, also where the contact closed within it.
"""

from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from simulator.checks import FloatArray, positive, read_only
from simulator.contact import ContactLaw, solve
from simulator.geometry import POSE_SIZE, Part, Shaft, checked_poses
from simulator.turning import turned, turned_back
from simulator.wrench import resultant

_STILL = read_only(np.zeros(3))
_TINY = 1e-150


@dataclass(frozen=True, slots=True)
class StickLaw:
    """A contact law and the tangential stiffness [N/m] of a contact that sticks.

    Equal bodies of steel have 2 (1 - nu) / (2 - nu) = 0.82 of the normal stiffness (R. D. Mindlin,
    Journal of Applied Mechanics 16, 1949); the default is that of the nominal law.
    """

    contact: ContactLaw = field(default_factory=ContactLaw)
    tangential_stiffness_N_m: float = 3.3e3

    def __post_init__(self) -> None:
        positive("StickLaw.tangential_stiffness_N_m", self.tangential_stiffness_N_m)


@dataclass(frozen=True, slots=True, eq=False)
class StickState:
    """What the contacts of a batch (...) remember: read-only arrays."""

    poses: FloatArray
    """(..., 5): poses of the shaft in M at the last step."""
    stretch: FloatArray
    """(..., 4C, 3) [m]: stretch of the tangential spring of each contact, in M."""


@dataclass(frozen=True, slots=True, eq=False)
class StickContacts:
    """Contacts with friction after a step, batch (...): read-only arrays, in M.

    Four to each of C circles: the deepest points of all circles, then the three others of each
    (see `simulator.contact.Ring`).
    """

    normal_force: FloatArray
    """(..., 4C) [N]"""
    friction: FloatArray
    """(..., 4C, 3) [N]: friction on the part."""
    slid: FloatArray
    """(..., 4C) [m]: distance slid in this step; 0 where the contact sticks."""
    wrench: FloatArray
    """(..., 6) [N, N m]: resultant on the part, and torque about the origin of M."""
    state: StickState


def relaxed(part: Part, shaft: Shaft, poses: npt.ArrayLike) -> StickState:
    """The state of contacts without friction, shaft at `poses` (..., 5)."""
    checked = checked_poses(poses)
    contacts = solve(part, shaft, checked, _STILL, ContactLaw(friction=0.0))
    at_rest = np.zeros(_all_points(contacts.point, contacts.ring.point).shape)
    return StickState(read_only(checked.copy()), read_only(at_rest))


def advance(
    part: Part, shaft: Shaft, poses: npt.ArrayLike, state: StickState, law: StickLaw = StickLaw()
) -> StickContacts:
    """Contacts after the shaft has moved to `poses`, shape (..., 5), in one straight step.

    The state may have fewer leading axes than the poses, which are then trials from one state.
    Raises `ValueError` for invalid poses and a state of another batch.
    """
    checked = checked_poses(poses)
    batch = state.poses.shape[:-1]
    if checked.shape[len(checked.shape) - len(batch) - 1 :] != (*batch, POSE_SIZE):
        raise ValueError(f"poses has shape {checked.shape}; the state is one of (..., {batch}, 5)")
    smooth = ContactLaw(stiffness_N_m=law.contact.stiffness_N_m, friction=0.0)
    contacts = solve(part, shaft, checked, _STILL, smooth)
    ring = contacts.ring
    point = _all_points(contacts.point, ring.point)
    normal = _all_points(contacts.normal, ring.normal)
    push = _all_points(contacts.force, ring.force)
    normal_force = _dot(push, normal)

    trial = state.stretch + _motion(point, checked, state.poses)
    trial = trial - _dot(trial, normal)[..., np.newaxis] * normal
    length = np.sqrt(_dot(trial, trial))
    longest = law.contact.friction * normal_force / law.tangential_stiffness_N_m
    kept = np.minimum(length, longest)
    stretch = trial * (kept / np.maximum(length, _TINY))[..., np.newaxis]
    friction = law.tangential_stiffness_N_m * stretch

    rows = [
        np.ascontiguousarray(
            np.moveaxis(array.reshape(-1, *array.shape[-2:]), 0, -1).swapaxes(0, 1)
        )
        for array in (point, push + friction)
    ]
    return StickContacts(
        normal_force=read_only(normal_force),
        friction=read_only(friction),
        slid=read_only(np.where(normal_force > 0.0, length - kept, 0.0)),
        wrench=read_only(resultant(*rows).T.reshape(*checked.shape[:-1], 6)),
        state=StickState(read_only(checked.copy()), read_only(stretch)),
    )


def _all_points(deepest: FloatArray, ring: FloatArray) -> FloatArray:
    """Vectors of the deepest points (..., C, 3) and of the others (..., C, 3, 3): (..., 4C, 3)."""
    others = ring.reshape(*deepest.shape[:-2], -1, 3)
    return np.concatenate([deepest, others], axis=-2)


def _motion(point: FloatArray, poses: FloatArray, before: FloatArray) -> FloatArray:
    """How far the shaft's material at `point` (..., C, 3) has come from `before` to `poses`."""
    now, then = poses[..., np.newaxis, :], before[..., np.newaxis, :]
    on_shaft = turned_back(point - now[..., :3], now[..., 3:])
    return point - (then[..., :3] + turned(on_shaft, then[..., 3:]))


def _dot(a: FloatArray, b: FloatArray) -> FloatArray:
    product: FloatArray = a[..., 0] * b[..., 0] + a[..., 1] * b[..., 1] + a[..., 2] * b[..., 2]
    return product
