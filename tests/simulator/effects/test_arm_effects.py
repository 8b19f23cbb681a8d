"""Arm: thermal approach, random walk, and modes of vibration against their theory."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.linalg import expm
from scipy.signal import welch

from simulator.checks import FloatArray
from simulator.effects.arm import ArmEffects, ThermalDrift, cold, displacement, step, steps
from simulator.effects.vibration import VibrationMode

ONES = np.ones(6)
DIRECTION = np.array([2e-6, -1e-6, 0.0, 0.0, 3e-5, 0.0])


def test_an_arm_without_effects_stands_still() -> None:
    effects = ArmEffects()
    assert (effects.draws_at_start, effects.draws_per_step) == (0, 6)
    state = cold(effects, np.zeros((4, 0)))
    for _ in range(3):
        state = step(effects, state, 0.5, np.full((4, 6), 2.0))
    np.testing.assert_array_equal(displacement(effects, state), np.zeros((4, 6)))


def test_draws_push_the_arm_their_own_way_and_all_displacements_add() -> None:
    """From rest: 4 s of walk, a drift that has arrived, and a mode at one deviation."""
    drift = ThermalDrift(1e-3, np.array([0.0, 0.0, 7e-6, 0.0, 0.0, 0.0]))
    mode = VibrationMode(12.0, 0.05, DIRECTION)
    effects = ArmEffects((drift,), 1e-6 * ONES, (mode,))
    assert (effects.draws_at_start, effects.draws_per_step) == (2, 8)
    start = cold(effects, np.array([1.0, 0.0]))
    np.testing.assert_array_equal(displacement(effects, start), DIRECTION)
    draws = np.array([1.0, 2.0, 3.0, -1.0, -2.0, -3.0, 0.5, -0.5])
    later = step(effects, start, 4.0, draws)
    swing = mode.steps(np.array([1.0, 0.0]), 4.0, draws[np.newaxis, 6:])[0, 0]
    expected = 2e-6 * draws[:6] + drift.end + swing * DIRECTION
    np.testing.assert_allclose(displacement(effects, later), expected, rtol=1e-12, atol=1e-20)
    again = step(effects, later, 1.0, np.zeros(8))
    np.testing.assert_array_equal(again.walk, later.walk)


def test_thermal_drifts_approach_their_ends_and_add() -> None:
    end = np.array([1e-5, 0.0, -4e-6, 0.0, 1e-4, 0.0])
    effects = ArmEffects((ThermalDrift(600.0, end), ThermalDrift(60.0, 0.5 * end)))
    state = cold(effects, np.zeros(0))
    np.testing.assert_array_equal(displacement(effects, state), np.zeros(6))
    for minute in range(1, 31):
        for _ in range(minute):
            state = step(effects, state, 60.0 / minute, ONES)
        expected = end * (1 - math.exp(-minute / 10)) + 0.5 * end * (1 - math.exp(-minute))
        np.testing.assert_allclose(displacement(effects, state), expected, rtol=1e-12, atol=1e-18)


@pytest.mark.parametrize(("steps", "dt_s"), [(4, 25.0), (16, 6.25)])
def test_the_random_walk_grows_with_the_root_of_time(steps: int, dt_s: float) -> None:
    """After 100 s ten times the density, whatever the step; bounds of five standard errors."""
    n = 20_000
    density = np.array([1e-8, 2e-8, 0.0, 1e-7, 2e-7, 3e-7])
    effects = ArmEffects(walk_density=density)
    generator = np.random.default_rng(2)
    state = cold(effects, np.zeros((n, 0)))
    walks = []
    for _ in range(steps):
        state = step(effects, state, dt_s, generator.standard_normal((n, 6)))
        walks.append(state.walk)
    np.testing.assert_allclose(
        walks[-1].std(axis=0), 10.0 * density, rtol=5.0 / np.sqrt(2 * n), atol=1e-20
    )
    moving = density > 0.0
    first, later = walks[0][:, moving], (walks[-1] - walks[0])[:, moving]
    correlation = (first * later).mean(axis=0) / (first.std(axis=0) * later.std(axis=0))
    assert (np.abs(correlation) < 5.0 / np.sqrt(n)).all()


@given(st.floats(0.1, 200.0), st.floats(1e-3, 0.95), st.floats(1e-4, 1.0))
def test_a_mode_is_discretised_exactly(frequency: float, damping: float, dt_s: float) -> None:
    """Its transition is a matrix exponential, and unit variance is kept to the last digits."""
    mode = VibrationMode(frequency, damping, ONES)
    omega = 2.0 * np.pi * frequency
    flow = omega * np.array([[0.0, 1.0], [-1.0, -2.0 * damping]])
    transition = mode.steps(np.eye(2), dt_s, np.zeros((1, 2, 2)))[0].T
    kick = mode.steps(np.zeros((2, 2)), dt_s, np.eye(2)[np.newaxis])[0].T
    np.testing.assert_allclose(transition, expm(flow * dt_s), atol=1e-9)
    np.testing.assert_allclose(kick @ kick.T, np.eye(2) - transition @ transition.T, atol=1e-14)


def test_a_very_short_step_keeps_the_small_kick() -> None:
    """To first order the noise adds 4 zeta a to v, and 4/3 zeta a^3 to q, a the angle turned."""
    angle, damping = 1e-4, 0.02
    mode = VibrationMode(10.0, damping, ONES)
    kick = mode.steps(np.zeros((2, 2)), angle / (20.0 * np.pi), np.eye(2)[np.newaxis])[0].T
    added = kick @ kick.T
    assert added[0, 0] == pytest.approx(4.0 / 3.0 * damping * angle**3, rel=1e-4)
    assert added[0, 1] == pytest.approx(2.0 * damping * angle**2, rel=1e-4)
    assert added[1, 1] == pytest.approx(4.0 * damping * angle, rel=1e-4)
    assert np.isfinite(mode.steps(np.ones(2), 1e-15, np.ones((1, 2)))).all()


@pytest.mark.parametrize("steps", [0, 1, 40])
def test_a_mode_has_its_rms_from_the_start_on(steps: int) -> None:
    """Five standard errors; the axes move in phase along the stated direction."""
    n = 20_000
    effects = ArmEffects(modes=(VibrationMode(12.0, 0.05, DIRECTION),))
    generator = np.random.default_rng(steps)
    state = cold(effects, generator.standard_normal((n, effects.draws_at_start)))
    for _ in range(steps):
        draws = generator.standard_normal((n, effects.draws_per_step))
        state = step(effects, state, 0.01, draws)
    moved = displacement(effects, state)
    np.testing.assert_allclose(
        moved.std(axis=0), np.abs(DIRECTION), rtol=5.0 / np.sqrt(2 * n), atol=1e-20
    )
    np.testing.assert_allclose(moved[:, 1], -0.5 * moved[:, 0], rtol=1e-12)
    np.testing.assert_allclose(moved[:, 4], 15.0 * moved[:, 0], rtol=1e-12)


def spectrum(effects: ArmEffects, rate_Hz: float) -> tuple[FloatArray, FloatArray]:
    """Frequencies and mean spectrum of the displacement along x; about 1300 averages a bin."""
    n, samples = 200, 4096
    generator = np.random.default_rng(8)
    state = cold(effects, generator.standard_normal((n, effects.draws_at_start)))
    record = np.empty((n, samples))
    for k in range(samples):
        draws = generator.standard_normal((n, effects.draws_per_step))
        state = step(effects, state, 1.0 / rate_Hz, draws)
        record[:, k] = displacement(effects, state)[:, 0]
    frequency, power = welch(record, rate_Hz, nperseg=1024, axis=-1)
    return frequency, power.mean(axis=0)


def test_the_spectrum_of_a_mode_is_that_of_a_driven_oscillator() -> None:
    """Every bin within 5.5 standard errors (2.8 percent each), their mean within 2 percent."""
    f0, zeta = 12.0, 0.2
    frequency, power = spectrum(ArmEffects(modes=(VibrationMode(f0, zeta, 2e-6 * ONES),)), 256.0)
    band = (frequency > 1.0) & (frequency < 40.0)
    ratio = frequency[band] / f0
    theory = 4e-12 * 4.0 * zeta / (np.pi * f0 * ((1 - ratio**2) ** 2 + (2 * zeta * ratio) ** 2))
    np.testing.assert_allclose(power[band], theory, rtol=0.155)
    assert (power[band] / theory).mean() == pytest.approx(1.0, abs=0.02)


def test_two_modes_resonate_each_at_its_own_frequency() -> None:
    """A quarter of a hertz is one bin."""
    modes = (VibrationMode(9.0, 0.01, ONES), VibrationMode(31.0, 0.01, ONES))
    frequency, power = spectrum(ArmEffects(modes=modes), 256.0)
    low, high = frequency < 20.0, frequency >= 20.0
    assert frequency[low][power[low].argmax()] == pytest.approx(9.0, abs=0.25)
    assert frequency[high][power[high].argmax()] == pytest.approx(31.0, abs=0.25)
    assert power.sum() * frequency[1] == pytest.approx(2.0, rel=0.1)


def test_many_steps_at_once_are_those_steps_one_by_one() -> None:
    effects = ArmEffects(
        (ThermalDrift(3.0, DIRECTION), ThermalDrift(0.1, 2.0 * DIRECTION)),
        1e-6 * ONES,
        (VibrationMode(12.0, 0.05, DIRECTION), VibrationMode(31.0, 0.01, 1e-6 * ONES)),
    )
    generator = np.random.default_rng(5)
    state = cold(effects, generator.standard_normal((3, effects.draws_at_start)))
    draws = generator.standard_normal((20, 3, effects.draws_per_step))
    path = displacement(effects, steps(effects, state, 0.02, draws))
    for k in range(20):
        state = step(effects, state, 0.02, draws[k])
        np.testing.assert_allclose(path[k], displacement(effects, state), atol=1e-18)
