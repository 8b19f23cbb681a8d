"""The gate: sole holder of the actuators. Nothing reaches them but through the supervisor.

A command rests on the snapshot that was watched last, and on no other command after it: each one
changes what the verdict on that snapshot was about.
"""

import math
from dataclasses import replace

from controllers.faults import Memory, finite
from controllers.governor import Travel
from controllers.limits import Limits
from controllers.messages import (
    ForceEstimate,
    Proposal,
    Reason,
    ResetRecord,
    Sent,
    Severity,
    Snapshot,
    Verdict,
)
from controllers.supervisor import RunningMove, displaced, judge, latch, watch
from drivers.contract.clock import Clock
from drivers.contract.errors import SafetyError
from drivers.contract.interfaces import Arm, Gripper, Stage
from drivers.contract.messages import ForceSample, Pose, Wrench


class Gate:
    """Holds stage, arm and gripper; `limits` and the arm's `hold_pose` do not change in a run."""

    def __init__(
        self, limits: Limits, hold_pose: Pose, stage: Stage, arm: Arm, gripper: Gripper
    ) -> None:
        self.limits = limits
        self._hold_pose = hold_pose
        self._stage = stage
        self._arm = arm
        self._gripper = gripper
        self._memory = Memory()
        self._running: RunningMove | None = None
        self._stage_sent_ns = 0
        self._arm_sent_ns = 0
        self._watched: tuple[Snapshot, Verdict] | None = None
        """What the next command may rest on; nothing once a command has been given."""

    @property
    def latched(self) -> tuple[Reason, ...]:
        """The stops that wait for an operator's reset."""
        return self._memory.latched

    def snapshot(
        self,
        clock: Clock,
        sample: ForceSample | None,
        bias: Wrench,
        estimate: ForceEstimate | None,
    ) -> Snapshot:
        """Return the force at hand together with the states of the devices, as of now.

        A state from before the last command counts as moving.
        """
        stage, arm, gripper = self._stage.state(), self._arm.state(), self._gripper.state()
        if stage.stamp_ns < self._stage_sent_ns:
            stage = stage._replace(moving=True)
        if arm.stamp_ns < self._arm_sent_ns:
            arm = arm._replace(moving=True)
        return Snapshot(clock.now_ns(), sample, bias, estimate, stage, arm, gripper)

    def watch(self, snapshot: Snapshot) -> Verdict:
        """Judge one tick; slow or halt what is moving if the verdict says so."""
        if snapshot.stage is not None and not snapshot.stage.moving:
            self._running = None
        running = self._running
        verdict, self._memory = watch(self.limits, self._hold_pose, self._memory, snapshot, running)
        self._watched = snapshot, verdict
        severity = verdict.severity
        leaving = verdict.lets_out and running is not None and running.leads_out
        if severity >= Severity.HOLD and not leaving:
            self._halt_what_moves(snapshot)
        elif running is not None and severity is Severity.REDUCE:
            self._running = replace(running, speed_m_s=verdict.speed_cap_m_s)
            self._stage.slow_to(*self._speeds(running.travel, verdict.speed_cap_m_s))
        return verdict

    def send_step(self, proposal: Proposal, snapshot: Snapshot, now_ns: int) -> Sent:
        """Judge a step proposed on the snapshot last watched, and send what is allowed of it.

        Sent or refused, the step uses the snapshot up: the next command needs a new one.
        """
        standing = self._standing(snapshot)
        self._watched = None
        verdict, step = judge(self.limits, self._hold_pose, standing, snapshot, proposal, now_ns)
        self._memory = latch(self._memory, verdict.reasons)
        if step is None or snapshot.stage is None:
            return Sent(now_ns, proposal.number, verdict, None)
        target = displaced(snapshot.stage.pose, step)
        if any((*step.translation, *step.rotation)):
            speeds = self._speeds(step.travel, step.speed_m_s)
            self._stage_sent_ns = now_ns
            self._stage_sent_ns = self._stage.move_to(target, *speeds).stamp_ns
            self._running = RunningMove(step.travel, step.leads_out, step.speed_m_s)
        return Sent(
            now_ns,
            proposal.number,
            verdict,
            target,
            step.translation,
            step.rotation,
            step.speed_m_s,
        )

    def send_arm(self, target: Pose, snapshot: Snapshot) -> None:
        """Move the arm; only while nothing moves and the stage is clear of the part.

        Raises SafetyError otherwise, or under any standing hold or stop.
        """
        if not finite(target.position, target.rotation):
            raise SafetyError(f"arm target {target} is not finite")
        self._demand_calm(snapshot)
        self._demand_clear(snapshot)
        self._watched = None
        self._arm_sent_ns = snapshot.now_ns
        self._arm.move_to(target, self.limits.arm_speed_m_s)

    def send_valve(self, is_open: bool, snapshot: Snapshot) -> None:
        """Open or close the vacuum valve; only while nothing moves.

        A part is picked only while the stage is clear of it, and may be let go at any depth. Raises
        SafetyError otherwise, or under any standing hold or stop.
        """
        self._demand_calm(snapshot)
        if is_open:
            self._demand_clear(snapshot)
        self._watched = None
        self._gripper.set_valve(is_open)

    def hold(self) -> None:
        """Halt stage and arm, whatever they do; the part stays held."""
        self._watched = None
        self._running = None
        try:
            self._stage.halt()
        finally:
            self._arm.halt()

    def reset(self, operator: str, now_ns: int) -> ResetRecord:
        """Clear the latched stops on an operator's word; a cause that persists latches again."""
        record = ResetRecord(now_ns, operator, self._memory.latched)
        self._memory = self._memory._replace(latched=())
        return record

    def _halt_what_moves(self, snapshot: Snapshot) -> None:
        if snapshot.stage is None or snapshot.stage.moving:
            self._running = None
            self._stage.halt()
        if snapshot.arm is None or snapshot.arm.moving:
            self._arm.halt()

    def _standing(self, snapshot: Snapshot) -> Verdict:
        """Return the verdict on `snapshot`; raises SafetyError if it may not be acted on."""
        if self._watched is None or self._watched[0] is not snapshot:
            raise SafetyError(
                f"the snapshot of {snapshot.now_ns} ns is not the last one watched, "
                "or a command has been given on it"
            )
        return self._watched[1]

    def _demand_calm(self, snapshot: Snapshot) -> None:
        standing = self._standing(snapshot)
        if standing.severity >= Severity.HOLD:
            raise SafetyError("; ".join(str(reason) for reason in standing.reasons))
        for device in (snapshot.stage, snapshot.arm):
            if device is None or device.moving:
                raise SafetyError(f"only while stage and arm are at rest, not with {device}")

    def _demand_clear(self, snapshot: Snapshot) -> None:
        depth_m = math.inf if snapshot.stage is None else snapshot.stage.pose.position[2]
        if depth_m > self.limits.clear_depth_m:
            raise SafetyError(
                f"only with the stage clear of the part: depth {depth_m * 1e6:.1f} um, "
                f"valid: at most {self.limits.clear_depth_m * 1e6:.1f} um"
            )

    def _speeds(self, travel: Travel, speed_m_s: float) -> tuple[float, float]:
        """Return linear [m/s] and angular [rad/s] speed of a move along `travel` at `speed_m_s`.

        Rounding lifts neither above what `speed_m_s` was derived from.
        """
        share = min(1.0, travel.linear_m / travel.length_m)
        turning = speed_m_s / travel.length_m * travel.angle_rad
        return speed_m_s * share, min(turning, self.limits.angular_speed_rad_s)
