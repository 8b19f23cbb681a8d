"""The safety supervisor: a pure function from what is known to what is allowed.

It denies by default: a value that is missing, old or not finite is a reason to hold or to stop,
never one to go on. `watch` runs on every tick, `judge` on every proposal. This is no certified
safety function.
"""

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from controllers.faults import (
    Load,
    Memory,
    arm_away,
    finite,
    load_faults,
    motion_faults,
    outside,
    sensing_faults,
    time_faults,
    too_old,
    weigh,
)
from controllers.governor import Travel, speed_cap
from controllers.limits import Limits
from controllers.messages import (
    FilterHealth,
    ForceEstimate,
    Proposal,
    Reason,
    Rule,
    Severity,
    Snapshot,
    Verdict,
)
from drivers.contract.messages import ZERO3, Pose, Vector3

GOVERNOR_DEADBAND = 0.9
"""A cap lower than this share of a speed counts: a running move is slowed, not for every sample,
and a step that the load makes so much slower is reduced, not every one that carries noise."""
SHORTEST_MOVE_M = 1e-15
"""No stage moves by less, and a speed divided by much less than this may overflow."""


@dataclass(frozen=True, slots=True)
class RunningMove:
    """The stage move that the gate has sent last."""

    travel: Travel
    leads_out: bool
    """Whether it is a way out of the part, which a retreat lets run."""
    speed_m_s: float
    """Along the travel."""


@dataclass(frozen=True, slots=True)
class Step:
    """A step that may be sent."""

    translation: Vector3
    rotation: Vector3
    travel: Travel
    speed_m_s: float
    """Along the travel."""

    @property
    def leads_out(self) -> bool:
        """Whether it leads out of the part, and no farther sideways than out."""
        return self.translation[2] < 0.0 and self.travel.radial_m <= self.travel.axial_m


def watch(
    limits: Limits,
    hold_pose: Pose,
    memory: Memory,
    snapshot: Snapshot,
    running: RunningMove | None,
) -> tuple[Verdict, Memory]:
    """Judge the state of the cell at one tick.

    `hold_pose` is where the arm has to keep the part. A stop stays in the returned memory's
    `latched` until an operator clears it.
    """
    load = weigh(limits, memory, snapshot)
    reasons = time_faults(limits, memory, snapshot)
    if load is not None:
        reasons += load_faults(limits, snapshot, load)
    reasons += sensing_faults(snapshot)
    reasons += motion_faults(limits, hold_pose, memory, snapshot)
    cap = math.inf
    if running is not None:
        cap = governed_speed(limits, load, snapshot.estimate, running.travel)
        if cap < GOVERNOR_DEADBAND * running.speed_m_s:
            detail = f"{running.speed_m_s * 1e3:.2f} mm/s lowered to {cap * 1e3:.2f} mm/s"
            reasons.append(Reason(Rule.GOVERNOR, Severity.REDUCE, detail))
    before = memory.load
    if load is None or (before is not None and load.stamp_ns < before.stamp_ns):
        load = before
    seen_stage = snapshot.stage or memory.stage
    memory = Memory(snapshot.now_ns, load, memory.latched, seen_stage)
    if reasons:
        memory = latch(memory, reasons)
        reasons = [reason for reason in reasons if reason.severity is not Severity.STOP]
    return Verdict(snapshot.now_ns, (*memory.latched, *reasons), cap), memory


def judge(
    limits: Limits,
    hold_pose: Pose,
    standing: Verdict,
    snapshot: Snapshot,
    proposal: Proposal,
    now_ns: int,
) -> tuple[Verdict, Step | None]:
    """Judge at `now_ns` a proposed step against `standing`, the verdict of the snapshot's tick.

    Returns the verdict and the step that may be sent in its place, None if it is refused.
    """
    if not finite(proposal.translation, proposal.rotation, proposal.expected_force):
        values = f"{proposal.translation}, {proposal.rotation}, {proposal.expected_force}"
        detail = f"proposal {values} of {proposal.source}"
        reason = Reason(Rule.NON_FINITE, Severity.STOP, detail)
        return Verdict(now_ns, (*standing.reasons, reason), standing.speed_cap_m_s), None
    step, reductions = _reduced(limits, snapshot, proposal)
    refusals = [
        *_refused_by_time(limits, snapshot, proposal, now_ns),
        *_refused_by_state(limits, hold_pose, standing, snapshot, step),
    ]
    allowed = standing.severity < Severity.HOLD or standing.lets_out
    if refusals or not allowed or snapshot.stage is None:
        reasons = (*standing.reasons, *refusals)
        return Verdict(now_ns, reasons, standing.speed_cap_m_s), None
    reasons = (*standing.reasons, *reductions)
    if detail := outside(limits, displaced(snapshot.stage.pose, step), 0.0):
        reason = Reason(Rule.WORKSPACE, Severity.HOLD, f"target {detail}")
        return Verdict(now_ns, (*reasons, reason), step.speed_m_s), None
    return Verdict(now_ns, reasons, step.speed_m_s), step


def governed_speed(
    limits: Limits,
    load: Load | None,
    estimate: ForceEstimate | None,
    travel: Travel,
    expected: Vector3 = ZERO3,
) -> float:
    """Return the governor's cap [m/s] under the largest of raw, estimated and expected force.

    Creep speed where raw or estimated force is unknown.
    """
    if load is None or estimate is None:
        return limits.creep_speed_m_s
    raw, filtered, std = load.force, estimate.wrench, estimate.std
    x = max(abs(raw[0]), abs(filtered[0]), abs(expected[0]))
    y = max(abs(raw[1]), abs(filtered[1]), abs(expected[1]))
    z = max(abs(raw[2]), abs(filtered[2]), abs(expected[2]))
    return speed_cap(limits, (x, y, z), (std[0], std[1], std[2]), travel)


def latch(memory: Memory, reasons: Iterable[Reason]) -> Memory:
    """Return the memory with every new stop among `reasons` added; the first of each rule stays."""
    held = {reason.rule for reason in memory.latched}
    new = {r.rule: r for r in reasons if r.severity is Severity.STOP and r.rule not in held}
    return memory._replace(latched=(*memory.latched, *new.values())) if new else memory


def displaced(pose: Pose, step: Step) -> Pose:
    """Return `pose` moved by `step`."""
    x, y, z = pose.position
    rx, ry, rz = pose.rotation
    dx, dy, dz = step.translation
    drx, dry, drz = step.rotation
    return Pose((x + dx, y + dy, z + dz), (rx + drx, ry + dry, rz + drz))


def _refused_by_time(
    limits: Limits, snapshot: Snapshot, proposal: Proposal, now_ns: int
) -> Iterator[Reason]:
    for rule, stamp_ns, limit_s in (
        (Rule.STALE_PROPOSAL, proposal.stamp_ns, limits.proposal_age_s),
        (Rule.HEARTBEAT, snapshot.now_ns, limits.heartbeat_s),
    ):
        age_s = (now_ns - stamp_ns) * 1e-9
        if not 0.0 <= age_s <= limit_s:
            yield too_old(rule, "age", age_s, limit_s)


def _refused_by_state(
    limits: Limits, hold_pose: Pose, standing: Verdict, snapshot: Snapshot, step: Step
) -> Iterator[Reason]:
    if standing.severity is Severity.RETREAT and not step.leads_out:
        asked = ", ".join(f"{v * 1e6:.1f}" for v in step.translation)
        yield Reason(Rule.RETREATING, Severity.HOLD, f"asked for ({asked}) um")
    stage, arm, gripper, estimate = (
        snapshot.stage,
        snapshot.arm,
        snapshot.gripper,
        snapshot.estimate,
    )
    if stage is None or arm is None or gripper is None or estimate is None:
        return
    if stage.moving:
        yield Reason(Rule.BUSY, Severity.HOLD, "a step is sent only from rest")
    depth_after = stage.pose.position[2] + step.translation[2]
    if not step.leads_out and depth_after > limits.clear_depth_m:
        if detail := arm_away(limits, hold_pose, arm.pose):
            yield Reason(Rule.KEEP_OUT, Severity.HOLD, detail)
        elif arm.moving:
            yield Reason(Rule.KEEP_OUT, Severity.HOLD, "arm moving")
        if not (gripper.valve_open and gripper.part_held):
            detail = "no part held" if gripper.valve_open else "valve closed"
            yield Reason(Rule.VACUUM, Severity.HOLD, detail)
        if estimate.health & FilterHealth.UNTARED:
            yield Reason(Rule.UNTARED, Severity.HOLD, "take the bias first")


def _reduced(
    limits: Limits, snapshot: Snapshot, proposal: Proposal
) -> tuple[Step, tuple[Reason, ...]]:
    reasons = []
    translation = _clipped(proposal.translation, limits.step_m)
    if translation != proposal.translation:
        asked = ", ".join(f"{v * 1e6:.1f}" for v in proposal.translation)
        reasons.append(Reason(Rule.STEP_BOX, Severity.REDUCE, f"asked for ({asked}) um"))
    turn = limits.rotation_step_rad
    rotation = _clipped(proposal.rotation, (turn, turn, turn))
    if rotation != proposal.rotation:
        asked = ", ".join(f"{math.degrees(v):.4f}" for v in proposal.rotation)
        reasons.append(Reason(Rule.STEP_BOX, Severity.REDUCE, f"asked for ({asked}) deg"))
    travel = Travel.of(translation, rotation, limits.lever_m)
    if travel.length_m < SHORTEST_MOVE_M:
        translation, rotation = ZERO3, ZERO3
    load = weigh(limits, Memory(), snapshot)
    speed = governed_speed(limits, load, snapshot.estimate, travel, proposal.expected_force)
    unloaded = speed_cap(limits, ZERO3, ZERO3, travel)
    if travel.angle_rad > 0.0:
        turning = limits.angular_speed_rad_s * travel.length_m / travel.angle_rad
        speed, unloaded = min(speed, turning), min(unloaded, turning)
    if speed < GOVERNOR_DEADBAND * unloaded:
        detail = f"{speed * 1e3:.2f} mm/s, without load {unloaded * 1e3:.2f} mm/s"
        reasons.append(Reason(Rule.GOVERNOR, Severity.REDUCE, detail))
    return Step(translation, rotation, travel, speed), tuple(reasons)


def _clipped(values: Vector3, box: Vector3) -> Vector3:
    x, y, z = (max(-b, min(b, v)) for v, b in zip(values, box, strict=True))
    return (x, y, z)
