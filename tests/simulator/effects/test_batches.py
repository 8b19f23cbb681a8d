"""Environment i of a batch is the same, bit for bit, as that environment alone."""

from collections.abc import Callable

import numpy as np
import pytest

from simulator.checks import FloatArray
from simulator.effects import arm, sensor, stage
from simulator.effects.draws import standard_normals
from simulator.effects.flicker import flicker
from simulator.effects.hysteresis import PrandtlIshlinskii
from simulator.effects.vibration import VibrationMode

STEPS = 6
SEEDS = (5, 17, 3, 8, 13, 2, 11, 7, 19)
SIZES = np.array([1e-6, 2e-6, 3e-6, 1e-5, 2e-5, 3e-5])
CROSSTALK = np.eye(6) + 0.01 * np.random.default_rng(0).standard_normal((6, 6))


def own(sizes: FloatArray, seeds: tuple[int, ...]) -> FloatArray:
    """Sizes of each environment's own: those given, times a factor that follows from its seed."""
    factors = np.array([1.0 + 0.1 * seed for seed in seeds])
    return factors.reshape(-1, *(1,) * sizes.ndim) * sizes


def stage_record(seeds: tuple[int, ...], generators: list[np.random.Generator]) -> FloatArray:
    rows = own(np.outer(np.arange(1.0, 12.0), SIZES), seeds)
    effects = stage.StageEffects(
        own(SIZES, seeds),
        own(3.0 * SIZES, seeds),
        PrandtlIshlinskii(rows, np.full_like(rows, 0.07)),
        own(SIZES, seeds),
        0.02,
    )
    state = stage.at_rest(effects, np.zeros((len(seeds), 6)))
    record = []
    for _ in range(STEPS):
        draws = standard_normals(generators, 6 + effects.draws_per_motion)
        state = stage.move(effects, 1e-4 * draws[:, :6], state, 0.03, draws[:, 6:])
        record.append(state.position)
    return np.array(record)


def arm_record(seeds: tuple[int, ...], generators: list[np.random.Generator]) -> FloatArray:
    modes = tuple(VibrationMode(f, 0.03, own(SIZES, seeds)) for f in (8.0, 9.5, 14.0, 33.0))
    drifts = tuple(arm.ThermalDrift(tau, own(SIZES, seeds)) for tau in (60.0, 600.0))
    effects = arm.ArmEffects(drifts, own(0.1 * SIZES, seeds), modes)
    state = arm.cold(effects, standard_normals(generators, effects.draws_at_start))
    record = []
    for _ in range(STEPS):
        state = arm.step(effects, state, 0.01, standard_normals(generators, effects.draws_per_step))
        record.append(arm.displacement(effects, state))
    return np.array(record)


def sensor_record(seeds: tuple[int, ...], generators: list[np.random.Generator]) -> FloatArray:
    effects = sensor.SensorEffects(
        1000.0,
        CROSSTALK + own(np.zeros((6, 6)), seeds),
        own(SIZES, seeds),
        flicker(own(SIZES, seeds), (0.01, 20.0)),
        own(SIZES, seeds),
        own(1e4 * SIZES, seeds),
        0.0 * SIZES,
        2.3,
    )
    loads = standard_normals(generators, 6)
    state = sensor.warmed_up(effects, loads, standard_normals(generators, effects.draws_at_start))
    record = []
    for _ in range(STEPS):
        draws = standard_normals(generators, effects.draws_per_sample)
        loads = loads + 1e-3 * draws[:, :6]
        reading, _, state = sensor.sample(effects, loads, state, draws)
        record.append(reading)
    return np.array(record)


RECORDS = [stage_record, arm_record, sensor_record]


@pytest.mark.parametrize("record", RECORDS)
def test_a_row_of_a_batch_is_that_environment_alone(
    record: Callable[[tuple[int, ...], list[np.random.Generator]], FloatArray],
) -> None:
    batch = record(SEEDS, [np.random.default_rng(seed) for seed in SEEDS])
    assert batch.shape == (STEPS, len(SEEDS), 6)
    for i, seed in enumerate(SEEDS):
        alone = record((seed,), [np.random.default_rng(seed)])
        np.testing.assert_array_equal(batch[:, i], alone[:, 0])
    assert len(np.unique(batch[-1, :, 0])) == len(SEEDS)


def test_leading_shapes_and_memory_layouts_do_not_matter() -> None:
    """A single environment without a batch axis, a grid of them, and a transposed array."""
    effects = sensor.SensorEffects(
        1000.0, CROSSTALK, drift=flicker(SIZES, (0.01, 20.0)), noise_density=SIZES
    )
    generators = [np.random.default_rng(seed) for seed in SEEDS[:6]]
    loads = standard_normals(generators, 6)
    first = standard_normals(generators, effects.draws_at_start)
    draws = standard_normals(generators, effects.draws_per_sample)

    def read(load: FloatArray, at_start: FloatArray, normals: FloatArray) -> FloatArray:
        return sensor.sample(effects, load, sensor.warmed_up(effects, load, at_start), normals)[0]

    flat = read(loads, first, draws)
    grid = read(loads.reshape(2, 3, 6), first.reshape(2, 3, -1), draws.reshape(2, 3, -1))
    np.testing.assert_array_equal(grid.reshape(6, 6), flat)
    turned = read(*(np.asfortranarray(array) for array in (loads, first, draws)))
    np.testing.assert_array_equal(turned, flat)
    for i in range(6):
        np.testing.assert_array_equal(read(loads[i], first[i], draws[i]), flat[i])


def test_each_generator_fills_its_own_row() -> None:
    rows = standard_normals([np.random.default_rng(seed) for seed in (4, 9)], 5)
    np.testing.assert_array_equal(rows[1], np.random.default_rng(9).standard_normal(5))
    assert standard_normals([], 3).shape == (0, 3)
    assert standard_normals([np.random.default_rng(0)], 0).shape == (1, 0)


def test_the_same_past_and_draws_give_the_same_future() -> None:
    """Nothing is remembered but what the state says, and the state is left as it was."""
    effects = sensor.SensorEffects(100.0, drift=flicker(SIZES, (0.1, 1.0)), latency_samples=1.5)
    state = sensor.warmed_up(effects, SIZES, np.ones(effects.draws_at_start))
    before = [array.copy() for array in (state.rungs, state.readings, state.flags)]
    draws = np.linspace(-1.0, 1.0, effects.draws_per_sample)
    one, other = (sensor.sample(effects, 2.0 * SIZES, state, draws)[0] for _ in range(2))
    np.testing.assert_array_equal(one, other)
    for array, copy in zip((state.rungs, state.readings, state.flags), before, strict=True):
        np.testing.assert_array_equal(array, copy)
