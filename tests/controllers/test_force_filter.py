"""The Kalman-filtered force stream, on data whose truth is known."""

from collections.abc import Sequence

import numpy as np
import pytest
from filterpy.common import Q_discrete_white_noise
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.stats import chi2

from controllers.force_filter import ForceFilter
from controllers.messages import FilterHealth
from controllers.repeats import Repeats
from controllers.settings import FilterSettings
from drivers.contract.errors import TareRefusedError
from drivers.contract.messages import ForceSample, SensorStatus, Wrench

MS = 1_000_000
NOISE: Wrench = (1e-3, 1e-3, 1e-3, 5e-6, 5e-6, 5e-6)
SETTINGS = FilterSettings.model_validate(
    {
        "force_acceleration_std_N_s2": 100.0,
        "torque_acceleration_std_Nm_s2": 1.0,
        "gate_probability": 0.99999,
        "rejections_max": 2,
        "tare_samples": 100,
        "bias_change_max_mN": 5.0,
    }
)


def new_filter() -> ForceFilter:
    return ForceFilter(SETTINGS, NOISE, 1e-3)


def sample_at(ms: float, wrench: Sequence[float], **changes: SensorStatus) -> ForceSample:
    stamp = round(ms * MS)
    fx, fy, fz, tx, ty, tz = (float(v) for v in wrench)
    return ForceSample(stamp, stamp, round(ms), (fx, fy, fz, tx, ty, tz), **changes)


def noisy(generator: np.random.Generator, loads: NDArray[np.float64]) -> NDArray[np.float64]:
    return loads + np.array(NOISE) * generator.standard_normal(loads.shape)


def tared(seed: int = 0) -> ForceFilter:
    force_filter = new_filter()
    quiet = noisy(np.random.default_rng(seed), np.zeros((100, 6)))
    window = [sample_at(ms, wrench) for ms, wrench in enumerate(quiet)]
    for sample in window:
        force_filter.update(sample)
    force_filter.tare(window, is_clear=True)
    return force_filter


def test_innovations_are_chi_square_on_data_of_the_filters_own_model() -> None:
    """Mean over 4000 samples and tail share of a chi-square with six degrees of freedom."""
    generator = np.random.default_rng(1)
    kick = np.array([100.0] * 3 + [1.0] * 3)
    noise = np.linalg.cholesky(Q_discrete_white_noise(2, 1e-3, 1.0) + 1e-24 * np.eye(2))
    state = np.zeros((2, 6))
    move = np.array([[1.0, 1e-3], [0.0, 1.0]])
    force_filter = new_filter()
    nis = []
    for ms in range(4500):
        estimate = force_filter.update(sample_at(ms, noisy(generator, state[0])))
        nis.append(estimate.nis)
        state = move @ state + noise @ generator.standard_normal((2, 6)) * kick
    settled = np.array(nis[500:])
    assert 6.0 * len(settled) == pytest.approx(
        settled.sum(), abs=4.0 * np.sqrt(2.0 * 6.0 * len(settled))
    )
    beyond = (settled > chi2.ppf(0.95, 6)).mean()
    assert beyond == pytest.approx(0.05, abs=4.0 * np.sqrt(0.05 * 0.95 / len(settled)))


def test_the_stated_deviation_is_the_real_one_at_rest() -> None:
    generator = np.random.default_rng(2)
    force_filter = tared()
    errors, estimate = [], None
    for ms in range(100, 20_100):
        estimate = force_filter.update(sample_at(ms, noisy(generator, np.zeros(6))))
        errors.append(estimate.wrench)
    assert estimate is not None
    real = np.array(errors[1000:]).std(axis=0)
    assert (real < np.array(NOISE)).all()
    assert (real <= 1.05 * np.array(estimate.std)).all(), "the filter is not overconfident"


def test_steady_state_equals_the_full_filter() -> None:
    """Against filterpy's own full recursion, run beside it on the same samples."""
    from filterpy.kalman import KalmanFilter

    generator = np.random.default_rng(3)
    force_filter = new_filter()
    full = KalmanFilter(dim_x=2, dim_z=1)
    full.F = np.array([[1.0, 1e-3], [0.0, 1.0]])
    full.H = np.array([[1.0, 0.0]])
    full.Q = Q_discrete_white_noise(2, 1e-3, 100.0**2)
    full.R = np.array([[1e-6]])
    loads = noisy(generator, np.linspace(0.0, 0.1, 2000)[:, np.newaxis] * np.ones(6))
    full.x = np.array([[loads[0, 0]], [0.0]])
    full.P = np.diag([1e-6, 10.0**2])
    for ms, load in enumerate(loads):
        estimate = force_filter.update(sample_at(ms, load))
        if ms > 0:
            full.predict()
            full.update(load[0])
            assert estimate.health is FilterHealth.UNTARED
            assert estimate.wrench[0] == pytest.approx(float(full.x[0, 0]), abs=1e-8)
            assert estimate.rate[0] == pytest.approx(float(full.x[1, 0]), abs=1e-5)
            assert estimate.std[0] == pytest.approx(float(np.sqrt(full.P[0, 0])), rel=1e-4)


def test_a_ramp_is_followed_with_its_rate() -> None:
    force_filter = tared()
    generator = np.random.default_rng(4)
    estimate = None
    for ms in range(100, 400):
        true = np.array([1e-3 * (ms - 100), 0, 0, 0, 0, 0])
        estimate = force_filter.update(sample_at(ms, noisy(generator, true)))
    assert estimate is not None
    assert estimate.wrench[0] == pytest.approx(0.299, abs=2e-3)
    assert estimate.rate[0] == pytest.approx(1.0, abs=0.2)


@pytest.mark.parametrize("axis", range(6))
@pytest.mark.parametrize("sign", [-1.0, 1.0])
def test_a_spike_of_one_or_two_samples_is_gated(axis: int, sign: float) -> None:
    generator = np.random.default_rng(5)
    force_filter = tared()
    before = None
    for ms in range(100, 160):
        before = force_filter.update(sample_at(ms, noisy(generator, np.zeros(6))))
    spike = np.zeros(6)
    spike[axis] = sign * 50.0 * NOISE[axis]
    for ms in (160, 161):
        hit = force_filter.update(sample_at(ms, spike + noisy(generator, np.zeros((1, 6)))[0]))
        assert hit.health is FilterHealth.REJECTED
        assert abs(hit.wrench[axis]) < 3.0 * NOISE[axis]
        assert before is not None
        assert hit.std[axis] > before.std[axis], "the uncertainty grows while nothing is learnt"
    after = force_filter.update(sample_at(162, noisy(generator, np.zeros(6))))
    assert after.health is FilterHealth.OK
    assert abs(after.wrench[axis]) < 3.0 * NOISE[axis]


def test_a_jump_that_stays_is_believed_at_the_third_sample() -> None:
    generator = np.random.default_rng(6)
    force_filter = tared()
    for ms in range(100, 200):
        force_filter.update(sample_at(ms, noisy(generator, np.zeros(6))))
    load = np.array([0.080, 0, 0, 0, 0, 0])
    healths = []
    for ms in range(200, 203):
        estimate = force_filter.update(sample_at(ms, noisy(generator, load)))
        healths.append(estimate.health)
    assert healths == [FilterHealth.REJECTED, FilterHealth.REJECTED, FilterHealth.OK]
    assert estimate.wrench[0] == pytest.approx(0.080, abs=5e-3)


def test_a_stuck_sensor_is_reported_at_its_third_equal_sample() -> None:
    force_filter = tared()
    frozen = (1e-3, 2e-3, 0.0, 0.0, 0.0, 0.0)
    stuck = [
        FilterHealth.STUCK in force_filter.update(sample_at(ms, frozen)).health
        for ms in range(100, 106)
    ]
    assert stuck == [False, False, True, True, True, True]
    moved = force_filter.update(sample_at(106, (1.1e-3, 2e-3, 0.0, 0.0, 0.0, 0.0)))
    assert FilterHealth.STUCK not in moved.health


def stuck_after(axis: int, frozen_from_ms: int, until_ms: int) -> list[int]:
    """The times [ms] at which a filter calls a sensor stuck of which one axis has frozen."""
    force_filter = tared()
    generator = np.random.default_rng(7)
    times = []
    for ms in range(100, until_ms):
        wrench = noisy(generator, np.zeros((1, 6)))[0]
        if ms >= frozen_from_ms:
            wrench[axis] = 1e-6
        if FilterHealth.STUCK in force_filter.update(sample_at(ms, wrench)).health:
            times.append(ms)
    return times


@pytest.mark.parametrize("axis", range(6))
@pytest.mark.parametrize("frozen_from_ms", [210, 237, 259])
def test_one_dead_axis_is_reported_within_a_hundred_samples(axis: int, frozen_from_ms: int) -> None:
    times = stuck_after(axis, frozen_from_ms, 500)
    assert frozen_from_ms + 48 <= times[0] <= frozen_from_ms + 100
    assert times == list(range(times[0], 500)), "as long as it lasts"


@pytest.mark.parametrize(("equal_samples", "is_stuck"), [(49, False), (50, True)])
def test_fifty_equal_readings_of_one_axis_are_stuck_until_it_moves(
    equal_samples: int, is_stuck: bool
) -> None:
    force_filter = new_filter()
    generator = np.random.default_rng(7)
    healths = []
    for ms in range(equal_samples + 2):
        wrench = noisy(generator, np.zeros((1, 6)))[0]
        wrench[4] = 2e-6 if ms < equal_samples else wrench[4]
        healths.append(FilterHealth.STUCK in force_filter.update(sample_at(ms, wrench)).health)
    assert healths == [False] * 49 + [is_stuck] * (equal_samples - 49) + [False, False]


@pytest.mark.parametrize("offset", [0.0, 0.3, 0.5])
def test_a_quiet_sensor_with_coarse_readings_is_not_stuck(offset: float) -> None:
    """Five axes with noise of half their resolution, for 100 000 samples, at any load."""
    generator = np.random.default_rng(8)
    readings = np.round(generator.standard_normal((100_000, 6)) * 0.5 + offset)
    readings[:, 5] = generator.standard_normal(len(readings))
    repeats = Repeats()
    alarms = 0
    for wrench in readings.tolist():
        repeats.add(tuple(wrench))
        alarms += repeats.is_stuck
    assert alarms == 0


def test_silence_is_marked_on_the_last_estimate() -> None:
    assert new_filter().silence(5) is None
    force_filter = tared()
    last = force_filter.update(sample_at(100, NOISE))
    silent = force_filter.silence(103 * MS)
    assert silent is not None
    assert silent.health is FilterHealth.SILENT
    assert silent.wrench == last.wrench


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
def test_a_sample_that_is_no_number_does_not_harm_the_estimate(value: float) -> None:
    force_filter = tared()
    before = force_filter.update(sample_at(100, np.zeros(6)))
    broken = force_filter.update(sample_at(101, [value, 0, 0, 0, 0, 0]))
    assert broken.health is FilterHealth.REJECTED
    assert broken.wrench == before.wrench
    after = force_filter.update(sample_at(102, [1e-4, 0, 0, 0, 0, 0]))
    assert np.isfinite(after.wrench).all()
    assert after.health is FilterHealth.OK


def test_a_stamp_that_does_not_advance_restarts_the_filter() -> None:
    force_filter = tared()
    force_filter.update(sample_at(200, np.zeros(6)))
    back = force_filter.update(sample_at(150, [5e-3, 0, 0, 0, 0, 0]))
    assert back.wrench[0] == pytest.approx(5e-3, abs=1e-3)


@settings(max_examples=50)
@given(st.lists(st.floats(0.2, 20.0), min_size=2, max_size=40), st.integers(0, 2**32 - 1))
def test_irregular_sampling_stays_sane(gaps_ms: list[float], seed: int) -> None:
    force_filter = tared()
    generator = np.random.default_rng(seed)
    now = 100.0
    for gap in gaps_ms:
        now += gap
        estimate = force_filter.update(sample_at(now, noisy(generator, np.zeros(6))))
        assert np.isfinite([*estimate.wrench, *estimate.rate, *estimate.std]).all()
        assert (np.array(estimate.std) <= np.array(NOISE) * (1.0 + 1e-9)).all() or (
            FilterHealth.REJECTED in estimate.health
        )
        assert (np.abs(estimate.wrench) < 6.0 * np.array(NOISE)).all()


def window(load: NDArray[np.float64], samples: int = 100, seed: int = 7) -> list[ForceSample]:
    loads = noisy(np.random.default_rng(seed), np.broadcast_to(load, (samples, 6)))
    return [sample_at(1000 + ms, wrench) for ms, wrench in enumerate(loads)]


def test_tare_takes_the_mean() -> None:
    force_filter = new_filter()
    assert force_filter.bias == (0.0,) * 6
    bias = np.array([12e-3, -7e-3, 30e-3, 1e-5, 0, 0])
    taken = force_filter.tare(window(bias), is_clear=True)
    assert taken == force_filter.bias
    assert np.array(taken) == pytest.approx(bias, abs=0.5e-3)
    estimate = force_filter.update(sample_at(1100, bias))
    assert estimate.health is FilterHealth.OK
    assert np.abs(estimate.wrench[:3]).max() < 1e-3


def drifting() -> list[ForceSample]:
    ramp = np.linspace(0.0, 3e-3, 100)[:, np.newaxis] * np.eye(6)[0]
    loads = noisy(np.random.default_rng(8), ramp)
    return [sample_at(1000 + ms, wrench) for ms, wrench in enumerate(loads)]


def swinging() -> list[ForceSample]:
    swing = 10e-3 * np.sin(np.arange(100))[:, np.newaxis] * np.eye(6)[1]
    loads = noisy(np.random.default_rng(9), swing)
    return [sample_at(1000 + ms, wrench) for ms, wrench in enumerate(loads)]


QUIET = np.zeros(6)
SATURATED = sample_at(1100, QUIET, status=SensorStatus.SATURATED)
BROKEN = sample_at(1100, [np.nan, 0, 0, 0, 0, 0])


@pytest.mark.parametrize(
    ("samples", "is_clear", "reason"),
    [
        (window(QUIET), False, "within reach of the part"),
        (window(QUIET, 99), True, "99 samples, valid: at least 100"),
        ([*window(QUIET), SATURATED], True, "fault or saturation"),
        ([*window(QUIET), BROKEN], True, "not finite"),
        (swinging(), True, "not steady"),
        (drifting(), True, "drifts"),
        (window(np.array([5.5e-3, 0, 0, 0, 0, 0])), True, r"at most 5\.0 mN: is the sensor in"),
        (window(np.array([0, 0, -5.5e-3, 0, 0, 0])), True, r"at most 5\.0 mN: is the sensor in"),
    ],
)
def test_tare_is_refused(samples: list[ForceSample], is_clear: bool, reason: str) -> None:
    force_filter = tared()
    before = force_filter.bias
    with pytest.raises(TareRefusedError, match=reason):
        force_filter.tare(samples, is_clear)
    assert force_filter.bias == before


def test_tare_may_follow_a_small_drift_of_the_bias() -> None:
    force_filter = tared()
    force_filter.tare(window(np.array([4.5e-3, 0, 0, 0, 0, 0])), is_clear=True)
    assert force_filter.bias[0] == pytest.approx(4.5e-3, abs=0.5e-3)
