"""The control loop: sample, record, filter, watch; and a step carried out between two ticks.

The cell and the learning environment both run this loop, so they cannot drift apart.
"""

import math
from dataclasses import dataclass

from controllers.force_filter import ForceFilter
from controllers.gate import Gate
from controllers.governor import Travel
from controllers.insertion import REACHED_M, InsertionSkill
from controllers.limits import Limits
from controllers.messages import (
    ContactBelief,
    ForceEstimate,
    Move,
    Observation,
    PhaseChange,
    Proposal,
    ResetRecord,
    Sent,
    Severity,
    SkillPhase,
    Tick,
    Verdict,
)
from drivers.contract.clock import Clock
from drivers.contract.errors import DeviceError, DeviceTimeoutError
from drivers.contract.interfaces import ForceSensor
from drivers.contract.messages import ForceSample, Pose, StageState, Vector3

_SILENT_PERIODS = 3
_STEP_MARGIN_S = 5.0
"""For starting and braking, and for telemetry, on top of the time that a step takes at speed."""

_TICKS_BETWEEN_TRIES = 50
"""Under a hold a controller is asked again at most every so many samples."""
_WITHDRAW_REFUSALS = 20
"""So many refusals in a row end a withdrawal."""
_HOME_M, _HOME_RAD = 2e-7, 1e-5
"""So near the start, in clear air, a withdrawal ends: a stage need not be as repeatable there."""
_LAME_STEPS = 5
"""So many sent steps in a row without progress end the run: the stage does not follow."""
_PROGRESS = 0.1
"""A step has made progress once so much of its way is behind the stage."""


@dataclass(frozen=True, slots=True)
class Step:
    """What came of a proposal, once the stage has settled."""

    sent: Sent
    hardest: Verdict
    """The hardest verdict from the proposal to the settled end."""
    tick: Tick
    """The last tick; the next proposal is made on it."""


class Subscriber:
    """Follows the loop without a say in it; override what is of interest."""

    def on_sample(self, sample: ForceSample) -> None:
        """A raw sample has arrived; nothing else has looked at it yet."""

    def on_tick(self, tick: Tick) -> None:
        """A verdict on the cell's state has been carried out."""

    def on_belief(self, belief: ContactBelief) -> None:
        """A controller says what it believes; what it then proposes follows."""

    def on_proposal(self, observation: Observation, proposal: Proposal) -> None:
        """A controller has answered an observation."""

    def on_sent(self, sent: Sent) -> None:
        """The gate has answered a proposal."""

    def on_phase(self, change: PhaseChange) -> None:
        """An insertion has entered a phase."""

    def on_reset(self, record: ResetRecord) -> None:
        """An operator has cleared the latched stops."""


class ControlLoop:
    """Turns once per force sample. The first thing to see a sample are the subscribers."""

    def __init__(
        self,
        clock: Clock,
        sensor: ForceSensor,
        force_filter: ForceFilter,
        gate: Gate,
        settle_s: float,
    ) -> None:
        self._clock = clock
        self._sensor = sensor
        self._filter = force_filter
        self._gate = gate
        self._settle_s = settle_s
        self._subscribers: list[Subscriber] = []
        self._timeout_s = _SILENT_PERIODS / sensor.rate_Hz
        self._step_timeout_s = _longest_step_s(gate.limits) + settle_s + _STEP_MARGIN_S
        self._sample: ForceSample | None = None
        self._proposals = 0
        self._lame_steps = 0

    def follow(self, subscriber: Subscriber) -> None:
        """Let `subscriber` follow, after those before it."""
        self._subscribers.append(subscriber)

    def tick(self) -> Tick:
        """Take one sample, or wait three periods in vain, and watch over the cell once."""
        estimate: ForceEstimate | None
        try:
            sample = self._sensor.read(self._timeout_s)
        except DeviceTimeoutError:
            start_ns = self._clock.now_ns()
            estimate = self._filter.silence(start_ns)
        else:
            start_ns = self._clock.now_ns()
            for subscriber in self._subscribers:
                subscriber.on_sample(sample)
            self._sample = sample
            estimate = self._filter.update(sample)
        snapshot = self._gate.snapshot(self._clock, self._sample, self._filter.bias, estimate)
        verdict = self._gate.watch(snapshot)
        tick = Tick(snapshot, verdict, start_ns, self._clock.now_ns())
        for subscriber in self._subscribers:
            subscriber.on_tick(tick)
        return tick

    def wait(self, duration_s: float) -> Tick:
        """Turn until `duration_s` has passed; return the last tick."""
        end_ns = self._clock.now_ns() + round(duration_s * 1e9)
        tick = self.tick()
        while tick.end_ns < end_ns:
            tick = self.tick()
        return tick

    def tare(self, samples: int, clear_depth_m: float) -> None:
        """Take a new bias over so many samples; raises TareRefusedError near or in contact."""
        window = [self.tick() for _ in range(samples)]
        is_clear = all(
            t.snapshot.stage is not None and t.snapshot.stage.pose.position[2] <= clear_depth_m
            for t in window
        )
        fresh = {s.sequence: s for t in window if (s := t.snapshot.sample) is not None}
        self._filter.tare(list(fresh.values()), is_clear)

    def insert(self, skill: InsertionSkill, number: int, source: str) -> None:
        """Let `skill` lead insertion `number`, its steps signed by `source`, to done or failed."""
        tick = self.tick()
        origin = commanded = _stage(tick).pose
        phase: SkillPhase | None = None
        while True:
            tick, hardest = self._think(skill, tick, origin, commanded)
            if hardest.severity is Severity.STOP:
                skill.heed(hardest, was_sent=False)
            observation = observe(tick, skill.steps, origin, commanded)
            move = skill.next_step(observation)
            if skill.phase is not phase:
                phase = skill.phase
                change = PhaseChange(tick.start_ns, number, phase, skill.reason, skill.steps)
                for subscriber in self._subscribers:
                    subscriber.on_phase(change)
            if move is None:
                return
            belief = skill.believed(observation)
            if belief is not None:
                for subscriber in self._subscribers:
                    subscriber.on_belief(belief)
            step = self.step(tick, observation, move, source)
            skill.heed(_harder(hardest, step.hardest), was_sent=step.sent.target is not None)
            tick, commanded = step.tick, step.sent.target or commanded

    def withdraw(self, start: Pose) -> bool:
        """Lead the stage straight out to the depth of `start`, and there to `start` itself.

        Returns False if the supervisor does not let it.
        """
        tick = self.tick()
        origin = commanded = _stage(tick).pose
        refusals = 0
        while refusals <= _WITHDRAW_REFUSALS:
            observation = observe(tick, 0, origin, commanded)
            move = _way_back(observation.pose, start, self._gate.limits)
            if move is None:
                return True
            step = self.step(tick, observation, move, "withdraw")
            refusals = refusals + 1 if step.sent.target is None else 0
            tick, commanded = step.tick, step.sent.target or commanded
        return False

    def reset(self, operator: str) -> ResetRecord:
        """Clear the latched stops on an operator's word; a cause that persists latches again."""
        record = self._gate.reset(operator, self._clock.now_ns())
        for subscriber in self._subscribers:
            subscriber.on_reset(record)
        return record

    def step(self, tick: Tick, observation: Observation, move: Move, source: str) -> Step:
        """Propose a move on the newest tick, have it sent, and turn until the stage has settled.

        Raises DeviceTimeoutError if the stage does not come to rest, and DeviceError if it has not
        followed several steps in a row.
        """
        self._proposals += 1
        proposal = Proposal(observation.stamp_ns, self._proposals, source, *move)
        for subscriber in self._subscribers:
            subscriber.on_proposal(observation, proposal)
        sent = self._gate.send_step(proposal, tick.snapshot, self._clock.now_ns())
        for subscriber in self._subscribers:
            subscriber.on_sent(sent)
        if sent.target is None:
            return self._wait_out(sent)
        step = self._settle(sent)
        self._demand_progress(observation.pose, sent.target, step)
        return step

    def _think(
        self, skill: InsertionSkill, tick: Tick, origin: Pose, commanded: Pose
    ) -> tuple[Tick, Verdict]:
        """Turn after each piece of the skill's work on what `tick` shows, once per sample due.

        A cell that has stopped is not thought about. Returns the newest tick and the hardest
        verdict from `tick` on.
        """
        hardest = tick.verdict
        if hardest.severity is Severity.STOP:
            return tick, hardest
        for _ in skill.think(observe(tick, skill.steps, origin, commanded)):
            piece_s = (self._clock.now_ns() - tick.end_ns) * 1e-9
            for _ in range(1 + int(piece_s * self._sensor.rate_Hz)):
                tick = self.tick()
                hardest = _harder(hardest, tick.verdict)
        return tick, hardest

    def _demand_progress(self, start: Pose, target: Pose, step: Step) -> None:
        if target == start:
            return
        end = _stage(step.tick).pose
        has_moved = _comes_nearer(start.position, end.position, target.position)
        has_turned = _comes_nearer(start.rotation, end.rotation, target.rotation)
        self._lame_steps = 0 if has_moved or has_turned else self._lame_steps + 1
        if self._lame_steps >= _LAME_STEPS:
            reasons = "".join(f"; {reason}" for reason in step.hardest.reasons)
            raise DeviceError(f"the stage has not followed {_LAME_STEPS} steps in a row{reasons}")

    def _wait_out(self, sent: Sent) -> Step:
        """After a refusal, turn until the hold is over or it is time to try again."""
        hardest = sent.verdict
        for _ in range(_TICKS_BETWEEN_TRIES):
            tick = self.tick()
            hardest = _harder(hardest, tick.verdict)
            if tick.verdict.severity < Severity.HOLD:
                break
        return Step(sent, hardest, tick)

    def _settle(self, sent: Sent) -> Step:
        hardest = sent.verdict
        deadline_ns = sent.stamp_ns + round(self._step_timeout_s * 1e9)
        rest_ns: int | None = None
        while True:
            tick = self.tick()
            hardest = _harder(hardest, tick.verdict)
            if tick.snapshot.stage is None or tick.snapshot.stage.moving:
                rest_ns = None
            elif rest_ns is None:
                rest_ns = tick.start_ns
            if rest_ns is not None and tick.start_ns - rest_ns >= self._settle_s * 1e9:
                return Step(sent, hardest, tick)
            if tick.end_ns > deadline_ns:
                raise DeviceTimeoutError(
                    f"the stage has not come to rest within {self._step_timeout_s:.0f} s"
                )


def observe(tick: Tick, steps: int, origin: Pose, commanded: Pose) -> Observation:
    """Return what a controller may know after `tick`.

    `origin` is the pose at the start, `commanded` where the stage was last sent, or stands.

    Raises DeviceError where force or stage have not been heard yet.
    """
    estimate, pose = tick.snapshot.estimate, _stage(tick).pose
    if estimate is None:
        raise DeviceError("there is no force estimate yet")
    x, y, z = (p - o for p, o in zip(pose.position, origin.position, strict=True))
    return Observation(
        tick.start_ns, steps, estimate.wrench, estimate.std, pose, (x, y, z), commanded
    )


def _harder(verdict: Verdict, other: Verdict) -> Verdict:
    return other if other.severity > verdict.severity else verdict


def _way_back(pose: Pose, start: Pose, limits: Limits) -> Move | None:
    """Return the next move of a withdrawal to `start`; None once the stage is there."""
    left_m = pose.position[2] - start.position[2]
    if left_m > REACHED_M:
        return Move((0.0, 0.0, -min(limits.step_m[2], left_m)))
    (x, y, _), (to_x, to_y, _) = pose.position, start.position
    turns = [to - at for at, to in zip(pose.rotation, start.rotation, strict=True)]
    if math.hypot(to_x - x, to_y - y) <= _HOME_M and math.hypot(*turns) <= _HOME_RAD:
        return None
    across = [_within(d, box) for d, box in zip((to_x - x, to_y - y), limits.step_m, strict=False)]
    rx, ry, rz = (_within(turn, limits.rotation_step_rad) for turn in turns)
    return Move((across[0], across[1], 0.0), (rx, ry, rz))


def _within(value: float, bound: float) -> float:
    return max(-bound, min(bound, value))


def _comes_nearer(start: Vector3, end: Vector3, target: Vector3) -> bool:
    way = math.dist(start, target)
    return way > 0.0 and math.dist(end, target) <= (1.0 - _PROGRESS) * way


def _stage(tick: Tick) -> StageState:
    if tick.snapshot.stage is None:
        raise DeviceError("there is no stage state yet")
    return tick.snapshot.stage


def _longest_step_s(limits: Limits) -> float:
    """Return the time [s] of the longest step in the step box, at creep speed all the way."""
    turn = limits.rotation_step_rad
    travel = Travel.of(limits.step_m, (turn, turn, turn), limits.lever_m)
    slowest_m_s = min(limits.creep_speed_m_s, limits.speed_m_s)
    return travel.length_m / slowest_m_s + travel.angle_rad / limits.angular_speed_rad_s
