"""The gate before arm and valve."""

import math

import pytest

from drivers.contract.clock import ManualClock
from drivers.contract.errors import SafetyError
from drivers.contract.messages import Pose, Vector3
from tests.controllers.builders import MS, NOW, Bench, arm, stage
from tests.controllers.gate_commands import OUT_AND_CALM, commands, overload, send, stale


def test_an_arm_state_older_than_the_command_counts_as_moving() -> None:
    bench = Bench()
    bench.stage.now = OUT_AND_CALM
    bench.gate.send_arm(Pose((0.1, 0.0, 0.0)), bench.see())
    stale = bench.arm.now._replace(stamp_ns=NOW - MS)
    bench.arm.now = stale
    assert bench.gate.snapshot(ManualClock(NOW), None, (0.0,) * 6, None).arm == stale._replace(
        moving=True
    )
    bench.arm.now = stale._replace(stamp_ns=NOW)
    assert bench.gate.snapshot(ManualClock(NOW), None, (0.0,) * 6, None).arm == bench.arm.now


def test_the_arm_moves_only_in_calm_and_clear() -> None:
    bench = Bench()
    bench.stage.now = OUT_AND_CALM
    bench.gate.send_arm(Pose((0.1, 0.0, 0.0)), bench.see())
    assert bench.arm.moves == [(Pose((0.1, 0.0, 0.0)), pytest.approx(0.05))]
    for state, there, text in (
        (stage(-99e-6), arm(), "depth -99.0 um, valid: at most -100.0 um"),
        (stage(-300e-6, moving=True), arm(), "only while stage and arm are at rest"),
        (OUT_AND_CALM, arm(moving=True), "only while stage and arm are at rest"),
    ):
        disturbed = Bench()
        disturbed.stage.now, disturbed.arm.now = state, there
        with pytest.raises(SafetyError, match=text):
            disturbed.gate.send_arm(Pose(), disturbed.see())
        assert commands(disturbed) == []
    for wrong in (Pose((math.nan, 0.0, 0.0)), Pose((0.0, 0.0, 0.0), (0.0, math.inf, 0.0))):
        with pytest.raises(SafetyError, match="not finite"):
            bench.gate.send_arm(wrong, bench.see())
    assert len(bench.arm.moves) == 1


def test_the_valve_opens_only_clear_of_the_part_and_closes_at_any_depth() -> None:
    bench = Bench()
    bench.stage.now = stage(3.2e-3)
    bench.gate.send_valve(False, bench.see())
    with pytest.raises(SafetyError, match=r"depth 3200\.0 um"):
        bench.gate.send_valve(True, bench.see())
    assert bench.gripper.valve == [False]
    bench = Bench()
    bench.stage.now = OUT_AND_CALM
    bench.gate.send_valve(True, bench.see())
    bench.stage.now = stage(-300e-6, moving=True)
    with pytest.raises(SafetyError, match="at rest"):
        bench.gate.send_valve(False, bench.see())
    assert bench.gripper.valve == [True]


@pytest.mark.parametrize("force", [(0.071, 0.0, 0.0), (math.nan, 0.0, 0.0)])
def test_under_a_stop_neither_arm_nor_valve_is_switched(force: Vector3) -> None:
    bench = Bench()
    bench.stage.now = OUT_AND_CALM
    seen = bench.see(NOW, force)
    with pytest.raises(SafetyError):
        bench.gate.send_arm(Pose(), seen)
    with pytest.raises(SafetyError):
        bench.gate.send_valve(True, seen)
    assert (bench.arm.moves, bench.gripper.valve) == ([], [])


def test_under_a_hold_or_a_retreat_neither_arm_nor_valve_is_switched() -> None:
    bench = Bench()
    bench.stage.now = OUT_AND_CALM
    seen = stale(bench, NOW)
    with pytest.raises(SafetyError, match="stale force sample: age of"):
        bench.gate.send_arm(Pose(), seen)
    with pytest.raises(SafetyError, match="stale force sample"):
        bench.gate.send_valve(True, seen)
    now = overload(bench, NOW + MS, 140)
    seen = bench.see(now, (0.060, 0.0, 0.0))
    with pytest.raises(SafetyError, match="impulse limit"):
        bench.gate.send_arm(Pose(), seen)
    with pytest.raises(SafetyError, match="impulse limit"):
        bench.gate.send_valve(False, seen)
    assert (bench.arm.moves, bench.gripper.valve) == ([], [])


def test_while_a_move_is_slowed_the_valve_waits_for_rest() -> None:
    bench = Bench()
    send(bench, (20e-6, 0.0, 0.0))
    bench.stage.now = stage(moving=True)
    seen = bench.see(NOW + MS, (0.020, 0.0, 0.0))
    assert len(bench.stage.slowed) == 1
    with pytest.raises(SafetyError, match="only while stage and arm are at rest"):
        bench.gate.send_valve(False, seen)


@pytest.mark.parametrize(
    ("depth_m", "clear"),
    [(-100.5e-6, True), (-100e-6, True), (math.nextafter(-100e-6, 0.0), False), (-99.5e-6, False)],
)
def test_the_clear_depth_itself_is_clear(depth_m: float, clear: bool) -> None:
    bench = Bench()
    bench.stage.now = stage(depth_m)
    seen = bench.see()
    if clear:
        bench.gate.send_valve(True, seen)
    else:
        with pytest.raises(SafetyError, match="only with the stage clear"):
            bench.gate.send_valve(True, seen)
    assert bench.gripper.valve == [True] * clear
