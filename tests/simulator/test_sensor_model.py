"""Force sensor: bias, noise, quantisation and saturation."""

import numpy as np

from simulator.sensor import SensorModel, measure

TRUE = np.array([0.02, -0.03, 0.4, 1e-5, -2e-5, 3e-6])


def readings(model: SensorModel, n: int = 1, seed: int = 5) -> tuple[np.ndarray, np.ndarray]:
    return measure(np.tile(TRUE, (n, 1)), model, np.random.default_rng(seed))


def test_the_default_is_an_ideal_sensor() -> None:
    measured, saturated = readings(SensorModel())
    np.testing.assert_array_equal(measured[0], TRUE)
    assert saturated.tolist() == [False]


def test_bias_and_noise_have_the_stated_statistics() -> None:
    bias = (1e-3, -2e-3, 3e-3, 1e-6, 2e-6, -3e-6)
    n = 40_000
    measured, _ = readings(SensorModel(noise_std=(2e-3, 5e-6), bias=bias), n)
    error = measured - TRUE - bias
    std = np.array([2e-3] * 3 + [5e-6] * 3)
    assert (np.abs(error.mean(axis=0)) < 5.0 * std / np.sqrt(n)).all()
    np.testing.assert_allclose(error.std(axis=0), std, rtol=5.0 / np.sqrt(2 * n))
    correlation = np.corrcoef(error.T) - np.eye(6)
    assert np.abs(correlation).max() < 5.0 / np.sqrt(n)
    lagged = (error[1:] * error[:-1]).mean(axis=0) / std**2
    assert np.abs(lagged).max() < 5.0 / np.sqrt(n)


def test_readings_are_multiples_of_the_resolution() -> None:
    model = SensorModel(noise_std=(1e-2, 1e-5), resolution=(1e-3, 2e-6))
    counts = readings(model, 500)[0] / np.array([1e-3] * 3 + [2e-6] * 3)
    np.testing.assert_allclose(counts, np.rint(counts), atol=1e-9)
    assert len(np.unique(np.rint(counts[:, 0]))) > 10


def test_quantisation_rounds_to_the_nearest_step() -> None:
    measured, _ = readings(SensorModel(resolution=(0.015, 0.0)))
    np.testing.assert_allclose(measured[0], [0.015, -0.03, 0.405, 1e-5, -2e-5, 3e-6], atol=1e-17)


def test_saturation_clips_and_is_reported_per_row() -> None:
    wrenches = np.array([TRUE, 10.0 * TRUE, -10.0 * TRUE, TRUE])
    wrenches[3, 4] = 1.0
    model = SensorModel(range=(1.0, 1e-3))
    measured, saturated = measure(wrenches, model, np.random.default_rng(0))
    assert saturated.tolist() == [False, True, True, True]
    assert measured[1, 2] == 1.0
    assert measured[2, 2] == -1.0
    assert measured[3, 4] == 1e-3
    np.testing.assert_array_equal(measured[0], TRUE)
    exactly = np.zeros((1, 6))
    exactly[0, 0] = 1.0
    assert measure(exactly, model, np.random.default_rng(0))[1].tolist() == [True]


def test_the_generator_decides() -> None:
    model = SensorModel(noise_std=(1e-3, 1e-6))
    np.testing.assert_array_equal(readings(model, 3)[0], readings(model, 3)[0])
    assert (readings(model, 3)[0] != readings(model, 3, seed=6)[0]).all()
