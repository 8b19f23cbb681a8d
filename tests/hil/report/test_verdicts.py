"""What the supervisor did, counted by hand."""

import math
from collections.abc import Callable

import pytest

from controllers.messages import Reason, Rule, Severity, SkillPhase
from hil.summary import summarise
from tests.hil.report.runs import MS, RunWriter

SLOW = Reason(Rule.GOVERNOR, Severity.REDUCE, "2.00 mm/s, limit 5.00 mm/s")
CUT = Reason(Rule.STEP_BOX, Severity.REDUCE, "asked for (30.0, 0.0, 50.0) um")
LATE = Reason(Rule.HEARTBEAT, Severity.HOLD, "since the tick before 25.000 ms, limit 20.000 ms")
OVERLOAD = Reason(Rule.FORCE, Severity.STOP, "f_x = 70.3 mN, limit 70.0 mN")
OVERLOAD_Y = Reason(Rule.FORCE, Severity.STOP, "f_y = 100.3 mN, limit 100.0 mN")


def test_answers_are_counted_by_severity_and_by_rule(write_run: Callable[..., RunWriter]) -> None:
    run = write_run()
    run.phase(1, SkillPhase.INSERT)
    run.step(SLOW, CUT, speed_mm_s=2.0)
    run.step(SLOW, speed_mm_s=3.0)
    run.step(SLOW, LATE, is_sent=False, speed_mm_s=0.5)
    run.step(speed_mm_s=5.0)
    verdicts = summarise(run.close()).insertions[0].verdicts
    assert verdicts.proposals == 4
    assert verdicts.answers == {
        Severity.PASS: 1,
        Severity.REDUCE: 2,
        Severity.HOLD: 1,
        Severity.RETREAT: 0,
        Severity.STOP: 0,
    }
    assert verdicts.rules == {
        (Rule.GOVERNOR, Severity.REDUCE): 3,
        (Rule.STEP_BOX, Severity.REDUCE): 1,
        (Rule.HEARTBEAT, Severity.HOLD): 1,
    }
    assert verdicts.lowest_cap_m_s == pytest.approx(0.5e-3)


def test_the_hardest_verdict_on_a_step_counts_until_the_next_one(
    write_run: Callable[..., RunWriter],
) -> None:
    run = write_run()
    run.sample((0.0, 0.0, 0.0), 0.0)
    run.phase(1, SkillPhase.INSERT)
    run.step()
    run.sample((0.0, 0.0, 0.0), 10.0, SLOW, cap_mm_s=0.7)
    run.sample((0.0, 0.0, 0.0), 20.0)
    run.step(SLOW)
    run.sample((0.0, 0.0, 0.0), 30.0, OVERLOAD)
    run.phase(1, SkillPhase.FAILED, str(OVERLOAD))
    verdicts = summarise(run.close()).insertions[0].verdicts
    assert verdicts.hardest == {
        Severity.PASS: 0,
        Severity.REDUCE: 1,
        Severity.HOLD: 0,
        Severity.RETREAT: 0,
        Severity.STOP: 1,
    }
    assert verdicts.answers[Severity.STOP] == 0
    assert verdicts.lowest_cap_m_s == pytest.approx(0.7e-3)


def test_what_comes_after_an_insertion_does_not_count_for_it(
    write_run: Callable[..., RunWriter],
) -> None:
    run = write_run()
    run.phase(1, SkillPhase.INSERT)
    run.step()
    run.now_ns += MS
    run.phase(1, SkillPhase.DONE)
    run.sample((0.0, 0.0, 0.0), 20.0, OVERLOAD, cap_mm_s=0.1)
    run.step(SLOW)
    summary = summarise(run.close())
    inside, whole = summary.insertions[0].verdicts, summary.verdicts
    assert (inside.proposals, whole.proposals) == (1, 2)
    assert (inside.hardest[Severity.STOP], whole.hardest[Severity.STOP]) == (0, 1)
    assert inside.lowest_cap_m_s == pytest.approx(4e-3)
    assert inside.onsets == {}
    assert whole.lowest_cap_m_s == pytest.approx(0.1e-3)


def test_a_rule_that_stays_fired_began_once(write_run: Callable[..., RunWriter]) -> None:
    run = write_run()
    for reasons in ((), (LATE,), (LATE, SLOW), (SLOW,), (), (LATE,)):
        run.sample((0.0, 0.0, 0.0), 0.0, *reasons)
    assert summarise(run.close()).verdicts.onsets == {
        (Rule.HEARTBEAT, Severity.HOLD): 2,
        (Rule.GOVERNOR, Severity.REDUCE): 1,
    }


def test_stops_are_told_once_per_rule_and_anew_after_a_reset(
    write_run: Callable[..., RunWriter],
) -> None:
    run = write_run()
    run.sample((70.3, 0.0, 0.0), 0.0, OVERLOAD)
    first_ns = run.now_ns
    run.sample((70.3, 100.3, 0.0), 0.0, OVERLOAD, OVERLOAD_Y, LATE)
    run.reset("Zoë")
    run.sample((0.0, 0.0, 0.0), 0.0)
    run.sample((0.0, 100.3, 0.0), 0.0, OVERLOAD_Y)
    second_ns = run.now_ns
    stops = summarise(run.close()).stops
    assert [(stop.stamp_ns, stop.reason) for stop in stops] == [
        (first_ns, OVERLOAD),
        (second_ns, OVERLOAD_Y),
    ]


def test_loop_times_are_those_of_all_ticks(write_run: Callable[..., RunWriter]) -> None:
    run = write_run(busy_ns=400_000)
    for _ in range(25):
        run.sample((0.0, 0.0, 0.0), 0.0)
    run._busy_ns = 1_400_000
    for _ in range(25):
        run.sample((0.0, 0.0, 0.0), 0.0)
    timing = summarise(run.close()).timing
    assert timing.ticks == 50
    assert timing.mean_s == pytest.approx(0.9e-3)
    assert timing.max_s == pytest.approx(1.4e-3)
    assert timing.missed_deadlines == 25


def test_without_a_verdict_there_is_no_cap(write_run: Callable[..., RunWriter]) -> None:
    verdicts = summarise(write_run().close()).verdicts
    assert verdicts.lowest_cap_m_s == math.inf
    assert verdicts.proposals == 0
