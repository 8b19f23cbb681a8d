"""What every stage must do."""

import math

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from drivers.contract.clock import ManualClock
from drivers.contract.errors import CommandRefusedError, DeviceError
from drivers.contract.interfaces import Stage
from drivers.contract.messages import Pose, StageState
from drivers.mock_world import MockWorld
from drivers.stage.mock import MockStage
from tests.drivers.conftest import STAGE

MS = 1_000_000
START = Pose((0.0, 0.0, -300e-6))


def follow(stage: Stage, clock: ManualClock, duration_ms: int) -> list[StageState]:
    states = []
    for _ in range(duration_ms * 2):
        clock.sleep_until_ns(clock.now_ns() + MS // 2)
        states.append(stage.state())
    return states


def test_a_stage_that_is_not_connected_says_so(stage: Stage) -> None:
    for call in (
        stage.state,
        stage.halt,
        lambda: stage.move_to(START, 1e-3, 0.01),
        lambda: stage.slow_to(1e-3, 0.01),
    ):
        with pytest.raises(DeviceError, match="not connected"):
            call()


def test_at_rest_it_reports_where_it_is(stage: Stage, clock: ManualClock) -> None:
    stage.connect()
    states = follow(stage, clock, 20)
    assert {s.pose for s in states} == {START}
    assert not any(s.moving for s in states)
    assert all(0 <= clock.now_ns() - s.stamp_ns <= 20 * MS for s in states)
    stamps = [s.stamp_ns for s in states]
    assert stamps == sorted(stamps)
    assert 10 <= len(set(stamps)) <= 11, "telemetry at 500 Hz"


def test_a_move_takes_its_time_and_arrives(stage: Stage, clock: ManualClock) -> None:
    """100 um at 5 mm/s and 1 m/s^2: 5 ms and 12.5 um to either side, 15 ms at speed."""
    stage.connect()
    target = Pose((60e-6, 0.0, -220e-6))
    command = stage.move_to(target, 5e-3, 0.01)
    assert (command.target, command.speed_m_s) == (target, 5e-3)
    states = follow(stage, clock, 40)
    moving_ms = sum(s.moving for s in states) / 2
    assert moving_ms == pytest.approx(25.0, abs=2.0)
    assert states[-1].pose.position == pytest.approx(target.position, abs=1e-15)
    assert states[-1].velocity == (0.0, 0.0, 0.0)
    fastest = max(math.hypot(*s.velocity) for s in states)
    assert fastest == pytest.approx(5e-3, rel=1e-9)
    middle = next(s for s in states if s.pose.position[0] > 30e-6)
    assert middle.velocity == pytest.approx((3e-3, 0.0, 4e-3), rel=1e-9)


def test_it_refuses_a_second_move_on_the_way(stage: Stage, clock: ManualClock) -> None:
    stage.connect()
    stage.move_to(Pose((0.0, 0.0, 0.0)), 5e-3, 0.01)
    follow(stage, clock, 5)
    with pytest.raises(CommandRefusedError, match="moving"):
        stage.move_to(START, 5e-3, 0.01)


@pytest.mark.parametrize(
    ("target", "speed", "angular", "text"),
    [
        (Pose((501e-6, 0.0, 0.0)), 1e-3, 0.01, r"x = 501\.0 um, valid: \+-500\.0 um"),
        (Pose((0.0, -501e-6, 0.0)), 1e-3, 0.01, r"y = -501\.0 um"),
        (Pose((0.0, 0.0, 4001e-6)), 1e-3, 0.01, r"z = 4001\.0 um, valid: \+-4000\.0 um"),
        (Pose((math.nan, 0.0, 0.0)), 1e-3, 0.01, "x = nan"),
        (Pose(), 5.001e-3, 0.01, r"speed 5\.001 mm/s, valid: 0 to 5\.000 mm/s"),
        (Pose(), -1e-3, 0.01, r"speed -1\.000 mm/s"),
        (Pose(), math.nan, 0.01, "speed nan"),
        (Pose(), 1e-3, math.radians(1.01), r"1\.010 deg/s, valid: 0 to 1\.000 deg/s"),
        (Pose(), 1e-3, math.nan, "angular speed nan"),
    ],
)
def test_it_refuses_what_it_cannot_do(
    stage: Stage, clock: ManualClock, target: Pose, speed: float, angular: float, text: str
) -> None:
    stage.connect()
    with pytest.raises(CommandRefusedError, match=text):
        stage.move_to(target, speed, angular)
    assert follow(stage, clock, 10)[-1].pose == START


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture], max_examples=60)
@given(after_us=st.integers(0, 40_000), again_us=st.integers(0, 5_000))
def test_halt_brakes_at_once_and_for_good(world: MockWorld, after_us: int, again_us: int) -> None:
    """From 5 mm/s and 1 m/s^2 it comes to rest within 5 ms and 12.5 um, on the line of the move."""
    clock = ManualClock(10**9)
    stage: Stage = MockStage(STAGE, clock, world)
    stage.connect()
    stage.move_to(Pose((60e-6, 0.0, -220e-6)), 5e-3, 0.01)
    clock.sleep_until_ns(clock.now_ns() + after_us * 1000)
    stage.halt()
    began = stage.state()
    clock.sleep_until_ns(clock.now_ns() + again_us * 1000)
    stage.halt()
    states = follow(stage, clock, 12)
    assert not states[-1].moving
    assert math.dist(states[-1].pose.position, began.pose.position) <= 12.5e-6 + 5e-3 * 2e-3
    assert sum(s.moving for s in states) / 2 <= 5.0 + 2.0
    dx, _, dz = (p - q for p, q in zip(states[-1].pose.position, START.position, strict=True))
    assert dx * 4.0 == pytest.approx(dz * 3.0, abs=1e-12)
    assert 0.0 <= dx <= 60e-6 + 1e-12
    assert states[-1].pose == states[-3].pose


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture], max_examples=60)
@given(changes=st.lists(st.tuples(st.integers(0, 15_000), st.floats(1e-4, 5e-3)), max_size=4))
def test_slowed_on_the_way_it_still_arrives_and_never_jumps(
    world: MockWorld, changes: list[tuple[int, float]]
) -> None:
    clock = ManualClock(10**9)
    stage: Stage = MockStage(STAGE, clock, world)
    stage.connect()
    stage.move_to(Pose((0.0, 0.0, -200e-6)), 5e-3, 0.01)
    depth, slowest = START.position[2], 5e-3
    for wait_us, speed in changes:
        clock.sleep_until_ns(clock.now_ns() + wait_us * 1000)
        slowest = min(slowest, speed)
        stage.slow_to(slowest, 0.01)
    for state in follow(stage, clock, 1100):
        moved = state.pose.position[2] - depth
        assert moved >= -1e-15
        depth = state.pose.position[2]
        assert abs(state.velocity[2]) <= 5e-3 * (1.0 + 1e-9)
    assert depth == pytest.approx(-200e-6, abs=1e-12)


def test_slowing_takes_effect_at_the_stated_deceleration(stage: Stage, clock: ManualClock) -> None:
    stage.connect()
    stage.move_to(Pose((0.0, 0.0, 0.0)), 5e-3, 0.01)
    follow(stage, clock, 10)
    stage.slow_to(1e-3, 0.01)
    states = follow(stage, clock, 8)
    assert states[0].velocity[2] > 4e-3
    assert states[-1].velocity[2] == pytest.approx(1e-3, rel=1e-6)


def test_at_rest_there_is_nothing_to_slow_or_halt(stage: Stage, clock: ManualClock) -> None:
    stage.connect()
    stage.slow_to(1e-3, 0.01)
    stage.halt()
    assert follow(stage, clock, 10)[-1].pose == START


def test_rotation_and_translation_arrive_together(stage: Stage, clock: ManualClock) -> None:
    """0.04 deg at 1 deg/s is the slower of the two."""
    stage.connect()
    turn = math.radians(0.04)
    stage.move_to(Pose((0.0, 0.0, -290e-6), (turn, 0.0, 0.0)), 5e-3, math.radians(1.0))
    states = follow(stage, clock, 80)
    assert sum(s.moving for s in states) / 2 == pytest.approx(45.0, abs=2.0)
    half = next(s for s in states if s.pose.rotation[0] >= turn / 2)
    assert half.pose.position[2] == pytest.approx(-295e-6, abs=1e-6)
    assert max(math.hypot(*s.angular_velocity) for s in states) <= math.radians(1.0) * 1.000001


def test_close_comes_to_rest_and_may_be_repeated(stage: Stage, clock: ManualClock) -> None:
    stage.connect()
    stage.move_to(Pose(), 5e-3, 0.01)
    clock.sleep_until_ns(clock.now_ns() + 10 * MS)
    stage.close()
    stage.close()
    stage.connect()
    assert not stage.state().moving
