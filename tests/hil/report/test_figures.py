"""What the figures say: limits and walls named, the end of a failure marked."""

from collections.abc import Callable
from pathlib import Path

import pytest

from controllers.messages import Reason, Rule, Severity, SkillPhase
from tests.hil.report.page import report
from tests.hil.report.runs import MS, RunWriter

pytestmark = pytest.mark.slow

OVERLOAD = Reason(Rule.FORCE, Severity.STOP, "f_x = 70.3 mN, limit 70.0 mN")


def test_the_median_and_the_worst_insertion_are_shown(
    write_run: Callable[..., RunWriter], tmp_path: Path
) -> None:
    run = write_run(asked=4)
    for number, radial_mN in enumerate((30.0, 10.0, 50.0, 20.0, 40.0), start=1):
        run.insertion(number, radial_mN)
    text = report(run.close(), tmp_path).figure("Force along x, y and z")
    assert "Insertion 1: median peak, 30.0 mN" in text
    assert "Insertion 3: largest peak, 50.0 mN" in text
    assert text.count("upper hole") == text.count("lower hole") == 2
    for label in ("f_x (mN)", "f_y (mN)", "f_z (mN)", "depth (mm)", "contact"):
        assert label in text


def test_a_limit_is_drawn_where_it_lies_within_the_view(
    write_run: Callable[..., RunWriter], tmp_path: Path
) -> None:
    drawn = {}
    for radial_mN in (60.0, 75.0, -75.0):
        run = write_run()
        run.insertion(1, radial_mN)
        drawn[radial_mN] = report(run.close(), tmp_path).figure("Force along x, y and z")
    assert "limit" not in drawn[60.0]
    assert "limit 70 mN" in drawn[75.0]
    assert "limit -70 mN" not in drawn[75.0]
    assert "limit -70 mN" in drawn[-75.0]


def test_contact_states_are_lettered_and_missing_ones_are_said_to_be(
    write_run: Callable[..., RunWriter], tmp_path: Path
) -> None:
    with_truth = write_run()
    with_truth.insertion(1)
    without = write_run()
    without.phase(1, SkillPhase.INSERT)
    without.sample((1.0, 0.0, 0.0), 100.0)
    seen = report(with_truth.close(), tmp_path)
    unseen = report(without.close(), tmp_path)
    assert " c " in seen.figure("Force along x, y and z")
    assert "not known on a rig" in unseen.figure("Force along x, y and z")
    assert "which only a mock cell knows" in seen.text
    assert "which only a mock cell knows" not in unseen.text


def test_the_share_within_the_gentle_band_is_printed(
    write_run: Callable[..., RunWriter], tmp_path: Path
) -> None:
    run = write_run()
    run.phase(1, SkillPhase.INSERT)
    for radial_mN in (1.0, 2.0, 3.0, 90.0):
        run.sample((radial_mN, 0.0, 0.0), 100.0)
    text = report(run.close(), tmp_path).figure("How often each force occurs")
    assert "75.00 % within 0 to 44 mN" in text
    assert "peak 90.0 mN" in text


def test_the_stop_is_marked_in_the_figure_of_the_failure(
    write_run: Callable[..., RunWriter], tmp_path: Path
) -> None:
    run = write_run(asked=3, controller="p")
    run.insertion(1)
    run.sample((0.0, 0.0, 0.0), -300.0)
    run.phase(2, SkillPhase.APPROACH)
    for number, force_mN in enumerate((0.0, 40.0, -60.0, 70.3)):
        run.sample((force_mN, 0.0, 0.0), 20.0, *((OVERLOAD,) if number == 3 else ()))
        if number == 0:
            run.phase(2, SkillPhase.INSERT)
        if number < 3:
            run.step()
    run.phase(2, SkillPhase.FAILED, str(OVERLOAD))
    run.sample((70.3, 0.0, 0.0), 20.0, OVERLOAD)
    page = report(run.close(), tmp_path)
    text = page.figure("Force, steps and depth of one insertion")
    assert text.count("STOP (force limit)") == 2
    assert text.count("limit 70 mN") == 2
    assert "time since insertion 2 began (s)" in text
    assert "step sent (um)" in text
    assert "stop (1)" in page.figure("Speed and verdict of every step")
    assert page.headings[0] == "What went wrong"
    assert page.banner[0].startswith(
        "The safety supervisor stopped the cell 0.04 s into insertion 2"
    )


def test_giving_up_and_the_end_of_the_log_are_marked_too(
    write_run: Callable[..., RunWriter], tmp_path: Path
) -> None:
    run = write_run()
    run.sample((0.0, 0.0, 0.0), 0.0)
    run.phase(1, SkillPhase.INSERT)
    run.sample((0.0, 0.0, 900.0), 100.0)
    run.phase(1, SkillPhase.RETRACT, "blocked at 100 um: axial force 900 mN")
    run.sample((0.0, 0.0, 0.0), 0.0)
    run.now_ns += MS
    text = report(run.close(), tmp_path).figure("Force, steps and depth of one insertion")
    assert "given up, led out" in text
    assert "end of the log" in text
    assert "STOP" not in text


def test_every_kind_of_verdict_is_in_the_speed_figure(
    write_run: Callable[..., RunWriter], tmp_path: Path
) -> None:
    run = write_run()
    run.sample((0.0, 0.0, 0.0), 0.0)
    run.phase(1, SkillPhase.INSERT)
    for severity in Severity:
        reasons = () if severity is Severity.PASS else (Reason(Rule.FORCE, severity, "x"),)
        run.sample((0.0, 0.0, 0.0), 100.0 * severity)
        run.step(*reasons, is_sent=severity < Severity.HOLD)
    text = report(run.close(), tmp_path).figure("Speed and verdict of every step")
    for label in ("passed (1)", "reduced (1)", "held (1)", "retreat (1)", "stop (1)"):
        assert label in text
    assert "limit 5 mm/s" in text


def test_loop_times_are_drawn_unless_time_was_simulated(
    write_run: Callable[..., RunWriter], tmp_path: Path
) -> None:
    real, simulated = write_run(busy_ns=1_400_000, time="real"), write_run()
    for run in (real, simulated):
        run.insertion(1)
    timed = report(real.close(), tmp_path)
    assert "sample to verdict (ms)" in timed.figure("Time from sample to verdict")
    assert "1.400 ms at most; deadline missed 8 times" in timed.text
    assert (
        "simulated time, in which a tick takes no time" in report(simulated.close(), tmp_path).text
    )


def test_two_runs_are_shown_beside_each_other(
    write_run: Callable[..., RunWriter], tmp_path: Path
) -> None:
    logs = []
    for controller, radial_mN in (("expert", 10.0), ("p", 60.0)):
        run = write_run(controller=controller)
        run.insertion(1, radial_mN)
        logs.append(run.close())
    page = report(logs[0], tmp_path, compared_with=logs[1])
    text = page.figure("Range of the force over depth")
    assert "expert: median" in text
    assert "p: median" in text
    assert "p: median" not in report(logs[0], tmp_path).figure("Range of the force over depth")
