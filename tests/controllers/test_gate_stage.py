"""The gate before the stage: steps sent, slowed and halted."""

import math

import numpy as np
import pytest

from controllers.messages import Rule, Severity
from drivers.contract.clock import ManualClock
from tests.controllers.builders import MS, NOW, Bench, gripper, proposal, rules, stage
from tests.controllers.gate_commands import overload, send, stale


def test_a_step_is_sent_and_what_was_sent_is_returned() -> None:
    bench = Bench()
    sent = send(bench, (30e-6, 0.0, 60e-6))
    assert sent.translation == pytest.approx((20e-6, 0.0, 60e-6))
    assert sent.target is not None
    assert sent.target.position == pytest.approx((20e-6, 0.0, 1.06e-3))
    (move,) = bench.stage.moves
    assert move[0] == sent.target
    assert move[1] == pytest.approx(sent.speed_m_s)
    assert move[2] == 0.0


def test_a_refused_step_leaves_the_stage_alone() -> None:
    bench = Bench()
    bench.gripper.now = gripper(part_held=False)
    bench.stage.now = stage(-120e-6)
    sent = send(bench)
    assert sent.target is None
    assert sent.verdict.severity is Severity.HOLD
    assert bench.stage.moves == []


def test_a_step_of_nothing_is_not_sent() -> None:
    bench = Bench()
    sent = send(bench, (0.0, 0.0, 0.0))
    assert sent.target == bench.stage.now.pose
    assert bench.stage.moves == []


def test_a_growing_force_slows_the_running_move() -> None:
    bench = Bench()
    sent = send(bench, (20e-6, 0.0, 0.0))
    bench.stage.now = stage(moving=True)
    bench.see(NOW + MS, (0.020, 0.0, 0.0))
    (slowed,) = bench.stage.slowed
    assert 0.0 < slowed[0] < sent.speed_m_s
    bench.see(NOW + 2 * MS, (0.010, 0.0, 0.0))
    assert len(bench.stage.slowed) == 1, "a move is never sped up"
    bench.see(NOW + 3 * MS, (0.040, 0.0, 0.0))
    assert bench.stage.slowed[1][0] < slowed[0]
    assert bench.stage.halts == 0


def test_a_stage_state_older_than_the_command_counts_as_moving() -> None:
    bench = Bench()
    send(bench)
    stale = bench.stage.now._replace(stamp_ns=NOW - MS)
    bench.stage.now = stale
    seen = bench.gate.snapshot(ManualClock(NOW), None, (0.0,) * 6, None)
    assert seen.stage == stale._replace(moving=True)
    bench.stage.now = stale._replace(stamp_ns=NOW)
    seen = bench.gate.snapshot(ManualClock(NOW), None, (0.0,) * 6, None)
    assert seen.stage == bench.stage.now


@pytest.mark.parametrize("by_hand", [False, True])
def test_after_a_halt_a_stage_state_older_than_the_command_still_counts_as_moving(
    by_hand: bool,
) -> None:
    """Telemetry lags: what says that the stage rests is from before it was sent away."""
    bench = Bench()
    send(bench)
    lagging = bench.stage.now._replace(stamp_ns=NOW - 5 * MS)
    if by_hand:
        bench.gate.hold()
    else:
        bench.stage.now = stage(moving=True)
        stale(bench, NOW + MS)
    bench.stage.now = lagging
    for ms in range(2, 5):
        seen = bench.look(NOW + ms * MS)
        assert seen.stage == lagging._replace(moving=True)
        wish = proposal(stamp_ns=seen.now_ns)
        assert Rule.BUSY in rules(bench.gate.send_step(wish, seen, seen.now_ns).verdict)
    bench.stage.now = stage(stamp_ns=NOW)
    assert bench.look(NOW + 5 * MS).stage == stage(stamp_ns=NOW)


def test_a_finished_move_is_no_longer_slowed() -> None:
    bench = Bench()
    send(bench, (20e-6, 0.0, 0.0))
    bench.see(NOW + MS, (0.020, 0.0, 0.0))
    assert bench.stage.slowed == []


def test_a_retreat_lets_the_way_out_run_and_halts_everything_else() -> None:
    bench = Bench()
    now = overload(bench, NOW, 140)
    sent = bench.gate.send_step(
        proposal((0.0, 0.0, -60e-6), stamp_ns=now), bench.see(now, (0.060, 0.0, 0.0)), now
    )
    assert sent.target is not None
    assert sent.verdict.severity is Severity.RETREAT
    bench.stage.now = stage(moving=True)
    bench.see(now + MS, (0.060, 0.0, 0.0))
    assert bench.stage.halts == 0

    for not_out in ((1e-6, 0.0, 0.0), (20e-6, 0.0, -19e-6)):
        bench = Bench()
        now = overload(bench, NOW, 120)
        seen = bench.see(now, (0.060, 0.0, 0.0))
        assert bench.gate.send_step(proposal(not_out, stamp_ns=now), seen, now).target
        bench.stage.now = stage(moving=True)
        overload(bench, now + 5 * MS, 20)
        assert bench.stage.halts > 0


def test_a_hold_beside_a_retreat_halts_the_way_out() -> None:
    """Old force samples: even the way out would be blind."""
    bench = Bench()
    now = overload(bench, NOW, 140)
    out = proposal((0.0, 0.0, -60e-6), stamp_ns=now)
    seen = bench.see(now, (0.060, 0.0, 0.0))
    assert bench.gate.send_step(out, seen, now).target is not None
    bench.stage.now = stage(moving=True)
    old = seen._replace(now_ns=now + 6 * MS, stage=stage(stamp_ns=now + 6 * MS, moving=True))
    verdict = bench.gate.watch(old)
    assert {r.severity for r in verdict.reasons} == {Severity.HOLD, Severity.RETREAT}
    assert bench.stage.halts == 1


def test_a_hold_halts_even_a_move_out_of_the_part() -> None:
    for dz in (60e-6, -60e-6):
        bench = Bench()
        send(bench, (0.0, 0.0, dz))
        bench.stage.now = stage(moving=True)
        stale(bench, NOW + MS)
        assert bench.stage.halts == 1


def test_a_stop_halts_even_a_move_out_of_the_part() -> None:
    bench = Bench()
    send(bench, (0.0, 0.0, -60e-6))
    bench.stage.now = stage(moving=True)
    bench.see(NOW + MS, (0.071, 0.0, 0.0))
    assert bench.stage.halts == 1


@pytest.mark.parametrize("by_hand", [False, True])
def test_a_halted_move_is_not_set_going_again_by_the_governor(by_hand: bool) -> None:
    bench = Bench()
    send(bench, (20e-6, 0.0, 0.0))
    bench.stage.now = stage(moving=True)
    if by_hand:
        bench.gate.hold()
    else:
        stale(bench, NOW + MS)
    bench.see(NOW + 2 * MS, (0.040, 0.0, 0.0))
    assert bench.stage.slowed == []


def test_a_turn_is_sent_with_its_angular_speed() -> None:
    """1 deg/s on a lever of 4 mm."""
    bench = Bench()
    seen = bench.see()
    turn = proposal((0.0, 0.0, 0.0), rotation=(math.radians(0.05), 0.0, 0.0))
    sent = bench.gate.send_step(turn, seen, NOW)
    assert sent.speed_m_s == pytest.approx(69.813e-6, abs=1e-9)
    (move,) = bench.stage.moves
    assert move[1:] == (0.0, pytest.approx(math.radians(1.0)))


@pytest.mark.parametrize(
    ("length_m", "moves"),
    [(5e-324, 0), (2.2250738585e-313, 0), (0.999e-15, 0), (1e-15, 1), (1.001e-15, 1)],
)
def test_a_step_shorter_than_a_femtometre_is_none(length_m: float, moves: int) -> None:
    """Over a length near the smallest number a speed would be divided to infinity."""
    bench = Bench()
    sent = send(bench, (0.0, 0.0, length_m))
    assert len(bench.stage.moves) == moves
    assert all(0.0 < speed <= 0.005 for _, speed, _ in bench.stage.moves)
    assert sent.translation == (0.0, 0.0, length_m * moves)


def test_rounding_of_the_path_does_not_lift_the_speed() -> None:
    """The length of this step differs by rounding between its two ways to be added up."""
    bench = Bench()
    step = (2.1575356909223864e-06, 2.7505234008803886e-06, 4.019550071772e-06)
    sent = send(bench, step)
    ((_, speed, _),) = bench.stage.moves
    assert speed == sent.speed_m_s


def test_rounding_does_not_lift_the_angular_speed() -> None:
    """A stage refuses what is a last digit above its own limit."""
    for rx, ry, rz in np.random.default_rng(1).uniform(-8e-4, 8e-4, (1000, 3)).tolist():
        bench = Bench()
        turn = proposal((0.0, 0.0, 0.0), rotation=(rx, ry, rz))
        bench.gate.send_step(turn, bench.see(), NOW)
        ((_, _, angular_speed),) = bench.stage.moves
        assert angular_speed <= math.radians(1.0)
