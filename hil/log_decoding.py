"""ROS 2 messages of the log as our own values: the way back of `ros_messages`."""

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from controllers.messages import (
    ContactBelief,
    FilterHealth,
    ForceEstimate,
    Observation,
    PhaseChange,
    Proposal,
    Reason,
    ResetRecord,
    Rule,
    Sent,
    Severity,
    SkillPhase,
    Verdict,
)
from drivers.contract.messages import Pose, Vector3, Wrench
from hil import ros_types as ros
from hil.ros_messages import NS_PER_S, ContactTruth, LoopTiming


@dataclass(frozen=True, slots=True)
class DeviceStatus:
    """What a device, or the force filter, said of itself."""

    stamp_ns: int
    device: str
    level: int
    """0 ok, 1 warning, 2 error, 3 nothing heard."""
    message: str
    values: Mapping[str, str]


def _stamp_ns(header: ros.Header) -> int:
    return header.stamp.sec * NS_PER_S + header.stamp.nanosec


def _vector(value: ros.Vector3) -> Vector3:
    return (value.x, value.y, value.z)


def _wrench(value: ros.Wrench) -> Wrench:
    force, torque = value.force, value.torque
    return (force.x, force.y, force.z, torque.x, torque.y, torque.z)


def rotation(value: ros.Quaternion) -> Vector3:
    """Return the rotation [rad] about x, then y, then z; y within +-90 degrees."""
    x, y, z, w = value.x, value.y, value.z, value.w
    return (
        math.atan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y)),
        math.asin(max(-1.0, min(1.0, 2 * (w * y - z * x)))),
        math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z)),
    )


def wrench_stamped(data: bytes) -> tuple[int, Wrench]:
    """Return stamp [ns] and wrench [N, N*m]."""
    message = ros.decode(data, ros.WrenchStamped)
    return _stamp_ns(message.header), _wrench(message.wrench)


def pose_stamped(data: bytes) -> tuple[int, Vector3, Vector3]:
    """Return stamp [ns], position [m] and rotation [rad] about x, then y, then z."""
    message = ros.decode(data, ros.PoseStamped)
    position = message.pose.position
    return (
        _stamp_ns(message.header),
        (position.x, position.y, position.z),
        rotation(message.pose.orientation),
    )


def twist_stamped(data: bytes) -> tuple[int, Vector3, Vector3]:
    """Return stamp [ns], velocity [m/s] and angular velocity [rad/s]."""
    message = ros.decode(data, ros.TwistStamped)
    twist = message.twist
    return _stamp_ns(message.header), _vector(twist.linear), _vector(twist.angular)


def force_estimate(data: bytes) -> ForceEstimate:
    """Return the filter's estimate."""
    message = ros.decode(data, ros.ForceEstimate)
    return ForceEstimate(
        stamp_ns=_stamp_ns(message.header),
        wrench=_wrench(message.wrench),
        rate=_wrench(message.wrench_rate),
        std=_wrench(message.wrench_std),
        nis=message.nis,
        health=FilterHealth(message.health),
    )


def observation(data: bytes) -> Observation:
    """Return what a controller knew."""
    message = ros.decode(data, ros.Observation)
    return Observation(
        stamp_ns=_stamp_ns(message.header),
        step=message.step,
        wrench=_wrench(message.wrench),
        wrench_std=_wrench(message.wrench_std),
        pose=Pose(_vector(message.position_m), _vector(message.rotation_rad)),
        displacement=_vector(message.displacement_m),
        commanded=Pose(_vector(message.commanded_m), _vector(message.commanded_rad)),
    )


def belief(data: bytes) -> ContactBelief:
    """Return what a controller believed."""
    message = ros.decode(data, ros.Belief)
    return ContactBelief(
        stamp_ns=_stamp_ns(message.header),
        mean=tuple(message.mean.tolist()),
        covariance=tuple(message.covariance.tolist()),
        state=message.state,
        state_probability=message.state_probability,
        misfit=message.misfit,
        restarts=message.restarts,
    )


def proposal(data: bytes) -> Proposal:
    """Return a step proposed."""
    message = ros.decode(data, ros.Proposal)
    return Proposal(
        stamp_ns=_stamp_ns(message.header),
        number=message.number,
        source=message.source,
        translation=_vector(message.translation_m),
        rotation=_vector(message.rotation_rad),
        expected_force=_vector(message.expected_force),
    )


def _reasons(reasons: Iterable[ros.Reason]) -> tuple[Reason, ...]:
    return tuple(Reason(Rule(r.rule), Severity(r.severity), r.detail) for r in reasons)


def _verdict(message: ros.Verdict) -> Verdict:
    return Verdict(_stamp_ns(message.header), _reasons(message.reasons), message.speed_cap_m_s)


def verdict(data: bytes) -> Verdict:
    """Return the supervisor's answer."""
    return _verdict(ros.decode(data, ros.Verdict))


def sent(data: bytes) -> Sent:
    """Return the gate's answer to a proposal."""
    message = ros.decode(data, ros.Sent)
    target = Pose(_vector(message.target_position_m), _vector(message.target_rotation_rad))
    return Sent(
        stamp_ns=_stamp_ns(message.header),
        number=message.number,
        verdict=_verdict(message.verdict),
        target=target if message.sent else None,
        translation=_vector(message.translation_m),
        rotation=_vector(message.rotation_rad),
        speed_m_s=message.speed_m_s,
    )


def loop_timing(data: bytes) -> LoopTiming:
    """Return the loop's timing over one window."""
    message = ros.decode(data, ros.LoopTiming)
    return LoopTiming(
        stamp_ns=_stamp_ns(message.header),
        window_s=message.window_s,
        ticks=message.ticks,
        mean_s=message.sample_to_verdict_mean_s,
        median_s=message.sample_to_verdict_median_s,
        max_s=message.sample_to_verdict_max_s,
        deadline_s=message.deadline_s,
        missed_deadlines=message.missed_deadlines,
    )


def contact_state(data: bytes) -> ContactTruth:
    """Return the truth about the contact."""
    message = ros.decode(data, ros.ContactState)
    return ContactTruth(
        stamp_ns=_stamp_ns(message.header),
        state=message.state,
        phase=message.phase,
        contacts=message.contacts,
        depth_m=message.depth_m,
        wrench=_wrench(message.wrench),
        shaft=Pose(_vector(message.position_m), _vector(message.rotation_rad)),
    )


def phase_change(data: bytes) -> PhaseChange:
    """Return a phase that an insertion entered."""
    message = ros.decode(data, ros.PhaseChange)
    return PhaseChange(
        stamp_ns=_stamp_ns(message.header),
        insertion=message.insertion,
        phase=SkillPhase(message.phase),
        reason=message.reason,
        steps=message.steps,
    )


def reset(data: bytes) -> ResetRecord:
    """Return an operator's reset."""
    message = ros.decode(data, ros.Reset)
    return ResetRecord(_stamp_ns(message.header), message.operator_name, _reasons(message.cleared))


def diagnostics(data: bytes) -> tuple[DeviceStatus, ...]:
    """Return what the devices said of themselves."""
    message = ros.decode(data, ros.DiagnosticArray)
    return tuple(
        DeviceStatus(
            stamp_ns=_stamp_ns(message.header),
            device=status.name,
            level=status.level,
            message=status.message,
            values={pair.key: pair.value for pair in status.values},
        )
        for status in message.status
    )
