"""The supervisor's checks of the cell's state; each returns a reason for every broken limit."""

import math
from collections.abc import Sequence
from typing import NamedTuple

from controllers.limits import Limits
from controllers.messages import FilterHealth, Reason, Rule, Severity, Snapshot
from drivers.contract.messages import Pose, SensorStatus, StageState, Vector3

SPEED_TOLERANCE = 1.02
"""A measured speed may exceed the commanded limit by the stage's own velocity ripple."""
POSITION_TOLERANCE_M = 1e-6
"""A measured position may leave the workspace by the stage's own repeatability."""

_BLIND = FilterHealth.STUCK | FilterHealth.SILENT


class Load(NamedTuple):
    """What a raw sample says of the force on the part."""

    stamp_ns: int
    raw: Vector3
    """With the bias [N]."""
    force: Vector3
    """Less the bias [N]."""
    rate_N_s: float
    """Fastest growth of any axis since the sample before."""
    impulse_N_s: float
    """Of the radial force above the gentle force; starts anew once the load is gentle."""


class Memory(NamedTuple):
    """What the supervisor carries from one tick to the next."""

    now_ns: int | None = None
    load: Load | None = None
    latched: tuple[Reason, ...] = ()
    stage: StageState | None = None


def finite(*groups: Sequence[float]) -> bool:
    """Return whether every value of every group is finite (and their sum too)."""
    return math.isfinite(sum(map(sum, groups)))


def weigh(limits: Limits, memory: Memory, snapshot: Snapshot) -> Load | None:
    """Return the load of the newest raw sample, or None where it is missing or not finite."""
    sample, bias = snapshot.sample, snapshot.bias
    if sample is None or not finite(sample.wrench, bias):
        return None
    raw = sample.wrench[:3]
    x, y, z = raw[0] - bias[0], raw[1] - bias[1], raw[2] - bias[2]
    before, dt_s = memory.load, 0.0
    if before is not None:
        dt_s = (sample.stamp_ns - before.stamp_ns) * 1e-9
    if before is None or dt_s <= 0.0:
        return Load(sample.stamp_ns, raw, (x, y, z), 0.0, before.impulse_N_s if before else 0.0)
    bx, by, bz = before.raw
    rate = max(abs(raw[0] - bx), abs(raw[1] - by), abs(raw[2] - bz)) / dt_s
    excess = math.hypot(x, y) - limits.gentle_force_N
    impulse = before.impulse_N_s + excess * dt_s if excess > 0.0 else 0.0
    return Load(sample.stamp_ns, raw, (x, y, z), rate, impulse)


def time_faults(limits: Limits, memory: Memory, snapshot: Snapshot) -> list[Reason]:
    """Age of sample and device states, and the pace of the loop itself."""
    now_ns = snapshot.now_ns
    reasons = []
    if memory.now_ns is not None:
        gap_s = (now_ns - memory.now_ns) * 1e-9
        if gap_s < 0.0:
            reasons.append(Reason(Rule.CLOCK, Severity.STOP, f"by {-gap_s * 1e3:.3f} ms"))
        elif gap_s > limits.heartbeat_s:
            what = "since the tick before"
            reasons.append(too_old(Rule.HEARTBEAT, what, gap_s, limits.heartbeat_s))
    for name, message, rule, limit_s in (
        ("force sample", snapshot.sample, Rule.STALE_SAMPLE, limits.sample_age_s),
        ("stage state", snapshot.stage, Rule.STALE_DEVICE, limits.device_age_s),
        ("arm state", snapshot.arm, Rule.STALE_DEVICE, limits.device_age_s),
        ("gripper state", snapshot.gripper, Rule.STALE_DEVICE, limits.device_age_s),
    ):
        if message is None:
            reasons.append(Reason(Rule.MISSING_DATA, Severity.HOLD, f"no {name} yet"))
        elif not 0.0 <= (age_s := (now_ns - message.stamp_ns) * 1e-9) <= limit_s:
            reasons.append(too_old(rule, f"age of the {name}", age_s, limit_s))
    sample, load = snapshot.sample, memory.load
    if sample is not None and load is not None and sample.stamp_ns < load.stamp_ns:
        detail = f"stamped {(load.stamp_ns - sample.stamp_ns) * 1e-6:.3f} ms before the last one"
        reasons.append(Reason(Rule.STALE_SAMPLE, Severity.HOLD, detail))
    return reasons


def load_faults(limits: Limits, snapshot: Snapshot, load: Load) -> list[Reason]:
    """Raw force, its growth and its impulse against their limits.

    Clear of the part and before the first tare, what the sensor reads is its bias, which may exceed
    any limit: there only the growth counts.
    """
    reasons = []
    if load.rate_N_s > limits.force_rate_N_s:
        detail = f"{load.rate_N_s:.1f} N/s, limit {limits.force_rate_N_s:.1f} N/s"
        reasons.append(Reason(Rule.FORCE_RATE, Severity.HOLD, detail))
    if _reads_bias_alone(limits, snapshot):
        return reasons
    for axis, value, limit in zip("xyz", load.force, limits.force_N, strict=True):
        if abs(value) > limit:
            detail = f"f_{axis} = {value * 1e3:.1f} mN, limit {limit * 1e3:.1f} mN"
            reasons.append(Reason(Rule.FORCE, Severity.STOP, detail))
    if load.impulse_N_s > limits.impulse_N_s:
        limit_mN_s = limits.impulse_N_s * 1e3
        detail = f"{load.impulse_N_s * 1e3:.2f} mN s, limit {limit_mN_s:.2f} mN s"
        reasons.append(Reason(Rule.IMPULSE, Severity.RETREAT, detail))
    return reasons


def _reads_bias_alone(limits: Limits, snapshot: Snapshot) -> bool:
    estimate, stage = snapshot.estimate, snapshot.stage
    return (
        estimate is not None
        and stage is not None
        and stage.pose.position[2] <= limits.clear_depth_m
        and FilterHealth.UNTARED in estimate.health
    )


def sensing_faults(snapshot: Snapshot) -> list[Reason]:
    """Whether force sensor and filter can be trusted."""
    sample, estimate = snapshot.sample, snapshot.estimate
    reasons = []
    if sample is not None:
        if not finite(sample.wrench, snapshot.bias):
            detail = f"force sample {sample.wrench} less bias {snapshot.bias}"
            reasons.append(Reason(Rule.NON_FINITE, Severity.STOP, detail))
        if sample.status is not SensorStatus.OK:
            detail = f"{sample.status!r} in sample {sample.sequence}"
            reasons.append(Reason(Rule.SENSOR_STATUS, Severity.STOP, detail))
    if estimate is None:
        reasons.append(Reason(Rule.MISSING_DATA, Severity.HOLD, "no force estimate yet"))
    else:
        if not finite(estimate.wrench, estimate.std):
            detail = f"force estimate {estimate.wrench}"
            reasons.append(Reason(Rule.NON_FINITE, Severity.STOP, detail))
        if estimate.health is not FilterHealth.OK and estimate.health & _BLIND:
            reasons.append(Reason(Rule.FILTER_HEALTH, Severity.HOLD, f"{estimate.health!r}"))
    return reasons


def motion_faults(
    limits: Limits, hold_pose: Pose, memory: Memory, snapshot: Snapshot
) -> list[Reason]:
    """Measured speed and place of the stage, and whether arm and gripper keep the part in place."""
    stage, arm, gripper = snapshot.stage, snapshot.arm, snapshot.gripper
    if stage is None or arm is None or gripper is None:
        return []
    pose, there = stage.pose, arm.pose
    if not finite(pose.position, pose.rotation, stage.velocity, stage.angular_velocity):
        return [Reason(Rule.NON_FINITE, Severity.STOP, f"stage state {stage}")]
    if not finite(there.position, there.rotation):
        return [Reason(Rule.NON_FINITE, Severity.STOP, f"arm state {arm}")]
    reasons = []
    speed, turning = math.hypot(*stage.velocity), math.hypot(*stage.angular_velocity)
    if speed > limits.speed_m_s * SPEED_TOLERANCE:
        detail = f"stage at {speed * 1e3:.2f} mm/s, limit {limits.speed_m_s * 1e3:.2f} mm/s"
        reasons.append(Reason(Rule.SPEED, Severity.STOP, detail))
    if turning > limits.angular_speed_rad_s * SPEED_TOLERANCE:
        limit_deg = math.degrees(limits.angular_speed_rad_s)
        detail = f"stage at {math.degrees(turning):.3f} deg/s, limit {limit_deg:.3f} deg/s"
        reasons.append(Reason(Rule.SPEED, Severity.STOP, detail))
    before = memory.stage
    if (
        before is not None
        and before.pose is not pose
        and (detail := _leap(limits, before, pose, snapshot.now_ns))
    ):
        reasons.append(Reason(Rule.SPEED, Severity.STOP, detail))
    if detail := outside(limits, pose, POSITION_TOLERANCE_M):
        reasons.append(Reason(Rule.WORKSPACE, Severity.STOP, detail))
    if pose.position[2] > limits.clear_depth_m:
        if detail := arm_away(limits, hold_pose, there):
            reasons.append(Reason(Rule.KEEP_OUT, Severity.STOP, f"stage in the part, {detail}"))
        elif arm.moving:
            reasons.append(Reason(Rule.KEEP_OUT, Severity.STOP, "stage in the part, arm moving"))
        if gripper.valve_open and not gripper.part_held:
            reasons.append(Reason(Rule.VACUUM, Severity.STOP, "stage in the part, part not held"))
    return reasons


def _leap(limits: Limits, before: StageState, pose: Pose, now_ns: int) -> str:
    """Return in words how the stage is where it cannot be by now, or nothing.

    A step is sent relative to the reported place: were that wrong, the stage would go far.
    """
    time_s = max(0.0, (now_ns - before.stamp_ns) * 1e-9) * SPEED_TOLERANCE
    way = math.dist(pose.position, before.pose.position)
    turn = math.dist(pose.rotation, before.pose.rotation)
    if (
        way > limits.speed_m_s * time_s + POSITION_TOLERANCE_M
        or turn > limits.angular_speed_rad_s * time_s + POSITION_TOLERANCE_M / limits.lever_m
    ):
        return (
            f"stage displaced by {way * 1e6:.1f} um and {math.degrees(turn):.4f} deg, "
            "faster than its limit"
        )
    return ""


def outside(limits: Limits, pose: Pose, tolerance_m: float) -> str:
    """Return in words how `pose` leaves the workspace, or nothing if it does not."""
    bounds = zip("xyz", pose.position, limits.workspace_min_m, limits.workspace_max_m, strict=True)
    for axis, value, low, high in bounds:
        if not low - tolerance_m <= value <= high + tolerance_m:
            return (
                f"{axis} = {value * 1e6:.2f} um is outside {low * 1e6:.1f} to {high * 1e6:.1f} um"
            )
    tilt = math.hypot(*pose.rotation)
    if tilt > limits.tilt_rad:
        limit_deg = math.degrees(limits.tilt_rad)
        return f"tilt {math.degrees(tilt):.3f} deg, limit {limit_deg:.3f} deg"
    return ""


def arm_away(limits: Limits, hold_pose: Pose, pose: Pose) -> str:
    """Return in words how far the arm is from where it must hold the part, or nothing.

    A turn counts with the longest lever, as the farthest contact is moved by it.
    """
    distance = math.dist(pose.position, hold_pose.position)
    (rx, ry, rz), (hx, hy, hz), turn = pose.rotation, hold_pose.rotation, math.tau
    angle = math.hypot(
        math.remainder(rx - hx, turn), math.remainder(ry - hy, turn), math.remainder(rz - hz, turn)
    )
    if distance + limits.lever_m * angle > limits.arm_tolerance_m:
        return (
            f"arm {distance * 1e6:.1f} um and {math.degrees(angle):.3f} deg "
            "from where it holds the part"
        )
    return ""


def too_old(rule: Rule, what: str, time_s: float, limit_s: float) -> Reason:
    """Return the reason to hold when `what` has lasted `time_s`."""
    detail = f"{what} {time_s * 1e3:.3f} ms, limit {limit_s * 1e3:.3f} ms"
    return Reason(rule, Severity.HOLD, detail)
