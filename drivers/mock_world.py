"""The one world that all mocks of a cell share: where things are, and what force follows.

Not modelled: the part gives way nowhere but at the rims (rigid holder), a round shaft does not care
about its rotation about z, and the arm's place matters only for whether a part lies there. What the
arm does besides standing still is its sway.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from drivers.contract.messages import Pose, Vector3, Wrench
from drivers.mock_motion import StraightMove
from drivers.mock_sway import Sway
from simulator.contact import ContactLaw, Contacts, solve
from simulator.geometry import Part, Shaft
from simulator.initial_pose import initial_poses
from simulator.states import ContactState, contact_state, hole_of, is_inserting, phase_codes
from simulator.wrench import move_torque

_NEAR_TRAY_M = 1e-5


@dataclass(frozen=True, slots=True)
class WorldSettings:
    """What the world is made of; SI units."""

    shaft: Shaft
    part: Part
    law: ContactLaw
    position_error_m: float
    """Radius of the disc in which the shaft ends up after alignment."""
    tilt_error_rad: float
    """Largest tilt after alignment."""
    stage_start: Pose
    tray: Pose
    """Where the arm starts and finds a new part; there is always one."""


class StageMotion(Protocol):
    """Where the stage's platform is."""

    @property
    def translation(self) -> Vector3:
        """The commanded way [m]."""

    @property
    def end_ns(self) -> int:
        """From when on it rests."""

    def poses(self, times_ns: Sequence[int]) -> NDArray[np.float64]:
        """Return x, y, z [m], rx, ry, rz [rad] at each time, shape (n, 6)."""


@dataclass(frozen=True, slots=True)
class Truth:
    """What really goes on between shaft and part; only a mock can know it."""

    stamp_ns: int
    phase: str
    """Which hole the shaft approaches or is inserted into, counted from 1."""
    state: ContactState
    contacts: int
    depth_m: float
    wrench: Wrench
    """On the part, about frame M's origin."""
    shaft: Pose
    """In frame M; the rotation about z, which makes no difference, is 0."""


class MockWorld:
    """Answers for any time since the last command; `version` counts what changes the force."""

    def __init__(self, settings: WorldSettings, generator: np.random.Generator) -> None:
        self.settings = settings
        self.generator = generator
        self._error = np.zeros(5)
        self._stage: StageMotion = StraightMove.rest(0, Pose())
        self._sliding = np.zeros(3)
        self._arm = StraightMove.rest(0, settings.tray)
        self._sway: Sway | None = None
        self._held = False
        self._wrench_at_rest: NDArray[np.float64] | None = None
        self.version = 0

    def set_stage(self, move: StageMotion) -> None:
        """Take over the stage's move."""
        self._stage = move
        self._has_changed()
        length = math.hypot(*move.translation)
        if length > 0.0:
            self._sliding = np.array(move.translation) / length

    def set_arm(self, move: StraightMove) -> None:
        """Take over the arm's move, which does not change the force."""
        self._arm = move

    def set_sway(self, sway: Sway) -> None:
        """Take over how the arm moves where it should stand still, and the part with it."""
        self._sway = sway
        self._has_changed()

    def pick(self, time_ns: int) -> bool:
        """Take a new part from the tray, if the arm is there; its alignment error is drawn anew."""
        place = self._arm.pose(time_ns).position
        self._held = math.dist(place, self.settings.tray.position) < _NEAR_TRAY_M
        if self._held:
            s = self.settings
            self._error = initial_poses(
                1, s.position_error_m, s.tilt_error_rad, 0.0, self.generator
            )[0]
        self._has_changed()
        return self._held

    def let_go(self) -> None:
        """Release the part."""
        self._held = False
        self._has_changed()

    def wrench(self, times_ns: Sequence[int], origin_m: Vector3) -> NDArray[np.float64]:
        """Return the true wrench on the part at each time, torque about `origin_m`: (n, 6)."""
        if not self._held:
            return np.zeros((len(times_ns), 6))
        if self._sway is None and times_ns[0] >= self._stage.end_ns:
            if self._wrench_at_rest is None:
                self._wrench_at_rest = self._moving_wrench(times_ns[:1], origin_m)
            return np.broadcast_to(self._wrench_at_rest, (len(times_ns), 6))
        return self._moving_wrench(times_ns, origin_m)

    def truth(self, time_ns: int) -> Truth | None:
        """Return contact state and wrench as they really are, None while no part is held."""
        if not self._held:
            return None
        pose = self._shaft_poses([time_ns])[0]
        contacts = self._contacts(pose)
        x, y, depth, rx, ry = pose.tolist()
        fx, fy, fz, tx, ty, tz = contacts.wrench.tolist()
        phase = int(phase_codes(self.settings.part, depth))
        doing = "inserting into" if is_inserting(phase) else "approaching"
        return Truth(
            time_ns,
            f"{doing} hole {hole_of(phase) + 1}",
            contact_state(contacts, phase),
            int(np.count_nonzero(contacts.penetration > 0.0)),
            depth,
            (fx, fy, fz, tx, ty, tz),
            Pose((x, y, depth), (rx, ry, 0.0)),
        )

    def _has_changed(self) -> None:
        self.version += 1
        self._wrench_at_rest = None

    def _moving_wrench(self, times_ns: Sequence[int], origin_m: Vector3) -> NDArray[np.float64]:
        contacts = self._contacts(self._shaft_poses(times_ns))
        return move_torque(contacts.wrench, np.array(origin_m))

    def _shaft_poses(self, times_ns: Sequence[int]) -> NDArray[np.float64]:
        poses = self._stage.poses(times_ns)[:, :5] + self._error
        return poses if self._sway is None else self._sway.seen_from_part(times_ns, poses)

    def _contacts(self, shaft_poses: NDArray[np.float64]) -> Contacts:
        s = self.settings
        return solve(s.part, s.shaft, shaft_poses, self._sliding, s.law)
