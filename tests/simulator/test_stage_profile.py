"""Trapezoidal motion: limits, end point and closed forms."""

import numpy as np
import numpy.typing as npt
import pytest
from hypothesis import given
from hypothesis import strategies as st

from simulator.plant import Trapezoid, braking

distances = st.one_of(st.just(0.0), st.floats(1e-9, 1e-1))
speeds = st.one_of(st.just(0.0), st.floats(1e-7, 1e-1))
limits = st.floats(1e-6, 1e-1)
accelerations = st.floats(1e-3, 1e2)


def positions(profile: Trapezoid, times: npt.ArrayLike) -> npt.NDArray[np.float64]:
    return np.array([profile.at(float(t))[0] for t in np.asarray(times)])


def velocities(profile: Trapezoid, times: npt.ArrayLike) -> npt.NDArray[np.float64]:
    return np.array([profile.at(float(t))[1] for t in np.asarray(times)])


def test_a_long_way_has_the_closed_form_of_a_trapezoid() -> None:
    profile = Trapezoid(1e-3, 0.0, 5e-3, 0.1)
    assert profile.peak_speed_m_s == 5e-3
    assert profile.duration_s == pytest.approx(0.25)
    t = [0.0, 0.02, 0.05, 0.1, 0.2, 0.23, 0.25, 9.0]
    expected = [0.0, 2e-5, 1.25e-4, 3.75e-4, 8.75e-4, 9.8e-4, 1e-3, 1e-3]
    np.testing.assert_allclose(positions(profile, t), expected, rtol=1e-12, atol=1e-18)
    expected = [0.0, 2e-3, 5e-3, 5e-3, 5e-3, 2e-3, 0.0, 0.0]
    np.testing.assert_allclose(velocities(profile, t), expected, rtol=1e-12, atol=1e-15)


def test_a_short_way_is_a_triangle() -> None:
    profile = Trapezoid(1e-5, 0.0, 5e-3, 0.1)
    assert profile.peak_speed_m_s == pytest.approx(1e-3)
    assert profile.leg_times_s == pytest.approx((0.01, 0.0, 0.01))
    assert profile.at(0.01)[1] == pytest.approx(1e-3)


def test_a_start_above_the_limit_is_braked_down_to_it_first() -> None:
    profile = Trapezoid(1e-3, 8e-3, 5e-3, 0.1)
    assert profile.peak_speed_m_s == 5e-3
    assert profile.leg_times_s[0] == pytest.approx(0.03)
    assert profile.at(0.015)[1] == pytest.approx(6.5e-3)
    assert profile.at(profile.duration_s)[0] == 1e-3


def test_braking_takes_the_shortest_way_to_rest() -> None:
    profile = braking(5e-3, 0.1)
    assert profile.distance_m == pytest.approx(1.25e-4)
    assert profile.duration_s == pytest.approx(0.05)
    t = np.linspace(0.0, 0.05, 11)
    np.testing.assert_allclose(velocities(profile, t), 5e-3 - 0.1 * t, atol=1e-15)
    np.testing.assert_allclose(positions(profile, t), 5e-3 * t - 0.05 * t * t, atol=1e-15)
    assert braking(0.0, 1.0).duration_s == 0.0


@given(distances, speeds, limits, accelerations)
def test_limits_hold_and_the_motion_ends_at_rest(
    distance: float, start: float, limit: float, acceleration: float
) -> None:
    stopping = 0.5 * start * start / acceleration
    if stopping > distance:
        distance = stopping
    profile = Trapezoid(distance, start, limit, acceleration)
    # Evenly spaced times, with the ends of the legs and their neighbourhood.
    legs = np.cumsum((0.0, *profile.leg_times_s))
    t = np.unique(np.concatenate([np.linspace(0.0, 1.1 * legs[-1], 401), legs, legs * (1 + 1e-9)]))
    x, v = positions(profile, t), velocities(profile, t)
    dt = np.diff(t)

    assert x[0] == 0.0
    assert profile.at(0.0)[1] == pytest.approx(start if legs[-1] > 0.0 else 0.0)
    assert x[-1] == distance
    assert profile.at(profile.duration_s)[0] == pytest.approx(distance, rel=1e-12)
    assert v[-1] == 0.0
    fastest = max(start, limit)
    assert (v >= 0.0).all()
    assert v.max() <= fastest * (1 + 1e-12)
    # `dt` is a difference of times, so it is only known to their rounding.
    allowed = acceleration * (dt + 2.0 * np.spacing(t[-1])) + 1e-12 * fastest
    assert (np.abs(np.diff(v)) <= allowed).all()
    # Position is the integral of speed: it lies between the bounds of constant acceleration.
    assert (np.diff(x) >= -1e-15 * distance).all()
    mean = 0.5 * (v[1:] + v[:-1]) * dt
    assert (np.abs(np.diff(x) - mean) <= 0.25 * acceleration * dt * dt + 1e-12 * distance).all()


@given(st.floats(1e-5, 1e-1), accelerations)
def test_a_start_that_cannot_stop_in_time_is_refused(start: float, acceleration: float) -> None:
    stopping = 0.5 * start * start / acceleration
    Trapezoid(stopping, start, 1.0, acceleration)
    with pytest.raises(ValueError, match=r"distance_m is .* and must be at least that"):
        Trapezoid(0.999 * stopping, start, 1.0, acceleration)
