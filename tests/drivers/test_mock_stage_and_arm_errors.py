"""Where stage and part really are in the mock cell, once its errors are on."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from drivers import mock_sway
from drivers.arm.mock import MockArm
from drivers.arm.mock_settings import MockArmSettings
from drivers.contract.clock import ManualClock
from drivers.contract.messages import Pose
from drivers.gripper.mock import MockGripper
from drivers.mock_sway import Sway
from drivers.mock_world import MockWorld
from drivers.stage.mock import MockStage
from drivers.stage.mock_settings import MockStageSettings
from simulator.effects.arm import ArmEffects, ThermalDrift
from simulator.effects.vibration import VibrationMode
from tests.drivers.conftest import GRIPPER

STAGE_KEYS = {
    "telemetry_rate_Hz": 500.0,
    "speed_limit_mm_s": 5.0,
    "angular_speed_limit_deg_s": 1.0,
    "travel_um": (500.0, 500.0, 4000.0),
    "acceleration_mm_s2": 1000.0,
}
ARM_KEYS = {"telemetry_rate_Hz": 125.0, "acceleration_mm_s2": 500.0}
MS = 1_000_000


def stage_of(world: MockWorld, clock: ManualClock, **keys: Any) -> MockStage:
    stage = MockStage(MockStageSettings.model_validate({**STAGE_KEYS, **keys}), clock, world)
    stage.connect()
    return stage


def depth_um(world: MockWorld, clock: ManualClock) -> float:
    truth = world.truth(clock.now_ns())
    assert truth is not None
    return truth.depth_m * 1e6


def go(stage: MockStage, clock: ManualClock, z_um: float, rest_ms: int = 500) -> None:
    stage.move_to(Pose((0.0, 0.0, z_um * 1e-6)), 5e-3, 0.01)
    clock.sleep_until_ns(clock.now_ns() + rest_ms * MS)
    assert stage.state().pose.position[2] == pytest.approx(z_um * 1e-6, abs=1e-12)


@pytest.fixture
def held(world: MockWorld, clock: ManualClock) -> MockWorld:
    gripper = MockGripper(GRIPPER, clock, world)
    gripper.connect()
    gripper.set_valve(True)
    return world


def test_the_stage_goes_to_multiples_of_its_minimum_step(
    held: MockWorld, clock: ManualClock
) -> None:
    stage = stage_of(held, clock, minimum_step_um=4.0)
    for z_um, real_um in ((-281.0, -280.0), (-279.0, -280.0), (-277.0, -276.0)):
        go(stage, clock, z_um)
        assert depth_um(held, clock) == pytest.approx(real_um, abs=1e-6)


def test_backlash_is_crossed_at_a_reversal(held: MockWorld, clock: ManualClock) -> None:
    stage = stage_of(held, clock, backlash_um=6.0)
    for z_um, real_um in ((-280.0, -283.0), (-270.0, -273.0), (-275.0, -273.0), (-280.0, -277.0)):
        go(stage, clock, z_um)
        assert depth_um(held, clock) == pytest.approx(real_um, abs=1e-6)


def test_half_of_the_way_follows_late_by_the_gap(held: MockWorld, clock: ManualClock) -> None:
    stage = stage_of(held, clock, hysteresis_gap_um=8.0, hysteresis_weight=0.5)
    for z_um, real_um in ((-280.0, -282.0), (-284.0, -284.0), (-290.0, -288.0)):
        go(stage, clock, z_um)
        assert depth_um(held, clock) == pytest.approx(real_um, abs=1e-6)


def test_a_braked_motion_crosses_backlash_once(held: MockWorld, clock: ManualClock) -> None:
    """Slowed and halted on the way, it is as late as a motion that was sent there at once."""
    stage = stage_of(held, clock, backlash_um=6.0)
    stage.move_to(Pose((0.0, 0.0, 0.0)), 5e-3, 0.01)
    for command in (lambda: stage.slow_to(1e-3, 0.01), stage.halt):
        clock.sleep_until_ns(clock.now_ns() + 15 * MS)
        command()
    clock.sleep_until_ns(clock.now_ns() + 50 * MS)
    commanded_um = stage.state().pose.position[2] * 1e6
    assert -300.0 < commanded_um < -100.0
    assert depth_um(held, clock) == pytest.approx(commanded_um - 3.0, abs=1e-6)


def test_the_platform_settles_after_the_profile_has_ended(
    held: MockWorld, clock: ManualClock
) -> None:
    """The same part of what is left goes in each time constant."""
    stage = stage_of(held, clock, settling_time_constant_ms=40.0)
    go(stage, clock, -240.0, rest_ms=30)
    left = [-240.0 - depth_um(held, clock)]
    for _ in range(2):
        clock.sleep_until_ns(clock.now_ns() + 40 * MS)
        left.append(-240.0 - depth_um(held, clock))
    assert left == pytest.approx([60.0 * math.exp(-t) for t in (0.75, 1.75, 2.75)], rel=1e-6)


def test_the_force_follows_the_platform_while_it_settles(
    held: MockWorld, clock: ManualClock
) -> None:
    """8 mN per um at two rims, once the profile is over and 30 um sideways are still to come."""
    stage = stage_of(held, clock, settling_time_constant_ms=40.0)
    go(stage, clock, 250.0, rest_ms=2000)
    stage.move_to(Pose((40e-6, 0.0, 250e-6)), 5e-3, 0.01)
    clock.sleep_until_ns(clock.now_ns() + 20 * MS)
    assert not stage.state().moving
    early, late = (
        held.wrench([clock.now_ns() + after_ms * MS], (0.0, 0.0, 0.0))[0, 0]
        for after_ms in (0, 2000)
    )
    assert late - early == pytest.approx(8e3 * 40e-6 * math.exp(-0.5), rel=0.01)


def test_a_motion_that_is_slowed_goes_on_where_it_was(held: MockWorld, clock: ManualClock) -> None:
    """Its error is decided as it sets out: slowed or halted, it does not jump to another."""
    stage = stage_of(held, clock, repeatability_um=50.0)
    stage.move_to(Pose((0.0, 0.0, 0.0)), 5e-3, 0.01)
    for command in (lambda: stage.slow_to(1e-3, 0.01), stage.halt):
        clock.sleep_until_ns(clock.now_ns() + 15 * MS)
        before = depth_um(held, clock)
        command()
        assert depth_um(held, clock) == pytest.approx(before, abs=1e-6)


def test_a_motion_scatters_about_its_end(held: MockWorld, clock: ManualClock) -> None:
    """Two hundred motions; five standard errors."""
    stage = stage_of(held, clock, repeatability_um=2.0)
    ends = []
    for k in range(200):
        go(stage, clock, -280.0 - 10.0 * (k % 2))
        ends.append(depth_um(held, clock) + 280.0 + 10.0 * (k % 2))
    assert np.std(ends) == pytest.approx(2.0, rel=0.25)
    assert abs(np.mean(ends)) < 5.0 * 2.0 / math.sqrt(200)


MODE = VibrationMode(20.0, 0.05, np.array([1e-6, 0.0, -2e-6, 0.0, 0.0, 0.0]))


def test_sway_is_a_function_of_time(monkeypatch: pytest.MonkeyPatch) -> None:
    """In whatever order and blocks it is asked for, and after the past has been cut off."""
    monkeypatch.setattr(mock_sway, "_KEPT", 256)
    times = range(0, 3_000 * MS, 3_700_001)
    sways = [Sway(ArmEffects(modes=(MODE,)), 0, np.random.default_rng(3)) for _ in range(2)]
    blocks = np.vstack([sways[0].displacement(times[k : k + 50]) for k in range(0, len(times), 50)])
    single = []
    for time_ns in times:
        sways[1].displacement([time_ns + 40 * MS])
        single.append(sways[1].displacement([time_ns])[0])
    np.testing.assert_allclose(blocks, single, atol=1e-18)
    assert blocks[:, 0].std() == pytest.approx(1e-6, rel=0.3)
    np.testing.assert_allclose(blocks[:, 2], -2.0 * blocks[:, 0], rtol=1e-9)


def test_sway_between_its_steps_is_interpolated() -> None:
    sway = Sway(ArmEffects(modes=(MODE,)), 0, np.random.default_rng(3))
    first, middle, second = sway.displacement([MS, MS + MS // 4, 2 * MS])
    np.testing.assert_allclose(middle, 0.75 * first + 0.25 * second, rtol=1e-12)


def test_the_part_that_turns_sees_the_shaft_turn_back() -> None:
    """A part turned by 1 mrad about y: a shaft 2 mm deep is 2 um off to -x, and tilted by -1 mrad.

    A part moved by 5 um along y: the shaft is 5 um off to -y.
    """
    end = np.array([0.0, 5e-6, 0.0, 0.0, 1e-3, 0.0])
    sway = Sway(ArmEffects((ThermalDrift(1e-9, end),)), 0, np.random.default_rng(1))
    seen = sway.seen_from_part([10 * MS], np.array([[0.0, 0.0, 2e-3, 0.0, 0.0]]))
    np.testing.assert_allclose(seen[0], [-2e-6, -5e-6, 2e-3, 0.0, -1e-3], atol=1e-15)


def arm_of(world: MockWorld, clock: ManualClock, **keys: Any) -> MockArm:
    arm = MockArm(MockArmSettings.model_validate({**ARM_KEYS, **keys}), clock, world)
    arm.connect()
    return arm


def test_drift_of_the_arm_presses_the_shaft_against_the_part(
    held: MockWorld, clock: ManualClock
) -> None:
    """The part moves by 12 um to +x: the shaft touches its -x side, beyond 5 um of clearance."""
    arm = arm_of(held, clock, thermal=({"end_um": (12.0, 0.0, 0.0), "time_constant_s": 0.01},))
    stage = stage_of(held, clock)
    go(stage, clock, 250.0)
    force = held.wrench([clock.now_ns()], (0.0, 0.0, 0.0))[0]
    assert force[0] == pytest.approx(-8e3 * 7e-6, abs=8e3 * 2.5e-6)
    assert arm.state().pose == Pose(held.settings.tray.position)


def test_vibration_of_the_arm_shows_in_the_force_of_a_stage_at_rest(
    held: MockWorld, clock: ManualClock
) -> None:
    mode = {"frequency_Hz": 25.0, "damping_ratio": 0.05, "rms_um": (3.0, 0.0, 0.0)}
    arm_of(held, clock, vibration=(mode,))
    stage = stage_of(held, clock)
    stage.move_to(Pose((30e-6, 0.0, 250e-6)), 5e-3, 0.01)
    clock.sleep_until_ns(clock.now_ns() + 500 * MS)
    times = range(clock.now_ns(), clock.now_ns() + 2000 * MS, MS)
    forces = held.wrench(times, (0.0, 0.0, 0.0))[:, 0]
    assert forces.std() == pytest.approx(8e3 * 3e-6, rel=0.4)
    np.testing.assert_array_equal(forces[:5], held.wrench(times[:5], (0.0, 0.0, 0.0))[:, 0])


def test_errors_that_are_off_take_no_random_numbers(
    make_world: Callable[[int], MockWorld], clock: ManualClock
) -> None:
    worlds = [make_world(7), make_world(7)]
    stage_of(worlds[0], clock).move_to(Pose((0.0, 0.0, -2e-4)), 5e-3, 0.01)
    arm_of(worlds[0], clock)
    assert worlds[0].generator.random() == worlds[1].generator.random()
