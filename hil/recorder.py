"""Records a run to MCAP in ROS 2's message format, so that a killed process loses 100 ms at most.

Every message keeps its own stamp (header and MCAP publish time); MCAP's log time is when the host
heard of it. Nothing here reads a clock: the same calls make the same bytes.
"""

from statistics import fmean, median

from controllers.control_loop import Subscriber
from controllers.messages import (
    ContactBelief,
    FilterHealth,
    Observation,
    PhaseChange,
    Proposal,
    Reason,
    ResetRecord,
    Rule,
    Sent,
    Severity,
    Snapshot,
    Tick,
    Verdict,
)
from drivers.contract.messages import ForceSample, Wrench
from hil import ros_messages
from hil import ros_types as ros
from hil.log_file import LogFile, Pace, Topic
from hil.log_process import LogProcess
from hil.ros_messages import CELL, NS_PER_S, PART, ContactTruth, LoopTiming, RawForceEncoder

_ESTIMATE_EVERY_TICKS = 10
_STATE_PERIOD_NS = 10_000_000
_SUMMARY_PERIOD_NS = 100_000_000


class _TimingWindow:
    """Gathers the ticks of one window."""

    def __init__(self, deadline_ns: int) -> None:
        self._deadline_ns = deadline_ns
        self._start_ns = 0
        self._end_ns = 0
        self._durations_ns: list[int] = []

    def add(self, tick: Tick) -> LoopTiming | None:
        """Return the timing of the window that this tick ends, if it does."""
        if not self._durations_ns:
            self._start_ns = tick.start_ns
        self._end_ns = tick.end_ns
        self._durations_ns.append(tick.end_ns - tick.start_ns)
        return self.end() if self._end_ns - self._start_ns >= _SUMMARY_PERIOD_NS else None

    def end(self) -> LoopTiming | None:
        """Return the timing of the ticks since the last window, if there were any."""
        durations_ns, self._durations_ns = self._durations_ns, []
        if not durations_ns:
            return None
        return LoopTiming(
            stamp_ns=self._end_ns,
            window_s=(self._end_ns - self._start_ns) / NS_PER_S,
            ticks=len(durations_ns),
            mean_s=fmean(durations_ns) / NS_PER_S,
            median_s=median(durations_ns) / NS_PER_S,
            max_s=max(durations_ns) / NS_PER_S,
            deadline_s=self._deadline_ns / NS_PER_S,
            missed_deadlines=sum(duration > self._deadline_ns for duration in durations_ns),
        )


class Recorder(Subscriber):
    """Follows the control loop and writes down what happens; not for use by several threads."""

    def __init__(self, log: LogFile | LogProcess, deadline_ns: int = 1_000_000) -> None:
        """Record to `log`, which the recorder closes.

        A tick that takes longer than `deadline_ns` from sample to verdict counts as a missed
        deadline. Every method raises LogError where the log cannot be written; after that the
        recorder takes nothing more, and the file keeps what it has.
        """
        self._log = log
        self._raw_force = RawForceEncoder()
        self._timing = _TimingWindow(deadline_ns)
        self._stage_pace = Pace(_STATE_PERIOD_NS)
        self._arm_pace = Pace(_SUMMARY_PERIOD_NS)
        self._truth_pace = Pace(_STATE_PERIOD_NS)
        self._diagnostics_pace = Pace(_SUMMARY_PERIOD_NS)
        self._ticks = 0
        self._bias: Wrench | None = None
        self._stage_stamp_ns: int | None = None
        self._arm_stamp_ns: int | None = None
        self._estimate_stamp_ns: int | None = None
        self._health: FilterHealth | None = None
        self._reasons: tuple[Reason, ...] | None = None
        self._rules: frozenset[tuple[Rule, Severity]] | None = None
        self._condition: tuple[object, ...] = ()
        self._contact: tuple[str, str, int] | None = None

    def on_sample(self, sample: ForceSample) -> None:
        """Record every raw sample."""
        self._log.write(
            Topic.RAW_FORCE,
            self._raw_force.encode(sample),
            sample.stamp_ns,
            sample.receipt_ns,
            sample.sequence,
        )

    def on_tick(self, tick: Tick) -> None:
        """Record what has changed since the tick before, and the rest at its lower rate."""
        snapshot = tick.snapshot
        self._record_force(snapshot)
        self._record_motion(snapshot)
        self._record_verdict(tick.verdict)
        self._record_diagnostics(snapshot)
        timing = self._timing.add(tick)
        if timing is not None:
            self._write(Topic.LOOP_TIMING, ros_messages.loop_timing(timing), timing.stamp_ns)
        self._ticks += 1
        self._log.keep_pace(tick.end_ns)

    def on_belief(self, belief: ContactBelief) -> None:
        """Record what a controller believes."""
        self._write(Topic.BELIEF, ros_messages.belief(belief), belief.stamp_ns)

    def on_proposal(self, observation: Observation, proposal: Proposal) -> None:
        """Record what a controller knew and what it proposes."""
        self._write(Topic.OBSERVATION, ros_messages.observation(observation), observation.stamp_ns)
        self._write(Topic.PROPOSAL, ros_messages.proposal(proposal), proposal.stamp_ns)

    def on_sent(self, sent: Sent) -> None:
        """Record what the gate made of a proposal, with its verdict."""
        self._write(Topic.SENT, ros_messages.sent(sent), sent.stamp_ns)

    def on_phase(self, change: PhaseChange) -> None:
        """Record a phase, and flush: an insertion's end is on file before the cell goes on."""
        self._write(Topic.PHASE, ros_messages.phase_change(change), change.stamp_ns)
        self._log.flush()

    def on_reset(self, record: ResetRecord) -> None:
        """Record an operator's reset, and flush."""
        self._write(Topic.RESET, ros_messages.reset(record), record.stamp_ns)
        self._log.flush()

    def on_truth(self, truth: ContactTruth) -> None:
        """Record what a mock cell knows, at 100 Hz and whenever the kind of contact changes."""
        contact = (truth.state, truth.phase, truth.contacts)
        if self._truth_pace.due(truth.stamp_ns) or contact != self._contact:
            self._contact = contact
            self._write(Topic.CONTACT_STATE, ros_messages.contact_state(truth), truth.stamp_ns)

    def close(self, ending: str = "") -> None:
        """Finish the log; `ending` says why the run ended before its time, if it did.

        Does nothing once the log is closed or has failed.
        """
        if not self._log.usable:
            return
        timing = self._timing.end()
        if timing is not None:
            self._write(Topic.LOOP_TIMING, ros_messages.loop_timing(timing), timing.stamp_ns)
        self._log.close(ending)

    def _write(
        self, topic: Topic, message: ros.RosMessage, stamp_ns: int, heard_ns: int | None = None
    ) -> None:
        self._log.write(
            topic, ros.encode(message), stamp_ns, stamp_ns if heard_ns is None else heard_ns
        )

    def _record_force(self, snapshot: Snapshot) -> None:
        if snapshot.bias != self._bias:
            self._bias = snapshot.bias
            bias = ros_messages.wrench_stamped(snapshot.now_ns, snapshot.bias)
            self._write(Topic.FORCE_BIAS, bias, snapshot.now_ns)
        estimate = snapshot.estimate
        if estimate is None:
            return
        new = estimate.stamp_ns != self._estimate_stamp_ns
        if (new and self._ticks % _ESTIMATE_EVERY_TICKS == 0) or estimate.health != self._health:
            self._estimate_stamp_ns = estimate.stamp_ns
            self._health = estimate.health
            filtered = ros_messages.force_estimate(estimate)
            self._write(Topic.FORCE_ESTIMATE, filtered, estimate.stamp_ns, snapshot.now_ns)

    def _record_motion(self, snapshot: Snapshot) -> None:
        now_ns, stage, arm = snapshot.now_ns, snapshot.stage, snapshot.arm
        if (
            stage is not None
            and stage.stamp_ns != self._stage_stamp_ns
            and self._stage_pace.due(now_ns)
        ):
            self._stage_stamp_ns = stage.stamp_ns
            pose = ros_messages.pose_stamped(stage.stamp_ns, stage.pose, PART)
            self._write(Topic.STAGE_POSE, pose, stage.stamp_ns, now_ns)
            twist = ros_messages.twist_stamped(stage)
            self._write(Topic.STAGE_TWIST, twist, stage.stamp_ns, now_ns)
        if arm is not None and arm.stamp_ns != self._arm_stamp_ns and self._arm_pace.due(now_ns):
            self._arm_stamp_ns = arm.stamp_ns
            pose = ros_messages.pose_stamped(arm.stamp_ns, arm.pose, CELL)
            self._write(Topic.ARM_POSE, pose, arm.stamp_ns, now_ns)

    def _record_verdict(self, verdict: Verdict) -> None:
        if verdict.reasons == self._reasons:
            return
        self._reasons = verdict.reasons
        rules = frozenset((reason.rule, reason.severity) for reason in verdict.reasons)
        if rules != self._rules:
            self._rules = rules
            self._write(Topic.VERDICT, ros_messages.verdict(verdict), verdict.stamp_ns)

    def _record_diagnostics(self, snapshot: Snapshot) -> None:
        sample, estimate = snapshot.sample, snapshot.estimate
        stage, arm, gripper = snapshot.stage, snapshot.arm, snapshot.gripper
        condition = (
            sample and sample.status,
            estimate and estimate.health,
            stage and stage.moving,
            arm and arm.moving,
            gripper and gripper[1:],
        )
        if self._diagnostics_pace.due(snapshot.now_ns) or condition != self._condition:
            self._condition = condition
            message = ros_messages.diagnostics(snapshot)
            self._write(Topic.DIAGNOSTICS, message, snapshot.now_ns)
