"""Stage: grid, settling, repeatability, and the order in which the effects act."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from simulator.effects.approach import approach
from simulator.effects.arrays import on_grid
from simulator.effects.hysteresis import PrandtlIshlinskii
from simulator.effects.stage import StageEffects, at_rest, move

ONES = np.ones(6)
HOME = np.zeros(6)
places = st.floats(-1e-2, 1e-2)
steps = st.floats(1e-9, 1e-4)
times = st.floats(0.0, 10.0)


@given(places, steps)
def test_the_grid_is_idempotent_and_at_most_half_a_step_away(place: float, step: float) -> None:
    once = on_grid(np.array(place), np.array(step))
    assert abs(once - place) <= 0.5 * step + 1e-15 * abs(place)
    assert on_grid(once, np.array(step)) == once
    assert float(once / step) == pytest.approx(round(float(once / step)), abs=1e-6)


@given(places)
def test_no_grid_changes_nothing(place: float) -> None:
    assert on_grid(np.array(place), np.array(0.0)) == place


@given(places, places, st.floats(1e-3, 10.0))
def test_an_approach_is_exact_at_both_ends_of_time(
    start: float, end: float, constant: float
) -> None:
    here, there = np.array(start), np.array(end)
    assert approach(here, there, 0.0, constant) == start
    assert approach(here, there, math.inf, constant) == end
    assert approach(here, there, 1e-9, 0.0) == end


def test_an_approach_leaves_one_in_e_after_each_time_constant() -> None:
    left = [1.0 - float(approach(HOME, ONES, t, 0.2)[0]) for t in (0.2, 0.4, 1.0)]
    assert left == pytest.approx([math.exp(-1), math.exp(-2), math.exp(-5)], rel=1e-12)


@given(places, places, times, times, st.floats(0.1, 10.0))
def test_two_approaches_in_a_row_are_one(
    start: float, end: float, first: float, second: float, constant: float
) -> None:
    between = approach(np.array(start), np.array(end), first, constant)
    twice = approach(between, np.array(end), second, constant)
    once = approach(np.array(start), np.array(end), first + second, constant)
    assert float(twice) == pytest.approx(float(once), abs=1e-16)


@given(st.lists(st.lists(places, min_size=6, max_size=6), min_size=1, max_size=4), times)
def test_an_ideal_stage_goes_where_it_is_told(commands: list[list[float]], elapsed: float) -> None:
    effects = StageEffects()
    state = at_rest(effects, HOME)
    for command in commands:
        state = move(effects, command, state, elapsed, 3.0 * ONES)
        np.testing.assert_array_equal(state.position, command)


def test_the_effects_act_in_the_stated_order() -> None:
    """0.5 is 0.4 on the grid, 0.1 behind the play, 0.05 after the hysteresis, 0.06 with its error.

    Each other order of the first three ends elsewhere: at 0, 0.1 or 0.4.
    """
    effects = StageEffects(
        minimum_step=0.4 * ONES,
        backlash=0.6 * ONES,
        hysteresis=PrandtlIshlinskii(np.full((1, 6), 0.4), np.full((1, 6), 0.5)),
        repeatability=0.005 * ONES,
        settling_time_constant_s=2.0,
    )
    start = at_rest(effects, HOME)
    place = move(effects, 0.5 * ONES, start, math.inf, 2.0 * ONES)
    np.testing.assert_allclose(place.position, 0.06, rtol=1e-12)
    on_its_way = move(effects, 0.5 * ONES, start, 2.0, 2.0 * ONES)
    np.testing.assert_allclose(on_its_way.position, 0.06 * (1 - math.exp(-1)), rtol=1e-12)


def test_a_motion_starts_where_the_platform_is_and_gears_keep_their_own_place() -> None:
    """Broken off after ln 2 time constants, the platform is half-way; the gears have arrived."""
    effects = StageEffects(backlash=2e-6 * ONES, settling_time_constant_s=1.0)
    half_way = move(effects, 1.1e-5 * ONES, at_rest(effects, HOME), math.log(2.0), HOME)
    np.testing.assert_allclose(half_way.position, 5e-6, rtol=1e-12)
    still = move(effects, 1.0e-5 * ONES, half_way, math.inf, HOME)
    np.testing.assert_allclose(still.position, 1e-5, rtol=1e-12)
    further = move(effects, 0.8e-5 * ONES, half_way, math.log(2.0), HOME)
    np.testing.assert_allclose(further.position, 0.5 * (5e-6 + 9e-6), rtol=1e-12)


def test_the_place_reached_scatters_as_stated() -> None:
    """Per axis a normal deviation about the command; bounds of five standard errors."""
    n = 20_000
    sigma = np.array([1e-7, 2e-7, 3e-7, 1e-6, 2e-6, 0.0])
    effects = StageEffects(repeatability=sigma)
    draws = np.random.default_rng(11).standard_normal((n, 6))
    state = move(effects, np.full((n, 6), 1e-4), at_rest(effects, np.zeros((n, 6))), 0.0, draws)
    error = state.position - 1e-4
    assert (np.abs(error.mean(axis=0)) <= 5.0 * sigma / np.sqrt(n)).all()
    np.testing.assert_allclose(error.std(axis=0), sigma, rtol=5.0 / np.sqrt(2 * n), atol=1e-18)
    assert effects.draws_per_motion == 6


def test_rest_is_in_the_middle_of_every_gap() -> None:
    effects = StageEffects(
        backlash=2e-6 * ONES,
        hysteresis=PrandtlIshlinskii(np.full((2, 6), 4e-6), np.full((2, 6), 0.25)),
    )
    state = at_rest(effects, 1e-3 * ONES)
    for sign in (1.0, -1.0):
        far = move(effects, 1e-3 * ONES + sign * 1e-4, state, 0.0, HOME)
        np.testing.assert_allclose(far.position, 1e-3 + sign * 9.8e-5, rtol=1e-12)
    with pytest.raises(ValueError, match="read-only"):
        state.position[0] = 0.0
