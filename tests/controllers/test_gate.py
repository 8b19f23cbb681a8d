"""The gate, the only way to an actuator: what commands rest on, and what ends them."""

import math
from collections.abc import Callable

import pytest

from controllers.messages import Rule, Severity, Snapshot
from drivers.contract.clock import ManualClock
from drivers.contract.errors import DeviceError, SafetyError
from drivers.contract.messages import Pose
from tests.controllers.builders import MS, NOW, Bench, arm, proposal, sample, stage
from tests.controllers.gate_commands import (
    OUT_AND_CALM,
    commands,
    halt,
    let_go,
    send,
    send_away,
    send_in,
    send_nan,
)

Send = Callable[[Bench, Snapshot], None]


def test_only_a_watched_snapshot_is_acted_on() -> None:
    bench = Bench()
    seen = bench.see()
    for unwatched in (seen._replace(now_ns=NOW + MS), seen._replace(stage=OUT_AND_CALM)):
        text = f"of {unwatched.now_ns} ns is not the last one watched"
        with pytest.raises(SafetyError, match=text):
            bench.gate.send_step(proposal(), unwatched, NOW + MS)
        with pytest.raises(SafetyError, match=text):
            bench.gate.send_arm(Pose(), unwatched)
        with pytest.raises(SafetyError, match=text):
            bench.gate.send_valve(False, unwatched)
    assert commands(bench) == []


@pytest.mark.parametrize("second", [send_in, send_away, let_go])
@pytest.mark.parametrize(
    ("first", "sent"), [(send_in, 1), (send_away, 1), (let_go, 1), (send_nan, 0), (halt, 0)]
)
def test_one_command_rests_on_one_snapshot(first: Send, sent: int, second: Send) -> None:
    """Neither arm nor valve while a step runs, and nothing at all after a stop or a halt."""
    bench = Bench()
    bench.stage.now = stage(-110e-6)
    seen = bench.see()
    first(bench, seen)
    assert len(commands(bench)) == sent
    with pytest.raises(SafetyError, match="a command has been given on it"):
        second(bench, seen)
    assert len(commands(bench)) == sent


def test_a_device_that_fails_uses_the_snapshot_up() -> None:
    """Whether it has taken the command nobody knows."""
    bench = Bench()
    bench.stage.now = OUT_AND_CALM

    def fail(*_: object) -> None:
        raise DeviceError("no answer")

    for device, name, send_again in (
        (bench.stage, "move_to", send_in),
        (bench.arm, "move_to", send_away),
        (bench.gripper, "set_valve", let_go),
    ):
        working = getattr(device, name)
        setattr(device, name, fail)
        seen = bench.see()
        with pytest.raises(DeviceError, match="no answer"):
            send_again(bench, seen)
        setattr(device, name, working)
        with pytest.raises(SafetyError, match="a command has been given on it"):
            send_again(bench, seen)
    assert commands(bench) == []


def test_a_broken_force_limit_halts_a_running_move_and_latches() -> None:
    bench = Bench()
    send(bench)
    bench.stage.now = stage(moving=True)
    bench.see(NOW + MS, (0.071, 0.0, 0.0))
    assert bench.stage.halts == 1
    bench.stage.now = stage()
    assert send(bench, now_ns=NOW + 2 * MS).target is None
    assert [reason.rule for reason in bench.gate.latched] == [Rule.FORCE]
    record = bench.gate.reset("A. Operator", NOW + 3 * MS)
    assert (record.operator, record.stamp_ns) == ("A. Operator", NOW + 3 * MS)
    assert [reason.rule for reason in record.cleared] == [Rule.FORCE]
    assert bench.gate.latched == ()
    assert send(bench, now_ns=NOW + 4 * MS).target is not None


def test_a_reset_does_not_hide_a_cause_that_persists() -> None:
    bench = Bench()
    bench.see(NOW, (0.071, 0.0, 0.0))
    bench.gate.reset("A. Operator", NOW)
    bench.see(NOW + MS, (0.071, 0.0, 0.0))
    assert [reason.rule for reason in bench.gate.latched] == [Rule.FORCE]


def test_a_proposal_that_is_no_number_latches() -> None:
    bench = Bench()
    assert send(bench, (math.nan, 0.0, 0.0)).target is None
    assert send(bench, now_ns=NOW + MS).target is None
    assert [reason.rule for reason in bench.gate.latched] == [Rule.NON_FINITE]


def test_a_hold_halts_stage_and_arm_but_only_what_moves() -> None:
    bench = Bench()
    bench.stage.now, bench.arm.now = stage(-300e-6, moving=True), arm()
    bench.see(NOW, (0.0, 0.0, math.inf))
    assert (bench.stage.halts, bench.arm.halts) == (1, 0)
    bench.stage.now, bench.arm.now = stage(-300e-6), arm(moving=True)
    bench.see(NOW + MS, (0.0, 0.0, math.inf))
    assert (bench.stage.halts, bench.arm.halts) == (1, 1)


def test_a_command_without_an_answer_makes_older_states_count_as_moving() -> None:
    bench = Bench()
    bench.stage.now = OUT_AND_CALM

    def fail(*_: object) -> None:
        raise DeviceError("no answer")

    bench.stage.move_to = bench.arm.move_to = fail  # type: ignore[assignment, method-assign]  # a fault
    for send_one in (send_in, send_away):
        seen = bench.see()
        with pytest.raises(DeviceError):
            send_one(bench, seen)
    bench.stage.now, bench.arm.now = stage(stamp_ns=NOW - 1), arm(stamp_ns=NOW - 1)
    seen = bench.gate.snapshot(ManualClock(NOW), None, (0.0,) * 6, None)
    assert seen.stage is not None
    assert seen.arm is not None
    assert (seen.stage.moving, seen.arm.moving) == (True, True)


def test_hold_halts_stage_and_arm_at_once_even_if_one_fails() -> None:
    bench = Bench()
    bench.gate.hold()
    assert (bench.stage.halts, bench.arm.halts) == (1, 1)

    def fail() -> None:
        raise OSError("no route")

    bench.stage.halt = fail  # type: ignore[method-assign]  # a fault
    with pytest.raises(OSError, match="no route"):
        bench.gate.hold()
    assert bench.arm.halts == 2


def test_before_the_first_watch_nothing_is_sent() -> None:
    bench = Bench()
    seen = bench.gate.snapshot(ManualClock(0), sample(), (0.0,) * 6, None)
    for send_first in (send_in, send_away, let_go):
        with pytest.raises(SafetyError, match="is not the last one watched"):
            send_first(bench, seen)
    assert commands(bench) == []


def test_without_a_state_the_device_is_halted() -> None:
    bench = Bench()
    seen = bench.see()
    verdict = bench.gate.watch(seen._replace(stage=None, arm=None))
    assert verdict.severity is Severity.HOLD
    assert (bench.stage.halts, bench.arm.halts) == (1, 1)


def test_what_was_never_moved_rests_at_any_stamp() -> None:
    bench = Bench()
    bench.stage.now, bench.arm.now = stage(stamp_ns=0), arm(stamp_ns=0)
    seen = bench.gate.snapshot(ManualClock(NOW), None, (0.0,) * 6, None)
    assert (seen.stage, seen.arm) == (stage(stamp_ns=0), arm(stamp_ns=0))
