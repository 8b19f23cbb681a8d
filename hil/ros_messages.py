"""Our values as ROS 2 messages.

Every number keeps its last bit, except the rotation in pose messages, which ROS states as a
quaternion.
"""

import math
from collections.abc import Iterable
from dataclasses import dataclass
from enum import IntFlag

import numpy as np

from controllers.messages import (
    ContactBelief,
    FilterHealth,
    ForceEstimate,
    Observation,
    PhaseChange,
    Proposal,
    Reason,
    ResetRecord,
    Sent,
    Snapshot,
    Verdict,
)
from drivers.contract.messages import ForceSample, Pose, SensorStatus, StageState, Vector3, Wrench
from hil import ros_types as ros

NS_PER_S = 1_000_000_000

FORCE_SENSOR = "force_sensor"
"""Frame F: parallel to the part's frame, origin at the force sensor."""
PART = "part"
"""Frame M: origin at the upper rim's centre, +z into the hole."""
CELL = "cell"
"""The frame in which the arm reports its pose."""

_NO_POSE = Pose((math.nan,) * 3, (math.nan,) * 3)


@dataclass(frozen=True, slots=True)
class ContactTruth:
    """What only a mock cell knows about the contact."""

    stamp_ns: int
    state: str
    phase: str
    contacts: int
    depth_m: float
    wrench: Wrench
    """[N, N*m], about the origin of frame M, without noise and bias."""
    shaft: Pose
    """In frame M; position of the leading end's centre."""


@dataclass(frozen=True, slots=True)
class LoopTiming:
    """How long the loop took from sample to verdict, over one window."""

    stamp_ns: int
    """End of the window."""
    window_s: float
    ticks: int
    mean_s: float
    median_s: float
    max_s: float
    deadline_s: float
    missed_deadlines: int


def _header(stamp_ns: int, frame: str = "") -> ros.Header:
    return ros.Header(ros.Time(*divmod(stamp_ns, NS_PER_S)), frame)


def _vector(value: Vector3) -> ros.Vector3:
    return ros.Vector3(*value)


def _wrench(value: Wrench) -> ros.Wrench:
    return ros.Wrench(_vector(value[:3]), _vector(value[3:]))


def wrench_stamped(stamp_ns: int, wrench: Wrench) -> ros.WrenchStamped:
    """Return a wrench [N, N*m] in frame F."""
    return ros.WrenchStamped(_header(stamp_ns, FORCE_SENSOR), _wrench(wrench))


class RawForceEncoder:
    """Turns raw samples into encoded `WrenchStamped` at the sensor's full rate."""

    def __init__(self) -> None:
        message = wrench_stamped(0, (0.0,) * 6)
        self._encoder = ros.RepeatedEncoder(message)
        self._stamp = message.header.stamp
        self._force, self._torque = message.wrench.force, message.wrench.torque

    def encode(self, sample: ForceSample) -> bytes:
        """Return the sample's wrench [N, N*m], stamped with when it was measured."""
        stamp, force, torque = self._stamp, self._force, self._torque
        stamp.sec, stamp.nanosec = divmod(sample.stamp_ns, NS_PER_S)
        force.x, force.y, force.z, torque.x, torque.y, torque.z = sample.wrench
        return self._encoder.encode()


def quaternion(rotation: Vector3) -> ros.Quaternion:
    """Return Rz Ry Rx of a rotation [rad] about x, then y, then z."""
    x, y, z = rotation
    cx, cy, cz = math.cos(x / 2), math.cos(y / 2), math.cos(z / 2)
    sx, sy, sz = math.sin(x / 2), math.sin(y / 2), math.sin(z / 2)
    return ros.Quaternion(
        x=sx * cy * cz - cx * sy * sz,
        y=cx * sy * cz + sx * cy * sz,
        z=cx * cy * sz - sx * sy * cz,
        w=cx * cy * cz + sx * sy * sz,
    )


def pose_stamped(stamp_ns: int, pose: Pose, frame: str) -> ros.PoseStamped:
    """Return a pose in `frame`."""
    position = ros.Point(*pose.position)
    return ros.PoseStamped(
        _header(stamp_ns, frame),
        ros.Pose(position, quaternion(pose.rotation)),
    )


def twist_stamped(state: StageState) -> ros.TwistStamped:
    """Return the stage's velocity [m/s, rad/s] in frame M."""
    twist = ros.Twist(_vector(state.velocity), _vector(state.angular_velocity))
    return ros.TwistStamped(_header(state.stamp_ns, PART), twist)


def force_estimate(estimate: ForceEstimate) -> ros.ForceEstimate:
    """Return the filter's estimate."""
    return ros.ForceEstimate(
        header=_header(estimate.stamp_ns, FORCE_SENSOR),
        wrench=_wrench(estimate.wrench),
        wrench_rate=_wrench(estimate.rate),
        wrench_std=_wrench(estimate.std),
        nis=estimate.nis,
        health=int(estimate.health),
    )


def observation(value: Observation) -> ros.Observation:
    """Return what the controller knew."""
    return ros.Observation(
        header=_header(value.stamp_ns, PART),
        step=value.step,
        wrench=_wrench(value.wrench),
        wrench_std=_wrench(value.wrench_std),
        position_m=_vector(value.pose.position),
        rotation_rad=_vector(value.pose.rotation),
        displacement_m=_vector(value.displacement),
        commanded_m=_vector(value.commanded.position),
        commanded_rad=_vector(value.commanded.rotation),
    )


def belief(value: ContactBelief) -> ros.Belief:
    """Return what a controller believes."""
    return ros.Belief(
        header=_header(value.stamp_ns, PART),
        mean=np.array(value.mean),
        deviation=np.array(value.std),
        covariance=np.array(value.covariance),
        state=value.state,
        state_probability=value.state_probability,
        misfit=value.misfit,
        restarts=value.restarts,
    )


def proposal(value: Proposal) -> ros.Proposal:
    """Return the step proposed."""
    return ros.Proposal(
        header=_header(value.stamp_ns, PART),
        number=value.number,
        source=value.source,
        translation_m=_vector(value.translation),
        rotation_rad=_vector(value.rotation),
        expected_force=_vector(value.expected_force),
    )


def _reasons(reasons: Iterable[Reason]) -> list[ros.Reason]:
    return [ros.Reason(r.rule.value, int(r.severity), r.detail) for r in reasons]


def verdict(value: Verdict) -> ros.Verdict:
    """Return the supervisor's answer."""
    return ros.Verdict(
        header=_header(value.stamp_ns),
        severity=int(value.severity),
        reasons=_reasons(value.reasons),
        speed_cap_m_s=value.speed_cap_m_s,
    )


def sent(value: Sent) -> ros.Sent:
    """Return the gate's answer to a proposal."""
    target = value.target or _NO_POSE
    return ros.Sent(
        header=_header(value.stamp_ns, PART),
        number=value.number,
        sent=value.target is not None,
        target_position_m=_vector(target.position),
        target_rotation_rad=_vector(target.rotation),
        translation_m=_vector(value.translation),
        rotation_rad=_vector(value.rotation),
        speed_m_s=value.speed_m_s,
        verdict=verdict(value.verdict),
    )


def loop_timing(timing: LoopTiming) -> ros.LoopTiming:
    """Return the loop's timing over one window."""
    return ros.LoopTiming(
        header=_header(timing.stamp_ns),
        window_s=timing.window_s,
        ticks=timing.ticks,
        sample_to_verdict_mean_s=timing.mean_s,
        sample_to_verdict_median_s=timing.median_s,
        sample_to_verdict_max_s=timing.max_s,
        deadline_s=timing.deadline_s,
        missed_deadlines=timing.missed_deadlines,
    )


def contact_state(truth: ContactTruth) -> ros.ContactState:
    """Return the truth about the contact."""
    return ros.ContactState(
        header=_header(truth.stamp_ns, PART),
        state=truth.state,
        phase=truth.phase,
        contacts=truth.contacts,
        depth_m=truth.depth_m,
        wrench=_wrench(truth.wrench),
        position_m=_vector(truth.shaft.position),
        rotation_rad=_vector(truth.shaft.rotation),
    )


def phase_change(change: PhaseChange) -> ros.PhaseChange:
    """Return the phase that an insertion enters."""
    return ros.PhaseChange(
        header=_header(change.stamp_ns),
        insertion=change.insertion,
        phase=change.phase.value,
        reason=change.reason,
        steps=change.steps,
    )


def reset(record: ResetRecord) -> ros.Reset:
    """Return an operator's reset."""
    return ros.Reset(_header(record.stamp_ns), record.operator, _reasons(record.cleared))


def _status(device: str, level: int, message: str, **values: object) -> ros.DiagnosticStatus:
    pairs = [ros.KeyValue(key, str(value).lower()) for key, value in values.items()]
    return ros.DiagnosticStatus(level, device, message, "", pairs)


def _flags(flags: IntFlag) -> str:
    return ", ".join(str(flag.name).lower() for flag in flags) or "ok"


def _sensor_status(sample: ForceSample) -> ros.DiagnosticStatus:
    level = (
        ros.DiagnosticStatus.OK if sample.status is SensorStatus.OK else ros.DiagnosticStatus.ERROR
    )
    return _status("force_sensor", level, _flags(sample.status), sequence=sample.sequence)


def _filter_status(estimate: ForceEstimate) -> ros.DiagnosticStatus:
    level = (
        ros.DiagnosticStatus.OK if estimate.health is FilterHealth.OK else ros.DiagnosticStatus.WARN
    )
    return _status("force_filter", level, _flags(estimate.health), nis=estimate.nis)


def diagnostics(snapshot: Snapshot) -> ros.DiagnosticArray:
    """Return what force sensor, force filter, stage, arm and gripper say of themselves."""
    ok = ros.DiagnosticStatus.OK
    sample, estimate, gripper = snapshot.sample, snapshot.estimate, snapshot.gripper
    found = {
        "force_sensor": sample and _sensor_status(sample),
        "force_filter": estimate and _filter_status(estimate),
        "stage": snapshot.stage and _status("stage", ok, "ok", moving=snapshot.stage.moving),
        "arm": snapshot.arm and _status("arm", ok, "ok", moving=snapshot.arm.moving),
        "gripper": gripper
        and _status(
            "gripper", ok, "ok", valve_open=gripper.valve_open, part_held=gripper.part_held
        ),
    }
    return ros.DiagnosticArray(
        _header(snapshot.now_ns),
        [
            status or _status(device, ros.DiagnosticStatus.STALE, "nothing heard yet")
            for device, status in found.items()
        ],
    )
