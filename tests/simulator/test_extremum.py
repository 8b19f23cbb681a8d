"""Extremum on a circle: the exact search, and the discretised one that serves as its reference."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from simulator import extremum
from simulator.checks import FloatArray
from simulator.contact import solve
from simulator.extremum import discretised_search, exact_search
from simulator.geometry import Hole, Part, Shaft

sizes = st.floats(min_value=0.0, max_value=1e3, allow_subnormal=False)


def objective(m: FloatArray, b: FloatArray, e: FloatArray) -> FloatArray:
    return 2.0 * (m[0] * e[0] + m[1] * e[1]) + b * e[0] * e[0]


def reference(m: FloatArray, b: FloatArray) -> FloatArray:
    """Maximum by bisection of the multiplier in extended precision, for m1 != 0."""
    a, c, b = (np.abs(v).astype(np.longdouble) for v in (m[0], m[1], b))
    low, high = np.maximum(a, c - b), a + c
    for _ in range(200):
        middle = (low + high) / 2
        outside = (a / middle) ** 2 + (c / (middle + b)) ** 2 > 1
        low, high = np.where(outside, middle, low), np.where(outside, high, middle)
    e = np.stack([a / low, c / (low + b)])
    return objective(np.stack([a, c]), b, e / np.sqrt((e * e).sum(axis=0)))


def awkward_problems(n: int) -> tuple[FloatArray, FloatArray]:
    """Ratios of m1, m2, b over many decades, with clusters where the two maxima merge."""
    rng = np.random.default_rng(7)
    b = 10.0 ** rng.uniform(-12, 0, n)
    a, c = 10.0 ** rng.uniform(-30, 0, n), 10.0 ** rng.uniform(-12, 0, n)
    near = slice(0, n // 2)
    c[near] = b[near] * (1 + rng.choice([-1, 1], n // 2) * 10.0 ** rng.uniform(-16, 0, n // 2))
    a[near] = b[near] * 10.0 ** rng.uniform(-24, 1, n // 2)
    cusp, angle = slice(n // 2, 3 * n // 4), rng.uniform(0, np.pi / 2, n // 4)
    a[cusp], c[cusp] = b[cusp] * np.cos(angle) ** 3, b[cusp] * np.sin(angle) ** 3
    return rng.choice([-1.0, 1.0], (2, n)) * np.stack([a, c]), b


def test_maximum_is_exact_to_rounding_for_the_worst_ratios() -> None:
    m, b = awkward_problems(100_000)
    found = objective(m, b, exact_search.direction(m, b))
    error = np.abs(found - reference(m, b)) / (np.abs(m).sum(axis=0) + b)
    assert error.max() < 1e-15


def test_more_newton_steps_change_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    m, b = awkward_problems(20_000)
    usual = exact_search.direction(m, b)
    monkeypatch.setattr(extremum, "NEWTON_STEPS", 12)
    more = exact_search.direction(m, b)
    scale = np.abs(m).sum(axis=0) + b
    assert (np.abs(objective(m, b, usual) - objective(m, b, more)) / scale).max() < 1e-15
    # Where the two maxima merge the direction itself is only defined to about sqrt(rounding).
    assert np.abs(usual - more).max() < 1e-7
    apart = np.abs(m[0]) > 1e-3 * b
    assert apart.sum() > 5000
    assert np.abs(usual - more)[:, apart].max() < 1e-12


@given(sizes, sizes, sizes, st.sampled_from([-1.0, 1.0]), st.sampled_from([-1.0, 1.0]))
def test_no_point_of_a_dense_circle_is_better(
    a: float, c: float, b: float, sign_a: float, sign_c: float
) -> None:
    m = np.array([[sign_a * a], [sign_c * c]])
    e = exact_search.direction(m, np.array([b]))
    angle = np.linspace(0.0, 2.0 * np.pi, 2000)
    others = objective(m, b, np.stack([np.cos(angle), np.sin(angle)]))
    assert abs(np.hypot(e[0], e[1])[0] - 1.0) < 1e-15
    assert others.max() <= objective(m, b, e)[0] + 1e-15 * (a + b + c)


@pytest.mark.parametrize(
    ("m", "b", "expected"),
    [
        ((0.0, 0.0), 0.0, (1.0, 0.0)),
        ((0.0, 0.0), 2.0, (1.0, 0.0)),
        ((0.0, 0.6), 1.0, (0.8, 0.6)),
        ((0.0, -0.6), 1.0, (0.8, -0.6)),
        ((0.0, 3.0), 1.0, (0.0, 1.0)),
        ((0.0, -3.0), 0.0, (0.0, -1.0)),
        ((-3.0, 4.0), 0.0, (-0.6, 0.8)),
        ((-2.0, 0.0), 5.0, (-1.0, 0.0)),
    ],
)
def test_special_cases(m: tuple[float, float], b: float, expected: tuple[float, float]) -> None:
    e = exact_search.direction(np.array(m)[:, np.newaxis], np.array([b]))
    np.testing.assert_allclose(e[:, 0], expected, rtol=0.0, atol=1e-15)


def test_merging_maxima_without_a_first_component() -> None:
    e = exact_search.direction(np.array([[0.0], [1.0]]), np.array([1.0]))
    np.testing.assert_allclose(e[:, 0], [0.0, 1.0], rtol=0.0, atol=1e-6)


def test_the_discretised_search_takes_the_best_of_its_points() -> None:
    m = np.array([[0.0, 0.0, -1.0, 0.7], [1.0, -1.0, 0.0, 0.8]])
    e = discretised_search(4).direction(m, np.zeros(4))
    expected = np.array([[0.0, 0.0, -1.0, 0.0], [1.0, -1.0, 0.0, 1.0]])
    np.testing.assert_allclose(e, expected, rtol=0.0, atol=1e-15)


def test_the_discretised_search_converges_at_second_order_to_the_exact_one() -> None:
    part = Part((Hole(1.01e-3, 5e-4), Hole(1.01e-3, 5e-4, 1.5e-3)))
    shaft = Shaft(1e-3, 4e-3)
    rng = np.random.default_rng(11)
    poses = rng.uniform(-1, 1, (400, 5)) * [1e-5, 1e-5, 1e-3, 0.02, 0.02] + [0, 0, 1.5e-3, 0, 0]
    exact = solve(part, shaft, poses, np.zeros(3)).overlap
    points = np.array([48, 96, 192, 384, 768])
    errors = []
    for n in points:
        searched = solve(part, shaft, poses, np.zeros(3), search=discretised_search(int(n))).overlap
        # A point that is not the deepest shows less overlap, never more.
        assert (searched <= exact + 1e-16).all()
        errors.append(np.abs(searched - exact).mean())
    slope = np.polyfit(np.log(points), np.log(errors), 1)[0]
    assert slope == pytest.approx(-2.0, abs=0.1)
    assert errors[0] > 1e-10


def test_a_circle_of_two_points_is_refused() -> None:
    with pytest.raises(ValueError, match="points is 2; a circle is cut into at least 3"):
        discretised_search(2)
