"""Sensor chain: each effect by itself, their order, latency and saturation."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.signal import welch

from simulator.checks import FloatArray
from simulator.effects.flicker import Ladder, flicker
from simulator.effects.latency import delayed, full_of, left_over, queued
from simulator.effects.sensor import SensorEffects, record, sample, warmed_up

ONES = np.ones(6)
LOAD = np.array([0.02, -0.03, 0.4, 1e-5, -2e-5, 3e-6])
BIAS = np.array([1e-3, -2e-3, 3e-3, 1e-6, 2e-6, -3e-6])
QUIET = np.zeros(6)


def readings(
    effects: SensorEffects, loads: list[FloatArray]
) -> tuple[list[list[float]], list[list[bool]]]:
    """Reading and flags of each load in turn, without noise, by a sensor that began at no load."""
    state = warmed_up(effects, np.zeros(6), np.zeros(effects.draws_at_start))
    values, flags = [], []
    for load in loads:
        reading, saturated, state = sample(effects, load, state, np.zeros(effects.draws_per_sample))
        values.append(reading.tolist())
        flags.append(saturated.tolist())
    return values, flags


def test_the_default_is_an_ideal_sensor() -> None:
    effects = SensorEffects(1000.0)
    state = warmed_up(effects, LOAD, np.zeros(0))
    for load in (LOAD, -2.0 * LOAD):
        reading, saturated, state = sample(effects, load, state, 3.0 * ONES)
        np.testing.assert_array_equal(reading, load)
        assert not saturated.any()


def test_a_load_on_one_axis_is_read_on_the_others_too() -> None:
    """Entry (row, column) is the response of the row's axis to a load on the column's."""
    crosstalk = np.eye(6)
    crosstalk[0, 2], crosstalk[4, 0] = 0.01, 0.002
    values, _ = readings(SensorEffects(1000.0, crosstalk=crosstalk), [LOAD])
    expected = LOAD + np.array([0.01 * 0.4, 0.0, 0.0, 0.0, 0.002 * 0.02, 0.0])
    np.testing.assert_allclose(values[0], expected, rtol=1e-15)


def test_crosstalk_acts_on_the_load_and_not_on_the_bias() -> None:
    effects = SensorEffects(1000.0, crosstalk=2.0 * np.eye(6), bias=BIAS)
    np.testing.assert_allclose(readings(effects, [LOAD])[0][0], 2.0 * LOAD + BIAS, rtol=1e-15)


def test_bias_and_crosstalk_use_up_range() -> None:
    """0.9 of the range is clipped once the bias is added; what the load alone is does not count."""
    crosstalk = np.eye(6)
    crosstalk[1, 0] = 1.0
    bias = np.array([0.2, 0.0, 0.2, 0.0, 0.0, 0.0])
    effects = SensorEffects(1000.0, crosstalk=crosstalk, bias=bias, range=ONES)
    load = np.array([-0.9, -0.2, 0.9, 0.0, 1.0, 0.99])
    values, flags = readings(effects, [load])
    assert values[0] == pytest.approx([-0.7, -1.0, 1.0, 0.0, 1.0, 0.99])
    assert flags[0] == [False, True, True, False, True, False]


def test_noise_can_saturate_and_is_rounded() -> None:
    effects = SensorEffects(2.0, noise_density=0.3 * ONES, range=ONES, resolution=0.25 * ONES)
    state = warmed_up(effects, 0.9 * ONES, np.zeros(0))
    draws = np.array([1.0, 0.3, 0.0, -1.0, -8.0, -3.0])
    reading, saturated, _ = sample(effects, 0.9 * ONES, state, draws)
    np.testing.assert_allclose(reading, [1.0, 1.0, 1.0, 0.5, -1.0, 0.0], atol=1e-15)
    assert saturated.tolist() == [True, False, False, False, True, False]


def test_the_reading_is_the_nearest_step() -> None:
    resolution = np.array([0.015, 0.015, 0.015, 0.0, 1.5e-5, 0.0])
    values, _ = readings(SensorEffects(1000.0, resolution=resolution), [LOAD])
    assert values[0] == pytest.approx([0.015, -0.03, 0.405, 1e-5, -1.5e-5, 3e-6], rel=1e-12)


def test_noise_has_its_density_at_every_frequency_and_rate() -> None:
    """Welch's mean over 96 series of 7 segments: 5.5 standard errors a bin, 2 percent overall."""
    for rate_Hz in (200.0, 5000.0):
        effects = SensorEffects(rate_Hz, noise_density=3e-5 * ONES)
        generator = np.random.default_rng(6)
        state = warmed_up(effects, np.zeros((16, 6)), np.zeros((16, 0)))
        record = np.empty((1024, 16, 6))
        for k in range(1024):
            draws = generator.standard_normal((16, 6))
            record[k], _, state = sample(effects, np.zeros((16, 6)), state, draws)
        frequency, spectra = welch(record, rate_Hz, nperseg=256, axis=0, detrend=False)
        power = spectra.mean(axis=(1, 2))[1:-1]
        assert frequency[-1] == 0.5 * rate_Hz
        np.testing.assert_allclose(power, 9e-10, rtol=5.5 / math.sqrt(96 * 6.6))
        assert power.mean() == pytest.approx(9e-10, rel=0.02)


def test_drift_adds_to_the_reading_and_goes_on_from_sample_to_sample() -> None:
    """One rung of 4 mN that halves between samples, and starts at three deviations."""
    corner = 100.0 * math.log(2.0) / (2.0 * math.pi)
    effects = SensorEffects(100.0, drift=Ladder((corner,), 4e-3 * ONES))
    assert (effects.draws_at_start, effects.draws_per_sample) == (6, 12)
    state = warmed_up(effects, LOAD, 3.0 * ONES)
    for expected in (6e-3, 3e-3, 1.5e-3):
        reading, _, state = sample(effects, LOAD, state, np.zeros(12))
        np.testing.assert_allclose(reading, LOAD + expected, rtol=1e-12)
    kicked = sample(effects, LOAD, state, np.concatenate([QUIET, ONES]))[0]
    np.testing.assert_allclose(kicked, LOAD + 0.75e-3 + 4e-3 * math.sqrt(0.75), rtol=1e-12)


def test_late_readings_arrive_complete_and_in_order() -> None:
    """Load, clipping and flag of a sample all arrive two samples later."""
    effects = SensorEffects(1000.0, bias=0.1 * ONES, range=ONES, latency_samples=2.0)
    values, flags = readings(effects, [k * ONES for k in (0.2, 0.5, 0.95, 0.3, 0.4)])
    assert [v[0] for v in values] == pytest.approx([0.1, 0.1, 0.3, 0.6, 1.0])
    assert [f[0] for f in flags] == [False, False, False, False, True]


def test_a_reading_between_two_samples_is_flagged_if_either_was_saturated() -> None:
    effects = SensorEffects(1000.0, range=ONES, latency_samples=0.25)
    values, flags = readings(effects, [k * ONES for k in (0.0, 5.0, 0.2, 0.2)])
    assert [v[0] for v in values] == pytest.approx([0.0, 0.75, 0.4, 0.2])
    assert [f[0] for f in flags] == [False, True, True, False]


def test_a_warmed_up_sensor_has_readings_of_its_load_on_their_way() -> None:
    effects = SensorEffects(
        1000.0, bias=0.25 * ONES, resolution=0.5 * ONES, range=ONES, latency_samples=1.0
    )
    state = warmed_up(effects, np.array([0.4, -0.9, 3.0, 0.0, 0.0, 0.0]), np.zeros(0))
    reading, saturated, _ = sample(effects, QUIET, state, QUIET)
    np.testing.assert_array_equal(reading, [0.5, -0.5, 1.0, 0.0, 0.0, 0.0])
    assert saturated.tolist() == [False, False, True, False, False, False]


def late_by(latency: float, values: list[float], blocks: int = 1) -> FloatArray:
    """What is read of the values, made in a number of blocks, by a source that was at 0.5."""
    past = full_of(np.array([0.5]), latency)
    read = []
    for block in np.array_split(np.array(values)[:, np.newaxis], blocks):
        queue = queued(block, past)
        read.append(delayed(queue, latency))
        past = left_over(queue, len(block), latency)
        assert past.shape == (math.ceil(latency), 1)
    return np.concatenate(read)[:, 0]


@given(st.floats(0.0, 9.0), st.integers(1, 20))
def test_a_ramp_is_read_late_by_the_latency(latency: float, blocks: int) -> None:
    late = late_by(latency, [float(k) for k in range(20)], blocks)
    full = math.ceil(latency)
    np.testing.assert_allclose(late[full:], np.arange(full, 20) - latency, atol=1e-12)


@given(
    st.integers(0, 8), st.lists(st.floats(-1.0, 1.0), min_size=1, max_size=20), st.integers(1, 5)
)
def test_a_whole_latency_only_shifts(latency: int, values: list[float], blocks: int) -> None:
    read = late_by(float(latency), values, blocks)
    assert read.tolist() == ([0.5] * latency + values)[: len(values)]


def full_effects() -> SensorEffects:
    """Every effect on."""
    return SensorEffects(
        1000.0,
        np.eye(6) + 0.01,
        BIAS,
        flicker(1e-3 * ONES, (0.1, 10.0)),
        1e-3 * ONES,
        0.4 * ONES,
        1e-4 * ONES,
        2.3,
    )


@given(st.integers(0, 12))
def test_a_block_may_be_broken_off_after_any_sample(count: int) -> None:
    """What comes after it is what one sample at a time gives, to the last bit."""
    effects = full_effects()
    generator = np.random.default_rng(3)
    state = warmed_up(effects, LOAD, generator.standard_normal(effects.draws_at_start))
    loads = LOAD + 1e-2 * generator.standard_normal((12, 6))
    draws = generator.standard_normal((12, effects.draws_per_sample))
    block = record(effects, loads[:count], state, draws[:count]) if count else None
    whole = record(effects, loads, state, draws)
    going_on = state if block is None else block.after(count)
    rest = record(effects, loads[count:], whole.after(count), draws[count:])
    for k in range(count, 12):
        reading, saturated, going_on = sample(effects, loads[k], going_on, draws[k])
        np.testing.assert_array_equal(reading, whole.readings[k])
        np.testing.assert_array_equal(reading, rest.readings[k - count])
        np.testing.assert_array_equal(saturated, whole.saturated[k])
    assert whole.saturated.any()
    assert not whole.saturated.all()


@given(st.floats(-3.0, 3.0), st.floats(0.01, 2.0), st.integers(1, 50))
def test_no_reading_passes_a_range_of_whole_steps(load: float, step: float, count: int) -> None:
    effects = SensorEffects(1.0, range=count * step * ONES, resolution=step * ONES)
    values, flags = readings(effects, [load * ONES])
    assert abs(values[0][0]) <= count * step
    assert flags[0][0] == (abs(load) >= count * step)


def test_a_drift_must_fit_the_sample_rate() -> None:
    ladder = flicker(ONES, (0.1, 5.0))
    SensorEffects(100.0, drift=ladder)
    with pytest.raises(ValueError, match=r"drift has a corner at 50\.0.* at most 49\.5 Hz"):
        SensorEffects(99.0, drift=ladder)
