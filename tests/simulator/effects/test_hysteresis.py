"""Play operator and Prandtl-Ishlinskii hysteresis: the properties that define them."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from simulator.checks import FloatArray
from simulator.effects.hysteresis import PrandtlIshlinskii, play

places = st.floats(-1e-3, 1e-3)
paths = st.lists(places, min_size=1, max_size=12)
gaps = st.one_of(st.just(0.0), st.floats(1e-9, 1e-3))

MODEL = PrandtlIshlinskii(
    np.outer([0.0, 2e-5, 6e-5, 2e-4], np.ones(6)), np.outer([0.1, 0.2, 0.1, 0.15], np.ones(6))
)


def followed(path: list[float], gap: float, held: float = 0.0) -> list[float]:
    outputs = []
    state = np.array(held)
    for place in path:
        state = play(np.array(place), state, np.array(gap))
        outputs.append(float(state))
    return outputs


def outputs(model: PrandtlIshlinskii, path: list[float]) -> FloatArray:
    """Output on the first axis for each place of the path, from rest at 0."""
    plays = model.relaxed(np.zeros(6))
    values = []
    for place in path:
        output, plays = model.follow(np.full(6, place), plays)
        values.append(output[0])
    return np.array(values)


def test_play_crosses_its_gap_at_a_reversal() -> None:
    path = [1e-5, 3e-5, 2.5e-5, 2.1e-5, 1e-5, 1.5e-5, 4e-5]
    expected = [0.5e-5, 2.5e-5, 2.5e-5, 2.5e-5, 1.5e-5, 1.5e-5, 3.5e-5]
    assert followed(path, 1e-5) == pytest.approx(expected, rel=1e-12)


@given(paths, gaps)
def test_play_stays_within_half_its_gap(path: list[float], gap: float) -> None:
    for place, output in zip(path, followed(path, gap), strict=True):
        assert place - 0.5 * gap <= output <= place + 0.5 * gap


@given(paths)
def test_play_without_a_gap_is_the_identity(path: list[float]) -> None:
    assert followed(path, 0.0) == path


@given(paths, gaps, st.integers(2, 9))
def test_play_is_independent_of_the_rate(path: list[float], gap: float, count: int) -> None:
    """Places in between, and waiting, change nothing."""
    slow = [0.0]
    for place in path:
        between = np.linspace(slow[-1], place, count)
        slow += [*np.clip(between, *sorted((slow[-1], place))).tolist(), place, place]
    assert followed(slow, gap)[-1] == followed(path, gap)[-1]


@given(paths, gaps, places, places)
def test_play_returns_after_a_full_loop(
    path: list[float], gap: float, low: float, high: float
) -> None:
    once = followed([*path, low, high, low], gap)
    twice = followed([*path, low, high, low, high, low], gap)
    assert twice[-2:] == once[-2:]


@given(paths, places, gaps)
def test_play_is_symmetric(path: list[float], held: float, gap: float) -> None:
    mirrored = followed([-place for place in path], gap, -held)
    assert [-output for output in mirrored] == followed(path, gap, held)


@given(paths)
def test_without_plays_the_output_is_the_input(path: list[float]) -> None:
    np.testing.assert_array_equal(outputs(PrandtlIshlinskii(), path), path)


def test_weights_may_sum_to_one_however_the_sum_is_rounded() -> None:
    """0.15 + 0.35 + 0.5 is 1; in floating point 0.7 + 0.1 + 0.2 is below, 1 + 2e-16 above."""
    for weights in ([0.15, 0.35, 0.5], [0.7, 0.1, 0.2], [1.0, 2.3e-16, 0.0]):
        rows = np.outer(weights, np.ones(6))
        assert PrandtlIshlinskii(1e-5 * np.ones((3, 6)), rows).weights.shape == (3, 6)
    assert PrandtlIshlinskii().weights.shape == (0, 6)


def test_the_first_way_up_and_a_reversal_have_their_closed_forms() -> None:
    """Half of the input is followed late, by half a gap of 20 um; the other half at once."""
    model = PrandtlIshlinskii(np.full((1, 6), 2e-5), np.full((1, 6), 0.5))
    path = [0.5e-5, 1e-5, 4e-5, 3e-5, 2e-5, 0.0]
    expected = [0.25e-5, 0.5e-5, 3.5e-5, 3e-5, 2.5e-5, 0.5e-5]
    np.testing.assert_allclose(outputs(model, path), expected, rtol=1e-12)


@given(paths)
def test_the_output_is_off_by_at_most_the_weighted_half_gaps(path: list[float]) -> None:
    bound = 0.5 * (0.2 * 2e-5 + 0.1 * 6e-5 + 0.15 * 2e-4)
    assert (np.abs(outputs(MODEL, path) - path) <= bound * (1 + 1e-12)).all()


@given(paths, paths, places, places)
def test_minor_loops_between_the_same_ends_are_congruent(
    one: list[float], other: list[float], low: float, high: float
) -> None:
    """Whatever came before, the loop has the same shape; only its height differs."""
    middle = 0.5 * (low + high)
    loop = [low, high, low, middle, high, middle, low]
    shapes = []
    for before in (one, other):
        part = outputs(MODEL, [*before, *loop])[-5:]
        shapes.append(part - part[0])
    np.testing.assert_allclose(shapes[0], shapes[1], atol=1e-18)
    assert abs(shapes[0][-1]) < 1e-18


@given(paths, places)
def test_a_larger_turn_wipes_out_the_memory_of_smaller_ones(path: list[float], end: float) -> None:
    """After the greatest and the least place, those are all that is remembered."""
    np.testing.assert_allclose(
        outputs(MODEL, [2e-3, -2e-3, *path, 2e-3, -2e-3, end])[-1],
        outputs(MODEL, [2e-3, -2e-3, end])[-1],
        atol=1e-18,
    )


@given(places, st.floats(0.0, 1e-3))
def test_the_output_does_not_go_back_while_the_input_goes_on(start: float, way: float) -> None:
    values = outputs(MODEL, [start, *np.linspace(start, start + way, 20).tolist()])
    assert (np.diff(values) >= -1e-18).all()
