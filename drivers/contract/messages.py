"""What devices say: frozen values in SI units, stamped in integer nanoseconds.

Frames: M is fixed to the part (origin at the upper rim's centre, +z into the hole); F is parallel
to M with its origin at the force sensor. Forces are those that the shaft exerts on the part.
"""

from dataclasses import dataclass
from enum import IntFlag
from typing import NamedTuple

Vector3 = tuple[float, float, float]
Wrench = tuple[float, float, float, float, float, float]
"""Force x, y, z [N], then torque x, y, z [N*m], in frame F."""

ZERO3: Vector3 = (0.0, 0.0, 0.0)


@dataclass(frozen=True, slots=True)
class Pose:
    """Position [m] and rotation [rad] about x, then y, then z."""

    position: Vector3 = ZERO3
    rotation: Vector3 = ZERO3


class SensorStatus(IntFlag):
    """What a force sensor says of one sample; several may hold at once."""

    OK = 0
    SATURATED = 1
    """At least one axis is at the end of its range, so the true load is unknown."""
    FAULT = 2
    """The device reports that its data are unusable."""


class ForceSample(NamedTuple):
    """One raw sample, before bias and filter."""

    stamp_ns: int
    """When it was measured."""
    receipt_ns: int
    """When the host had it."""
    sequence: int
    """Counts up by one for each sample that the sensor made."""
    wrench: Wrench
    status: SensorStatus = SensorStatus.OK


class StageState(NamedTuple):
    """The stage carries the shaft; its pose is the nominal pose of the shaft's leading end in M."""

    stamp_ns: int
    pose: Pose
    velocity: Vector3
    """[m/s]"""
    angular_velocity: Vector3
    """[rad/s]"""
    moving: bool


class ArmState(NamedTuple):
    """The arm carries gripper, sensor and part; its pose is given in the cell's frame."""

    stamp_ns: int
    pose: Pose
    moving: bool


class GripperState(NamedTuple):
    """A vacuum gripper: one valve (digital output) and one vacuum switch (digital input)."""

    stamp_ns: int
    valve_open: bool
    part_held: bool


@dataclass(frozen=True, slots=True)
class StageCommand:
    """What a stage has accepted: the target it moves to and the path speed it will not exceed."""

    stamp_ns: int
    target: Pose
    speed_m_s: float
    angular_speed_rad_s: float
