"""From a log to the numbers of its run."""

import math
from bisect import bisect_right
from collections import Counter
from dataclasses import dataclass
from itertools import chain, pairwise

import numpy as np

from controllers.messages import Rule, Severity, SkillPhase, Verdict
from hil.log_reader import Log, Rows
from hil.summary.facts import run_facts
from hil.summary.steps import StepRecord, step_records
from hil.summary.values import (
    GENTLE_BAND_N,
    Forces,
    InsertionSummary,
    Load,
    Outcome,
    RunSummary,
    Stop,
    Timing,
    VerdictCounts,
)

_OUTCOMES = {SkillPhase.DONE: Outcome.DONE, SkillPhase.FAILED: Outcome.FAILED}


@dataclass(frozen=True, slots=True)
class _Watch:
    """What the supervisor said in a run."""

    steps: tuple[StepRecord, ...]
    verdicts: tuple[Verdict, ...]
    onsets: tuple[tuple[int, tuple[Rule, Severity]], ...]
    """When a rule began to fire [ns]."""


def summarise(log: Log) -> RunSummary:
    """Return the numbers of a run, whether its log was finished or cut off."""
    facts = run_facts(log.metadata)
    start_ns, end_ns = log_extent(log)
    watch = _watch(log)
    second_rim_m = facts.walls_m[1][0] if len(facts.walls_m) > 1 else math.inf
    insertions = tuple(
        _insertion(log, number, watch, second_rim_m, end_ns) for number in log.insertions
    )
    wrenches = [log.trace(number).wrench for number in log.insertions]
    lower_peaks_N = [i.lower_hole_peak_N for i in insertions if i.lower_hole_peak_N >= 0.0]
    return RunSummary(
        facts=facts,
        complete=log.complete,
        ending=log.ending,
        insertions=insertions,
        forces=_forces(np.concatenate(wrenches) if wrenches else np.empty((0, 6))),
        lower_hole_peak_N=max(lower_peaks_N, default=math.nan),
        duration_s=(end_ns - start_ns) * 1e-9,
        verdicts=_verdict_counts(watch, start_ns, end_ns),
        timing=_timing(log),
        stops=_stops(log),
    )


def log_extent(log: Log) -> tuple[int, int]:
    """Return the stamps of the first and the last record [ns]; zeros for an empty log."""
    stamps_ns = log.raw_force.stamps_ns[:1].tolist() + log.raw_force.stamps_ns[-1:].tolist()
    for records in (log.phases, log.verdicts, log.sent, log.timings):
        stamps_ns += [record.stamp_ns for record in (*records[:1], *records[-1:])]
    return (min(stamps_ns, default=0), max(stamps_ns, default=0))


def _insertion(
    log: Log, number: int, watch: _Watch, second_rim_m: float, log_end_ns: int
) -> InsertionSummary:
    changes = [change for change in log.phases if change.insertion == number]
    last = changes[-1]
    outcome = _OUTCOMES.get(last.phase, Outcome.NOT_FINISHED)
    start_ns = changes[0].stamp_ns
    end_ns = log_end_ns if outcome is Outcome.NOT_FINISHED else last.stamp_ns
    retracts_ns = [c.stamp_ns for c in changes if c.phase is SkillPhase.RETRACT]
    trace = log.trace(number)
    radial = np.hypot(trace.wrench[:, 0], trace.wrench[:, 1])
    lower = radial[(trace.depth_m >= second_rim_m) & np.isfinite(radial)]
    depths = trace.depth_m[np.isfinite(trace.depth_m)]
    return InsertionSummary(
        number=number,
        outcome=outcome,
        reason=last.reason,
        start_ns=start_ns,
        end_ns=end_ns,
        given_up_ns=retracts_ns[0] if retracts_ns else None,
        steps=_steps(log, number, log_end_ns),
        deepest_m=float(depths.max()) if depths.size else math.nan,
        forces=_forces(trace.wrench),
        lower_hole_peak_N=float(lower.max()) if lower.size else math.nan,
        verdicts=_verdict_counts(watch, start_ns, end_ns),
    )


def _steps(log: Log, number: int, log_end_ns: int) -> int:
    ends_ns = [*(change.stamp_ns for change in log.phases[1:]), log_end_ns + 1]
    return sum(
        change.stamp_ns <= sent.stamp_ns < end_ns and sent.target is not None
        for change, end_ns in zip(log.phases, ends_ns, strict=True)
        if change.insertion == number and change.phase is SkillPhase.INSERT
        for sent in log.sent
    )


def _forces(wrench: Rows) -> Forces | None:
    force = wrench[np.isfinite(wrench[:, :3]).all(axis=1), :3]
    if not force.size:
        return None
    radial = np.hypot(force[:, 0], force[:, 1])
    return Forces(
        samples=len(force),
        x=_load(np.abs(force[:, 0])),
        y=_load(np.abs(force[:, 1])),
        z=_load(force[:, 2]),
        radial=_load(radial),
        gentle_share=float(np.mean(radial <= GENTLE_BAND_N)),
    )


def _load(values_N: Rows) -> Load:
    median_N, p95_N = np.percentile(values_N, (50, 95))
    return Load(
        peak_N=float(values_N[np.argmax(np.abs(values_N))]),
        mean_N=float(np.mean(values_N)),
        median_N=float(median_N),
        p95_N=float(p95_N),
    )


def _watch(log: Log) -> _Watch:
    fired = [{(r.rule, r.severity) for r in verdict.reasons} for verdict in log.verdicts]
    onsets = tuple(
        (verdict.stamp_ns, key)
        for verdict, (before, now) in zip(log.verdicts, pairwise([set(), *fired]), strict=True)
        for key in now - before
    )
    return _Watch(step_records(log), log.verdicts, onsets)


def _verdict_counts(watch: _Watch, start_ns: int, end_ns: int) -> VerdictCounts:
    steps = [s for s in watch.steps if start_ns <= s.sent.stamp_ns <= end_ns]
    watched = [v for v in watch.verdicts if start_ns <= v.stamp_ns <= end_ns]
    answers = [step.sent.verdict for step in steps]
    of_answers = Counter(verdict.severity for verdict in answers)
    of_steps = Counter(step.hardest(until_ns=end_ns) for step in steps)
    return VerdictCounts(
        proposals=len(steps),
        answers={severity: of_answers[severity] for severity in Severity},
        hardest={severity: of_steps[severity] for severity in Severity},
        rules=Counter((r.rule, r.severity) for verdict in answers for r in verdict.reasons),
        onsets=Counter(key for stamp_ns, key in watch.onsets if start_ns <= stamp_ns <= end_ns),
        lowest_cap_m_s=min(
            (verdict.speed_cap_m_s for verdict in chain(answers, watched)), default=math.inf
        ),
    )


def _timing(log: Log) -> Timing:
    ticks = sum(timing.ticks for timing in log.timings)
    busy_s = sum(timing.mean_s * timing.ticks for timing in log.timings)
    return Timing(
        ticks=ticks,
        mean_s=busy_s / ticks if ticks else 0.0,
        max_s=max((timing.max_s for timing in log.timings), default=0.0),
        missed_deadlines=sum(timing.missed_deadlines for timing in log.timings),
    )


def _stops(log: Log) -> tuple[Stop, ...]:
    """Return the first stop of each rule, anew after each reset."""
    resets_ns = [reset.stamp_ns for reset in log.resets]
    stops = sorted(
        (
            Stop(verdict.stamp_ns, reason)
            for verdict in chain(log.verdicts, (sent.verdict for sent in log.sent))
            for reason in verdict.reasons
            if reason.severity is Severity.STOP
        ),
        key=lambda stop: stop.stamp_ns,
    )
    first: dict[tuple[Rule, int], Stop] = {}
    for stop in stops:
        key = (stop.reason.rule, bisect_right(resets_ns, stop.stamp_ns))
        first.setdefault(key, stop)
    return tuple(first.values())
