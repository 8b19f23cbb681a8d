"""What the mock force sensor adds where its settings ask for it."""

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from drivers.contract.clock import ManualClock
from drivers.force_sensor.mock import MockForceSensor, MockForceSensorSettings
from drivers.mock_world import MockWorld
from simulator.checks import FloatArray

QUIET = {
    "rate_Hz": 1000.0,
    "force_noise_uN_rtHz": 1e-3,
    "torque_noise_nNm_rtHz": 1e-3,
    "bias_mN": (0.0, 0.0, 0.0),
    "force_resolution_mN": 1e-6,
    "torque_resolution_uNm": 1e-6,
    "force_range_mN": 1000.0,
    "torque_range_uNm": 50_000.0,
    "origin_um": (0.0, 0.0, 0.0),
}
NONE = (0.0,) * 6
STEP_N = 0.1


class PressedWorld(MockWorld):
    """Pushes along x with 0.1 N from the time on that is set."""

    from_ns = 0

    def wrench(self, times_ns: Any, origin_m: Any) -> FloatArray:
        load = np.zeros((len(times_ns), 6))
        load[:, 0] = [STEP_N if time_ns >= self.from_ns else 0.0 for time_ns in times_ns]
        return load


@pytest.fixture
def pressed(world: MockWorld, clock: ManualClock) -> PressedWorld:
    return PressedWorld(world.settings, np.random.default_rng(5))


def sensor_of(world: MockWorld, clock: ManualClock, **keys: Any) -> MockForceSensor:
    settings = MockForceSensorSettings.model_validate({**QUIET, **keys})
    sensor = MockForceSensor(settings, clock, world)
    sensor.connect()
    return sensor


@pytest.mark.parametrize("broken", [False, True])
def test_a_load_is_reported_late(pressed: PressedWorld, clock: ManualClock, broken: bool) -> None:
    """Whole samples and half of one, whether or not a command breaks the block in between."""
    pressed.from_ns = clock.now_ns() + 20_000_000
    sensor = sensor_of(pressed, clock, latency_ms=4.5)
    forces = []
    for _ in range(40):
        forces.append(sensor.read(0.01).wrench[0])
        if broken:
            pressed.let_go()
    expected = [0.0] * 23 + [0.5 * STEP_N] + [STEP_N] * 16
    np.testing.assert_allclose(forces, expected, atol=1e-6)


def test_a_full_load_on_one_axis_is_read_on_the_others_in_percent_of_their_range(
    pressed: PressedWorld, clock: ManualClock
) -> None:
    """A tenth of the range of fx: 3 percent of a tenth of 1 N on fz, and of 50 mN m on ty."""
    row = (3.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    rows = dict.fromkeys(("fx", "fz", "ty"), row) | dict.fromkeys(("fy", "tx", "tz"), NONE)
    crosstalk = {f"{axis}_percent": values for axis, values in rows.items()}
    wrench = sensor_of(pressed, clock, crosstalk=crosstalk).read(0.01).wrench
    np.testing.assert_allclose(wrench, [0.103, 0, 0.003, 0, 0.05 * 0.003, 0], atol=1e-6)


DRIFT = {
    "force_uN_rtHz": 1000.0,
    "torque_nNm_rtHz": 0.0,
    "lowest_frequency_Hz": 0.01,
    "highest_frequency_Hz": 0.1,
}


def test_drift_goes_on_smoothly_where_a_command_breaks_the_block(
    world: MockWorld, clock: ManualClock
) -> None:
    """Its fastest part has a corner of 1 Hz: in a millisecond it moves by far less than its size.

    A deviation of 0.15 mN, against 2.8 mN in all.
    """
    sensor = sensor_of(world, clock, drift=DRIFT)
    forces = []
    for k in range(4000):
        forces.append(sensor.read(0.01).wrench[:3])
        if k % 5 == 0:
            world.let_go()
    moved = np.diff(forces, axis=0)
    breaks = moved[0::5]
    assert np.abs(moved).max() < 0.8e-3
    assert breaks.std() == pytest.approx(moved.std(), rel=0.1)
    assert np.abs(forces[-1]).max() > 1e-6


def test_drift_begins_anywhere_in_its_distribution(
    make_world: Callable[[int], MockWorld],
) -> None:
    """Seven rungs of 1.07 mN: 2.84 mN, from 240 axes; five standard errors."""
    first = [
        sensor_of(make_world(seed), ManualClock(), drift=DRIFT).read(0.01).wrench
        for seed in range(80)
    ]
    assert np.std([w[:3] for w in first]) == pytest.approx(2.84e-3, rel=0.23)
    assert np.std([w[3:] for w in first]) < 1e-9
