"""How insertions and runs end, and what is said of it."""

import math
from collections.abc import Callable

import pytest

from controllers.messages import Reason, Rule, Severity, SkillPhase
from hil.log_reader import read_log
from hil.summary import Outcome, summarise
from hil.summary.values import wilson_interval
from hil.summary.words import early_end, tally
from tests.hil.report.runs import MS, PART, RunWriter

OVERLOAD = Reason(Rule.FORCE, Severity.STOP, "f_x = 70.3 mN, limit 70.0 mN")


@pytest.mark.parametrize(
    ("successes", "trials", "low", "high"),
    [  # Newcombe, Statistics in Medicine 17 (1998), p. 857, table I, method 3
        (81, 263, 0.2553, 0.3662),
        (15, 148, 0.0624, 0.1605),
        (0, 20, 0.0000, 0.1611),
        (1, 29, 0.0061, 0.1718),
    ],
)
def test_the_interval_is_wilsons(successes: int, trials: int, low: float, high: float) -> None:
    assert wilson_interval(successes, trials) == pytest.approx((low, high), abs=5e-5)
    mirrored = wilson_interval(trials - successes, trials)
    assert mirrored == pytest.approx((1.0 - high, 1.0 - low), abs=5e-5)


def test_without_a_trial_any_rate_is_possible() -> None:
    assert wilson_interval(0, 0) == (0.0, 1.0)


def test_a_whole_run(write_run: Callable[..., RunWriter]) -> None:
    run = write_run(asked=2)
    run.insertion(1)
    run.insertion(2)
    summary = summarise(run.close())
    first, second = summary.insertions
    assert (first.number, second.number) == (1, 2)
    assert first.outcome is Outcome.DONE
    assert first.reason == ""
    assert first.steps == 5
    assert first.duration_s == pytest.approx(0.076)  # 7 samples of 10 ms, 6 answers of 1 ms
    assert summary.steps_mean == 5.0
    assert summary.steps_max == 5
    assert summary.duration_s == pytest.approx(2 * 0.086 - 0.010)
    assert summary.success_interval == pytest.approx((0.3424, 1.0), abs=5e-5)
    assert tally(summary) == "2 of 2 inserted (100.0 %; 95 % interval 34.2 to 100.0 %)"
    assert early_end(summary) == ()


@pytest.mark.parametrize("name", ["on", "0123", "1_000", "1:30", "2026-01-02"])
def test_a_part_is_read_as_the_run_read_it(name: str, write_run: Callable[..., RunWriter]) -> None:
    facts = summarise(write_run(part=PART.replace("two_walls", name)).close()).facts
    assert facts.part == name
    assert len(facts.walls_m) == 2


def test_the_facts_are_those_of_the_metadata(write_run: Callable[..., RunWriter]) -> None:
    facts = summarise(write_run(asked=3, controller="p", time="real").close()).facts
    assert (facts.part, facts.controller, facts.seed, facts.asked) == ("two_walls", "p", 7, 3)
    assert facts.simulated_time is False
    assert facts.walls_m == (
        (0.0, pytest.approx(0.5e-3)),
        (pytest.approx(2e-3), pytest.approx(2.5e-3)),
    )
    assert facts.limits is not None
    assert facts.limits.force_N == (0.07, 0.1, 1.0)


def test_a_refused_proposal_is_no_step(write_run: Callable[..., RunWriter]) -> None:
    run = write_run()
    run.step()
    run.now_ns += MS
    run.phase(1, SkillPhase.INSERT)
    run.step()
    run.step(is_sent=False)
    run.step()
    run.now_ns += MS
    run.phase(1, SkillPhase.DONE)
    run.step()
    assert summarise(run.close()).insertions[0].steps == 2


def test_a_failed_insertion_keeps_its_reason(write_run: Callable[..., RunWriter]) -> None:
    run = write_run(asked=2)
    run.phase(1, SkillPhase.APPROACH)
    run.sample((0.0, 0.0, 16.0), -20.0)
    run.phase(1, SkillPhase.RETRACT, "contact in the approach: 16.0 mN")
    run.now_ns += 20 * MS
    run.phase(1, SkillPhase.FAILED, "contact in the approach: 16.0 mN")
    run.insertion(2)
    summary = summarise(run.close())
    failed = summary.insertions[0]
    assert failed.outcome is Outcome.FAILED
    assert failed.reason == "contact in the approach: 16.0 mN"
    assert failed.forces is None
    assert failed.steps == 0
    assert math.isnan(failed.deepest_m)
    assert failed.given_up_ns == failed.end_ns - 20 * MS
    assert summary.count(Outcome.DONE) == 1
    assert early_end(summary) == ()


def test_a_run_that_a_failure_ends_says_so(write_run: Callable[..., RunWriter]) -> None:
    run = write_run(asked=5)
    run.insertion(1, end=SkillPhase.FAILED)
    assert early_end(summarise(run.close())) == (
        "The run ended with insertion 1, which failed: it did not fit.",
        "1 of the 5 insertions asked for were begun.",
    )


def test_a_run_that_was_ended_says_why_in_its_own_words(
    write_run: Callable[..., RunWriter],
) -> None:
    run = write_run(asked=2)
    run.insertion(1)
    assert early_end(summarise(run.close("Somebody pulled the plug."))) == (
        "Somebody pulled the plug.",
        "1 of the 2 insertions asked for were begun.",
    )


def test_a_run_that_ends_without_a_cause_says_so(write_run: Callable[..., RunWriter]) -> None:
    run = write_run(asked=2)
    run.insertion(1)
    assert early_end(summarise(run.close())) == (
        "The log does not say why the run ended.",
        "1 of the 2 insertions asked for were begun.",
    )


def test_an_insertion_without_an_end_is_not_finished(write_run: Callable[..., RunWriter]) -> None:
    run = write_run(asked=2)
    run.insertion(1)
    run.phase(2, SkillPhase.APPROACH)
    run.sample((0.0, 0.0, 0.0), 0.0)
    run.phase(2, SkillPhase.INSERT)
    run.sample((9.0, 0.0, 0.0), 100.0)
    summary = summarise(run.close())
    last = summary.insertions[1]
    assert last.outcome is Outcome.NOT_FINISHED
    assert last.duration_s == pytest.approx(0.020)
    assert summary.count(Outcome.DONE) == 1
    assert summary.success_interval == pytest.approx((0.0945, 0.9055), abs=5e-5)
    assert early_end(summary) == ("The run ended in the middle of insertion 2.",)


def test_a_log_that_is_cut_off_never_counts_as_a_success(
    write_run: Callable[..., RunWriter],
) -> None:
    run = write_run(asked=1)
    run.insertion(1)
    whole = run.close()
    done_at = run.path.read_bytes().rindex(b"done")
    cut = run.path.with_name("cut.mcap")
    cut.write_bytes(run.path.read_bytes()[:done_at])
    summary = summarise(read_log(cut))
    assert whole.complete
    assert summary.complete is False
    assert summary.insertions[0].outcome is Outcome.NOT_FINISHED
    assert summary.count(Outcome.DONE) == 0
    assert [sentence[:21] for sentence in early_end(summary)] == ["The log is not whole:"]


def test_a_stop_is_told_in_plain_words(write_run: Callable[..., RunWriter]) -> None:
    run = write_run(asked=3)
    run.sample((0.0, 0.0, 0.0), 0.0)
    run.phase(1, SkillPhase.APPROACH)
    run.phase(1, SkillPhase.INSERT)
    run.step()
    for _ in range(2):
        run.sample((70.3, 0.0, 0.0), 50.0, OVERLOAD)
    run.phase(1, SkillPhase.FAILED, str(OVERLOAD))
    summary = summarise(run.close())
    assert [stop.reason for stop in summary.stops] == [OVERLOAD]
    assert early_end(summary) == (
        "The safety supervisor stopped the cell 0.01 s into insertion 1: a force on the part "
        "exceeded its limit (f_x = 70.3 mN, limit 70.0 mN).",
        "1 of the 3 insertions asked for were begun.",
    )


def test_an_empty_log_has_no_insertion(write_run: Callable[..., RunWriter]) -> None:
    summary = summarise(write_run().close())
    assert summary.insertions == ()
    assert summary.forces is None
    assert summary.duration_s == 0.0
    assert math.isnan(summary.steps_mean)
    assert summary.steps_max == 0
    assert tally(summary) == "No insertion was begun"


@pytest.mark.parametrize(
    "about",
    [
        {},
        {"run": {"controller": "p"}, "part": {"text": "{"}, "limits": {"in_force": "[]"}},
        {"part": {"text": "name: a\nholes: 3"}, "limits": {}},
    ],
)
def test_metadata_that_cannot_be_read_are_left_out(
    tmp_path_factory: pytest.TempPathFactory, about: dict[str, dict[str, str]]
) -> None:
    run = RunWriter(tmp_path_factory.mktemp("facts") / "run.mcap", about)
    run.insertion(1)
    summary = summarise(run.close())
    assert summary.facts.part == ""
    assert summary.facts.walls_m == ()
    assert summary.facts.asked is None
    assert summary.facts.limits is None
    assert summary.count(Outcome.DONE) == 1
