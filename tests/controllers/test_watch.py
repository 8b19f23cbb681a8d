"""The supervisor's verdict on the cell's state, and what it remembers of it."""

import math
from typing import Any

import pytest

from controllers.faults import Memory
from controllers.messages import Rule, Severity
from drivers.contract.messages import Pose
from tests.controllers.builders import MS, NOW, load, running, sample, snapshot, stage, up, watched


def test_a_cell_in_order_passes() -> None:
    verdict, memory = watched()
    assert verdict.reasons == ()
    assert verdict.severity is Severity.PASS
    assert memory.latched == ()


def test_a_stop_stays_until_it_is_cleared_and_keeps_its_first_cause() -> None:
    _, memory = watched(sample=sample((0.071, 0.0, 0.0)))
    verdict, memory = watched(memory, sample=sample((0.0, 0.101, 0.0)))
    assert verdict.severity is Severity.STOP
    assert [r.detail for r in memory.latched] == ["f_x = 71.0 mN, limit 70.0 mN"]
    verdict, memory = watched(memory)
    assert verdict.severity is Severity.STOP
    assert [r.rule for r in verdict.reasons] == [Rule.FORCE]
    assert len(memory.latched) == 1


def test_two_stops_of_one_tick_are_both_kept() -> None:
    _, memory = watched(sample=sample((0.071, 0.0, 0.0)), stage=stage(velocity=(0.006, 0.0, 0.0)))
    assert {r.rule for r in memory.latched} == {Rule.FORCE, Rule.SPEED}


def test_reasons_of_all_severities_are_told() -> None:
    verdict, _ = watched(sample=None, stage=stage(velocity=(0.006, 0.0, 0.0)))
    assert {r.rule for r in verdict.reasons} == {Rule.MISSING_DATA, Rule.SPEED}
    assert verdict.severity is Severity.STOP


def test_a_running_move_is_slowed_when_the_governor_says_so() -> None:
    """At 50 mN of 70 mN there are 1.25 um left across the hole: 0.5495 mm/s, with 10 % of play."""
    loaded: dict[str, Any] = {
        "memory": Memory(NOW - MS, load(NOW - MS, (0.050, 0.0, 0.0), 0.0, 0.0)),
        "sample": sample((0.050, 0.0, 0.0)),
    }
    verdict, _ = watched(running=running(0.612e-3), **loaded)
    assert verdict.speed_cap_m_s == pytest.approx(0.5495e-3, abs=0.0005e-3)
    assert [r.rule for r in verdict.reasons] == [Rule.GOVERNOR]
    assert verdict.severity is Severity.REDUCE
    verdict, _ = watched(running=running(0.609e-3), **loaded)
    assert verdict.severity is Severity.PASS


def test_without_a_running_move_there_is_no_cap() -> None:
    verdict, _ = watched(sample=sample((0.050, 0.0, 0.0)))
    assert verdict.speed_cap_m_s == math.inf


def test_the_governor_creeps_when_the_load_is_unknown() -> None:
    verdict, _ = watched(running=running(1e-3), sample=None)
    assert verdict.speed_cap_m_s == pytest.approx(0.1e-3)
    verdict, _ = watched(running=running(1e-3), estimate=None)
    assert verdict.speed_cap_m_s == pytest.approx(0.1e-3)


def test_memory_keeps_the_load_when_a_sample_is_missing() -> None:
    _, memory = watched(sample=sample((0.010, 0.0, 0.0)))
    _, later = watched(memory, sample=None)
    assert later.load == memory.load
    assert snapshot().now_ns == later.now_ns


def test_what_is_told_is_exact() -> None:
    """Rule, severity and text of each reason, with value and limit in people's units."""
    turned = Pose((0.0, 0.0, 0.0), (0.0, math.radians(0.7), 0.0))
    cases: list[tuple[dict[str, Any], str, Severity]] = [
        (
            {"memory": Memory(NOW - 21 * MS)},
            "late tick: since the tick before 21.000 ms, limit 20.000 ms",
            Severity.HOLD,
        ),
        (
            {"memory": Memory(NOW - MS, load(NOW, (0.0, 0.0, 0.0), 0.0, 0.011))},
            "impulse limit: 11.00 mN s, limit 10.00 mN s",
            Severity.RETREAT,
        ),
        (
            {"stage": stage(angular_velocity=(0.0, 0.0, math.radians(1.1)))},
            "speed limit: stage at 1.100 deg/s, limit 1.000 deg/s",
            Severity.STOP,
        ),
        (
            {"stage": stage(velocity=(0.0, 0.006, 0.0))},
            "speed limit: stage at 6.00 mm/s, limit 5.00 mm/s",
            Severity.STOP,
        ),
        (
            {"stage": stage(pose=turned)},
            "workspace: tilt 0.700 deg, limit 0.600 deg",
            Severity.STOP,
        ),
    ]
    for changes, text, severity in cases:
        verdict, _ = watched(**changes)
        assert [(str(r), r.severity) for r in verdict.reasons] == [(text, severity)]


def test_a_stop_is_told_once() -> None:
    verdict, _ = watched(sample=sample((0.071, 0.0, 0.0)))
    assert [r.rule for r in verdict.reasons] == [Rule.FORCE]


def test_a_cap_at_nine_tenths_of_the_speed_is_play() -> None:
    """The creep speed of 0.1 mm/s is exactly nine tenths of 0.111... mm/s."""
    at_limit = 1e-4 / 0.9
    verdict, _ = watched(running=running(at_limit), estimate=None)
    assert Rule.GOVERNOR not in {r.rule for r in verdict.reasons}
    verdict, _ = watched(running=running(up(up(at_limit))), estimate=None)
    assert Rule.GOVERNOR in {r.rule for r in verdict.reasons}


def test_the_last_place_of_the_stage_outlasts_a_missing_state() -> None:
    _, memory = watched(Memory(NOW - MS, stage=stage(stamp_ns=NOW - MS)), stage=None)
    assert memory.stage == stage(stamp_ns=NOW - MS)
