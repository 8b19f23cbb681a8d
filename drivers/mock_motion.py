"""Straight moves of the mock stage and the mock arm, as functions of time."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from drivers.contract.messages import Pose, Vector3
from simulator.plant import Trapezoid, braking


@dataclass(frozen=True, slots=True)
class StraightMove:
    """From `start` along `translation` [m] and `rotation` [rad], both in step.

    `profile` runs over the share of the way that has been covered, from 0.
    """

    start_ns: int
    start: Pose
    translation: Vector3
    rotation: Vector3
    profile: Trapezoid
    is_braking: bool = False

    @classmethod
    def rest(cls, time_ns: int, pose: Pose) -> "StraightMove":
        """No move: at `pose` for ever."""
        return cls(time_ns, pose, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), braking(0.0, 1.0))

    @classmethod
    def between(cls, start_ns: int, start: Pose, target: Pose, speeds: "Speeds") -> "StraightMove":
        """Return the move from rest at `start` to rest at `target`."""
        translation = _difference(target.position, start.position)
        rotation = _difference(target.rotation, start.rotation)
        if not any((*translation, *rotation)):
            return cls.rest(start_ns, start)
        fastest, hardest = speeds.as_shares(translation, rotation)
        profile = Trapezoid(1.0, 0.0, fastest, hardest)
        return cls(start_ns, start, translation, rotation, profile)

    def slowed(self, time_ns: int, speeds: "Speeds") -> "StraightMove":
        """Return the rest of this move from `time_ns` on, at no more than `speeds`."""
        fastest, hardest = speeds.as_shares(self.translation, self.rotation)
        covered, speed = self.profile.at(self._elapsed_s(time_ns))
        left = self.profile.distance_m - covered
        needed_to_stop = speed**2 / (2.0 * hardest)
        profile = Trapezoid(max(left, needed_to_stop), speed, fastest, hardest)
        return replace(self, start_ns=time_ns, start=self.pose(time_ns), profile=profile)

    def braked(self, time_ns: int, speeds: "Speeds") -> "StraightMove":
        """Return the way to rest from `time_ns` on, on the line of this move."""
        _, hardest = speeds.as_shares(self.translation, self.rotation)
        profile = braking(self.profile.at(self._elapsed_s(time_ns))[1], hardest)
        return replace(
            self, start_ns=time_ns, start=self.pose(time_ns), profile=profile, is_braking=True
        )

    def poses(self, times_ns: Sequence[int]) -> NDArray[np.float64]:
        """Return x, y, z [m], rx, ry, rz [rad] at each time, shape (n, 6)."""
        shares = [self.profile.at(self._elapsed_s(time_ns))[0] for time_ns in times_ns]
        start = np.array([*self.start.position, *self.start.rotation])
        way = np.array([*self.translation, *self.rotation])
        return np.asarray(start + np.multiply.outer(shares, way))

    def pose(self, time_ns: int) -> Pose:
        return self.state(time_ns)[0]

    def state(self, time_ns: int) -> tuple[Pose, Vector3, Vector3]:
        """Return pose, linear velocity [m/s] and angular velocity [rad/s]."""
        covered, speed = self.profile.at(self._elapsed_s(time_ns))
        start = self.start
        pose = Pose(
            _sum(start.position, _scaled(self.translation, covered)),
            _sum(start.rotation, _scaled(self.rotation, covered)),
        )
        return pose, _scaled(self.translation, speed), _scaled(self.rotation, speed)

    def is_running(self, time_ns: int) -> bool:
        return time_ns < self.end_ns

    @property
    def end_ns(self) -> int:
        return self.start_ns + math.ceil(self.profile.duration_s * 1e9)

    def _elapsed_s(self, time_ns: int) -> float:
        """Time since the start; before it nothing has moved yet."""
        return max(time_ns - self.start_ns, 0) * 1e-9


@dataclass(frozen=True, slots=True)
class Speeds:
    """Bounds on speed and acceleration of a move."""

    linear_m_s: float
    angular_rad_s: float
    linear_m_s2: float
    angular_rad_s2: float

    def as_shares(self, translation: Vector3, rotation: Vector3) -> tuple[float, float]:
        """Return the bounds on share of the way per second, and per second squared."""
        length, angle = math.hypot(*translation), math.hypot(*rotation)
        return (
            min(_ratio(self.linear_m_s, length), _ratio(self.angular_rad_s, angle)),
            min(_ratio(self.linear_m_s2, length), _ratio(self.angular_rad_s2, angle)),
        )


def _sum(a: Vector3, b: Vector3) -> Vector3:
    return (a[0] + b[0], a[1] + b[1], a[2] + b[2])


def _difference(a: Vector3, b: Vector3) -> Vector3:
    return (a[0] - b[0], a[1] - b[1], a[2] - b[2])


def _scaled(vector: Vector3, factor: float) -> Vector3:
    return (vector[0] * factor, vector[1] * factor, vector[2] * factor)


def _ratio(bound: float, way: float) -> float:
    return bound / way if way > 0.0 else math.inf
