"""Distributions against their closed forms, and refusal of what is none."""

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats

from simulator.randomisation.distributions import (
    Choice,
    Constant,
    Distribution,
    LogUniform,
    TruncatedNormal,
    Uniform,
    drawn,
)

NAN, INF = float("nan"), float("inf")
CONTINUOUS = [
    (Uniform(-2.0, 5.0), stats.uniform(-2.0, 7.0)),
    (LogUniform(2e3, 12e3), stats.loguniform(2e3, 12e3)),
    (TruncatedNormal(1.0, 2.0, 0.0, 7.0), stats.truncnorm(-0.5, 3.0, 1.0, 2.0)),
    (TruncatedNormal(0.0, 1.0, 0.0, 9.0), stats.truncnorm(0.0, 9.0)),
]


@pytest.mark.parametrize(("distribution", "reference"), CONTINUOUS, ids=lambda d: type(d).__name__)
def test_draws_have_the_stated_distribution(distribution: Distribution, reference: object) -> None:
    """Kolmogorov-Smirnov at a level of about 1e-6; all draws lie within the ends."""
    draws = drawn(distribution, 20_000, [np.random.default_rng(6)])[0]
    assert stats.kstest(draws, reference.cdf).pvalue > 1e-6  # type: ignore[attr-defined]
    low, high = reference.support()  # type: ignore[attr-defined]
    assert low <= draws.min() < draws.max() <= high


def test_one_of_some_values_each_as_likely() -> None:
    draws = drawn(Choice((3.0, 1.0, 3.0)), 30_000, [np.random.default_rng(1)])[0]
    values, counts = np.unique(draws, return_counts=True)
    assert values.tolist() == [1.0, 3.0]
    assert abs(counts[0] - 10_000) < 5.0 * np.sqrt(30_000 * 2.0 / 9.0)


def test_a_constant_is_itself() -> None:
    assert drawn(Constant(4e3), 2, [np.random.default_rng(1)]).tolist() == [[4e3, 4e3]]


numbers = st.floats(-1e3, 1e3)


@given(st.lists(numbers, min_size=3, max_size=3, unique=True), st.floats(1e-3, 1e3))
def test_quantiles_rise_from_the_low_to_the_high_end(ends: list[float], std: float) -> None:
    low, mean, high = sorted(ends)
    shares = np.append(np.linspace(0.0, 1.0, 9, endpoint=False), 1.0 - 2.0**-53)
    some: list[Distribution] = [Uniform(low, high), TruncatedNormal(mean, std, low, high)]
    if low > 0.0:
        some.append(LogUniform(low, high))
    for distribution in some:
        values = distribution.quantile(shares)
        assert (np.diff(values) >= 0.0).all()
        assert low <= values[0]
        assert values[-1] <= high
    assert Choice((low, mean, high)).quantile(shares)[[0, -1]].tolist() == [low, high]


def test_environments_are_their_own_and_parameters_take_the_same_numbers() -> None:
    """Row i is what generator i gives alone; what follows is the same whatever came before."""
    after = []
    for distribution, _ in CONTINUOUS:
        generators = [np.random.default_rng(seed) for seed in (4, 9, 2)]
        rows = drawn(distribution, 5, generators)
        alone = drawn(distribution, 5, [np.random.default_rng(9)])
        np.testing.assert_array_equal(rows[1], alone[0])
        after.append([generator.random() for generator in generators])
    for seed_and_constant in (Constant(1.0), Choice((1.0, 2.0))):
        generators = [np.random.default_rng(seed) for seed in (4, 9, 2)]
        drawn(seed_and_constant, 5, generators)
        after.append([generator.random() for generator in generators])
    assert all(numbers == after[0] for numbers in after)
    assert drawn(Uniform(0.0, 1.0), 3, []).shape == (0, 3)


CASES: list[tuple[Callable[[], object], str]] = [
    (lambda: Constant(NAN), r"Constant.value is nan; it must be finite"),
    (lambda: Uniform(1.0, 1.0), r"Uniform is from 1.0 to 1.0; low must be less than high"),
    (lambda: Uniform(0.0, INF), r"Uniform is from 0.0 to inf"),
    (lambda: LogUniform(0.0, 1.0), r"LogUniform.low is 0.0; it must be finite and greater than 0"),
    (lambda: LogUniform(2.0, 1.0), r"LogUniform is from 2.0 to 1.0"),
    (lambda: TruncatedNormal(0.0, 0.0, -1.0, 1.0), r"TruncatedNormal.std is 0.0"),
    (lambda: TruncatedNormal(0.0, 1.0, 1.0, -1.0), r"TruncatedNormal is from 1.0 to -1.0"),
    (
        lambda: TruncatedNormal(2.0, 1.0, -1.0, 1.0),
        r"TruncatedNormal.mean is 2.0; it must lie between -1.0 and 1.0",
    ),
    (lambda: Choice(()), r"Choice.values is empty; it must hold at least one value"),
    (lambda: Choice((1.0, NAN)), r"Choice.values\[1\] is nan"),
]


@pytest.mark.parametrize(("call", "message"), CASES, ids=[message for _, message in CASES])
def test_refused(call: Callable[[], object], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        call()
