"""1/f drift: its spectrum against the law, and its discretisation."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.signal import welch

from simulator.checks import FloatArray
from simulator.effects.flicker import Ladder, flicker

ONES = np.ones(6)


def sampled_spectrum(ladder: Ladder, frequency: FloatArray, rate_Hz: float) -> FloatArray:
    """One-sided spectrum of the sampled ladder: a sum of first-order autoregressions."""
    exponent = -2.0 * np.pi * np.array(ladder.corners_Hz)[:, np.newaxis] / rate_Hz
    sine = np.sin(np.pi * frequency / rate_Hz)
    gain = np.expm1(exponent) ** 2 + 4.0 * np.exp(exponent) * sine**2
    rungs = 2.0 / rate_Hz * -np.expm1(2.0 * exponent) / gain
    return ladder.rms[0] ** 2 * rungs.sum(axis=0)


@given(st.floats(1e-4, 1.0), st.floats(1.001, 1e5), st.floats(20.0, 1e4))
def test_the_ladder_is_as_close_to_the_law_as_stated(
    low: float, span: float, oversampling: float
) -> None:
    """Within 5 percent over a decade or more, within 8 over less."""
    high = low * span
    frequency = np.geomspace(low, high, 100)
    power = sampled_spectrum(flicker(3e-4 * ONES, (low, high)), frequency, oversampling * high)
    np.testing.assert_allclose(power, 9e-8 / frequency, rtol=0.05 if span >= 10.0 else 0.08)


def test_the_ladder_levels_off_below_and_falls_faster_above() -> None:
    ladder = flicker(ONES, (0.01, 1.0))
    power = sampled_spectrum(ladder, np.array([1e-5, 1e-4, 100.0, 1000.0]), 1e5)
    assert power[0] == pytest.approx(power[1], rel=0.1)
    assert power[2] / power[3] == pytest.approx(100.0, rel=0.1)


def test_simulated_drift_has_the_spectrum_of_its_formula() -> None:
    """Bands of 12 bins, 1100 averages a bin: five standard errors are 5.5 percent or less.

    The law itself is held within those and the stated ripple of the ladder.
    """
    rate_Hz, n, samples, band_Hz = 100.0, 64, 4096, (0.05, 5.0)
    ladder = flicker(2e-3 * ONES, band_Hz)
    generator = np.random.default_rng(4)
    rungs = generator.standard_normal((n, len(ladder.corners_Hz), 6))
    record = np.empty((samples, n, 6))
    for k in range(samples):
        rungs = ladder.steps(rungs, 1.0 / rate_Hz, generator.standard_normal((1, *rungs.shape)))[1]
        record[k] = ladder.drift(rungs)
    frequency, spectra = welch(record, rate_Hz, nperseg=2048, axis=0)
    power = spectra.mean(axis=(1, 2))
    inside = np.flatnonzero((frequency > 0.25) & (frequency < band_Hz[1]))
    for bins in np.array_split(inside, len(inside) // 12):
        formula = sampled_spectrum(ladder, frequency[bins], rate_Hz)
        assert (power[bins] / formula).mean() == pytest.approx(1.0, abs=0.055)
        assert (power[bins] * frequency[bins] / 4e-6).mean() == pytest.approx(1.0, abs=0.105)


@given(st.floats(1e-4, 10.0))
def test_a_step_keeps_the_variance_and_decays_by_the_corner(dt_s: float) -> None:
    ladder = Ladder((0.01, 0.1, 3.0), ONES)
    ones, none = np.ones((3, 6)), np.zeros((3, 6))
    keep = ladder.steps(ones, dt_s, none[np.newaxis])[1]
    kick = ladder.steps(none, dt_s, ones[np.newaxis])[1]
    np.testing.assert_allclose(keep**2 + kick**2, 1.0, rtol=1e-12)
    expected = [math.exp(-2.0 * math.pi * corner * dt_s) for corner in (0.01, 0.1, 3.0)]
    np.testing.assert_allclose(keep[:, 0], expected, rtol=1e-12)


def test_the_drift_has_the_variance_of_its_rungs() -> None:
    """Seven rungs of 2 mN: the root of 28 mN^2, within five standard errors."""
    n = 20_000
    ladder = Ladder(tuple(np.geomspace(0.01, 10.0, 7).tolist()), 2e-3 * ONES)
    drift = ladder.drift(np.random.default_rng(1).standard_normal((n, 7, 6)))
    np.testing.assert_allclose(drift.std(axis=0), 2e-3 * math.sqrt(7), rtol=5.0 / np.sqrt(2 * n))


def test_the_corners_are_evenly_spaced_beyond_the_band() -> None:
    corners = np.array(flicker(ONES, (0.01, 1.0)).corners_Hz)
    assert corners[[0, -1]] == pytest.approx([0.001, 10.0])
    np.testing.assert_allclose(np.diff(np.log10(corners)), 0.5, rtol=1e-9)
