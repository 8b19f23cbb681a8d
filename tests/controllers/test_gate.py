"""The gate: the only way to an actuator."""

import math
from collections.abc import Callable

import numpy as np
import pytest

from controllers.messages import Rule, Sent, Severity, Snapshot
from drivers.contract.clock import ManualClock
from drivers.contract.errors import DeviceError, SafetyError
from drivers.contract.messages import Pose, Vector3
from tests.controllers.builders import (
    MS,
    NOW,
    Bench,
    arm,
    gripper,
    proposal,
    rules,
    sample,
    stage,
)
from tests.controllers.gate_commands import (
    commands,
    halt,
    let_go,
    send_away,
    send_in,
    send_nan,
)

OUT_AND_CALM = stage(-300e-6)
Send = Callable[[Bench, Snapshot], None]


def send(bench: Bench, translation: Vector3 = (0.0, 0.0, 60e-6), now_ns: int = NOW) -> Sent:
    seen = bench.see(now_ns)
    return bench.gate.send_step(proposal(translation, stamp_ns=now_ns), seen, now_ns)


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


def test_a_finished_move_is_no_longer_slowed() -> None:
    bench = Bench()
    send(bench, (20e-6, 0.0, 0.0))
    bench.see(NOW + MS, (0.020, 0.0, 0.0))
    assert bench.stage.slowed == []


def overload(bench: Bench, start_ns: int, ticks: int) -> int:
    """Hold 60 mN for so many steps of 5 ms; 10 mN s are full after 625 ms."""
    for tick in range(ticks):
        bench.see(start_ns + tick * 5 * MS, (0.060, 0.0, 0.0))
    return start_ns + ticks * 5 * MS


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


def stale(bench: Bench, now_ns: int) -> Snapshot:
    """Watch a cell whose only fault is an old force sample: a hold."""
    seen = bench.see(now_ns)._replace(sample=sample(stamp_ns=now_ns - 6 * MS))
    assert bench.gate.watch(seen).severity is Severity.HOLD
    return seen


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


def test_a_turn_is_sent_with_its_angular_speed() -> None:
    """1 deg/s on a lever of 4 mm."""
    bench = Bench()
    seen = bench.see()
    turn = proposal((0.0, 0.0, 0.0), rotation=(math.radians(0.05), 0.0, 0.0))
    sent = bench.gate.send_step(turn, seen, NOW)
    assert sent.speed_m_s == pytest.approx(69.813e-6, abs=1e-9)
    (move,) = bench.stage.moves
    assert move[1:] == (0.0, pytest.approx(math.radians(1.0)))


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
