"""The sampler, where the answer is known: Gaussian likelihoods within a wide prior."""

import math
from collections.abc import Callable

import numpy as np
import pytest
from scipy.stats import kstest

from controllers.contact_pose.hypotheses import Prior
from controllers.contact_pose.population import Evaluate, Population, effective_share, take_in
from simulator.checks import FloatArray
from tests.controllers.contact_pose.cases import PRIOR, finish

MIDDLE = np.array([0.0, 0.0, 0.0, 0.0, 7e3, 8e-6, 0.2])
LogLikelihood = Callable[[FloatArray], FloatArray]
"""Of hypotheses (n, 7), each reading a column: (n, T)."""


def shares(hypotheses: FloatArray) -> FloatArray:
    """From the prior's middle, by its width."""
    return (hypotheses - MIDDLE) / PRIOR.widths


def after(each: LogLikelihood, count: int, n: int, seed: int, moves: int = 3) -> Population:
    """The population that has taken in `count` readings, one after the other."""
    generator = np.random.default_rng(seed)
    population = Population(PRIOR.drawn(n, generator), np.zeros(n))
    for number in range(1, count + 1):

        def evaluate(hypotheses: FloatArray, number: int = number) -> tuple[FloatArray, FloatArray]:
            columns = each(hypotheses)[:, :number]
            return columns[:, :-1].sum(axis=1), columns[:, -1]

        rest = evaluate(population.hypotheses)[1]
        finish(take_in(population, rest, evaluate, PRIOR, moves, generator))
    return population


class LinearReadings:
    """Each measures one direction in the space of parameters, with normal noise."""

    def __init__(self, seed: int, count: int, noise: float) -> None:
        rng = np.random.default_rng(seed)
        directions = rng.standard_normal((count, 7))
        directions /= np.linalg.norm(directions, axis=1, keepdims=True)
        self.truth = rng.uniform(-0.1, 0.1, 7)
        deviations = noise * np.exp(rng.uniform(-1.0, 1.0, count))
        self._rows = directions / deviations[:, np.newaxis]
        self._read = self._rows @ self.truth + rng.standard_normal(count)
        self.covariance = np.linalg.inv(self._rows.T @ self._rows)
        self.mean = self.covariance @ self._rows.T @ self._read

    def __call__(self, hypotheses: FloatArray) -> FloatArray:
        return -0.5 * (shares(hypotheses) @ self._rows.T - self._read) ** 2


@pytest.mark.parametrize(
    "noise",
    [0.02, pytest.param(0.002, marks=pytest.mark.slow), 2e-4],
    ids=["wide", "mid", "narrow"],
)
def test_follows_the_closed_form(noise: float) -> None:
    """In the posterior's own units: unit covariance, mean at 0; however narrow it is."""
    off, spread = [], []
    for seed in range(4):
        readings = LinearReadings(seed, 20, noise)
        found = after(readings, 20, 1024, seed)
        to_units = np.linalg.inv(np.linalg.cholesky(readings.covariance))
        units = (shares(found.hypotheses) - readings.mean) @ to_units.T
        mean = found.weights @ units
        off.append(mean)
        spread.append((units - mean).T @ (found.weights[:, np.newaxis] * (units - mean)))
    assert np.sqrt(np.mean(np.square(off))) < 0.2
    np.testing.assert_allclose(np.mean(spread, axis=0), np.eye(7), rtol=0, atol=0.2)


@pytest.mark.slow
def test_the_truth_is_anywhere_in_the_belief() -> None:
    """Its rank among the hypotheses is uniform, over truths drawn from what is believed."""
    ranks = []
    for seed in range(40):
        readings = LinearReadings(seed, 12, 0.01)
        found = after(readings, 12, 512, seed)
        ranks.append(found.weights @ (shares(found.hypotheses) < readings.truth))
    assert kstest(np.ravel(ranks), "uniform").pvalue > 0.001
    central = np.mean((np.array(ranks) > 0.05) & (np.array(ranks) < 0.95))
    # 280 pairs, hardly correlated: three binomial deviations of 0.018, and the sampler's own error.
    assert 0.82 < central < 0.96


def test_keeps_both_modes() -> None:
    """A sharp likelihood with two equal peaks in the offset, 200 deviations apart."""

    def each(hypotheses: FloatArray) -> FloatArray:
        x = shares(hypotheses)[:, 0]
        peaks = [-0.5 * ((x - peak) / 0.002) ** 2 for peak in (-0.2, 0.2)]
        log_likelihood: FloatArray = np.logaddexp(*peaks)[:, np.newaxis]
        return log_likelihood

    right = []
    for seed in range(20):
        found = after(each, 1, 512, seed)
        x = shares(found.hypotheses)[:, 0]
        assert (np.abs(np.abs(x) - 0.2) < 0.015).all()
        right.append(float(found.weights @ (x > 0.0)))
    assert min(right) > 0.2
    assert max(right) < 0.8
    assert np.mean(right) == pytest.approx(0.5, abs=0.1)


def test_a_reading_that_rules_out_nearly_all_ends_in_bounded_time() -> None:
    """Even one that no share of the population could follow; there are at most 131 stages."""
    generator, pauses = np.random.default_rng(8), 0
    population = Population(PRIOR.drawn(64, generator), np.zeros(64))

    def evaluate(hypotheses: FloatArray) -> tuple[FloatArray, FloatArray]:
        return np.zeros(len(hypotheses)), 1e30 * generator.standard_normal(len(hypotheses))

    rest = evaluate(population.hypotheses)[1]
    for _ in take_in(population, rest, evaluate, PRIOR, 1, generator):
        pauses += 1
        # Of each stage: one after resampling, one after its move.
        assert pauses <= 2 * 131
    assert pauses > 200


def test_the_last_share_is_what_the_others_left() -> None:
    """One reading that only the first hypothesis survives: all shares but the last are the least.

    A millionth of it, then a tenth of what has been taken in.
    """
    generator = np.random.default_rng(9)
    population = Population(PRIOR.drawn(8, generator), np.zeros(8))
    ruled_out = np.array([0.0, *[-1e30] * 7])

    def evaluate(hypotheses: FloatArray) -> tuple[FloatArray, FloatArray]:
        return np.zeros(8), ruled_out

    finish(take_in(population, ruled_out, evaluate, PRIOR, 1, generator))
    taken, share = 0.0, 1e-6
    while taken + share < 1.0:
        taken += share
        share = max(1e-6, 0.1 * taken)
    np.testing.assert_allclose(population.log_weights[1:] / -1e30, 1.0 - taken, rtol=1e-9)


def test_a_parameter_that_all_agree_on_still_moves() -> None:
    """Moves are differences of members, and of these there is none."""
    generator = np.random.default_rng(10)
    population = Population(PRIOR.drawn(64, generator), np.zeros(64))
    population.hypotheses[:, 6] = 0.2

    def evaluate(hypotheses: FloatArray) -> tuple[FloatArray, FloatArray]:
        return np.zeros(64), -0.5 * (shares(hypotheses)[:, 0] / 0.01) ** 2

    rest = evaluate(population.hypotheses)[1]
    finish(take_in(population, rest, evaluate, PRIOR, 3, generator))
    off = np.abs(shares(population.hypotheses)[:, 6])
    assert 0.0 < off.max() < 1e-3


def test_resampling_finds_a_member_where_rounded_weights_do_not_add_up_to_one() -> None:
    class Latest:
        """The last number that a generator can draw."""

        def random(self) -> float:
            return math.nextafter(1.0, 0.0)

    population = Population(np.arange(70.0).reshape(10, 7), np.zeros(10))
    assert np.cumsum(population.weights)[-1] < 1.0
    rows = population.resampled(10, Latest())  # type: ignore[arg-type]  # all that is asked of it
    np.testing.assert_array_equal(rows[-1], population.hypotheses[-1])


def test_no_hypothesis_leaves_the_prior() -> None:
    """The likelihood peaks at a corner of the prior, so moves often end outside."""

    def each(hypotheses: FloatArray) -> FloatArray:
        column: FloatArray = -0.5 * ((shares(hypotheses)[:, 4:5] - 0.5) / 0.05) ** 2
        return column

    found = after(each, 1, 512, 1)
    assert PRIOR.holds(found.hypotheses).all()
    # Half a normal distribution: its mean lies sqrt(2/pi) deviations within.
    mean = float(found.weights @ shares(found.hypotheses)[:, 4])
    assert mean == pytest.approx(0.5 - math.sqrt(2.0 / math.pi) * 0.05, abs=0.006)


def test_moves_leave_a_flat_likelihood_flat() -> None:
    """Taken in with a likelihood that must be tempered and is then undone: the prior is left."""
    generator = np.random.default_rng(4)
    population = Population(PRIOR.drawn(2048, generator), np.zeros(2048))

    def sharp(hypotheses: FloatArray) -> FloatArray:
        column: FloatArray = -0.5 * (shares(hypotheses)[:, 5] / 0.1) ** 2
        return column

    def there(hypotheses: FloatArray) -> tuple[FloatArray, FloatArray]:
        return np.zeros(len(hypotheses)), sharp(hypotheses)

    def back(hypotheses: FloatArray) -> tuple[FloatArray, FloatArray]:
        return sharp(hypotheses), -sharp(hypotheses)

    steps: tuple[Evaluate, ...] = (there, back)
    for evaluate in steps:
        rest = evaluate(population.hypotheses)[1]
        finish(take_in(population, rest, evaluate, PRIOR, 8, generator))
    rows = shares(population.resampled(1000, generator))
    for column in (4, 5, 6):
        edges = np.histogram(rows[:, column], bins=5, range=(-0.5, 0.5))[0]
        assert np.abs(edges - 200).max() < 60


def test_a_weak_reading_only_weighs() -> None:
    """Half of the population stays effective, so nothing is resampled or moved."""
    generator = np.random.default_rng(5)
    drawn = PRIOR.drawn(100, generator)
    population = Population(drawn.copy(), np.zeros(100))
    rest = 0.1 * generator.standard_normal(100)

    def unused(hypotheses: FloatArray) -> tuple[FloatArray, FloatArray]:
        raise AssertionError

    finish(take_in(population, rest, unused, PRIOR, 3, generator))
    assert population.hypotheses.tobytes() == drawn.tobytes()
    np.testing.assert_array_equal(population.log_weights, rest)


def test_it_pauses_after_each_evaluation() -> None:
    generator = np.random.default_rng(6)
    population = Population(PRIOR.drawn(64, generator), np.zeros(64))
    evaluated = []

    def evaluate(hypotheses: FloatArray) -> tuple[FloatArray, FloatArray]:
        evaluated.append(len(hypotheses))
        return np.zeros(len(hypotheses)), -0.5 * (shares(hypotheses)[:, 0] / 0.01) ** 2

    rest = evaluate(population.hypotheses)[1]
    evaluated.clear()
    counts = [len(evaluated) for _ in take_in(population, rest, evaluate, PRIOR, 3, generator)]
    # Of each stage: once after resampling, then once for each move.
    assert counts[:4] == [1, 2, 3, 4]
    assert len(counts) % 4 == 0


@pytest.mark.parametrize("seed", [0, 1])
def test_known_parameters_stay_known(seed: int) -> None:
    known = Prior(10e-6, 0.0, (4e3, 4e3), (1e-5, 1e-5), (0.2, 0.2))
    generator = np.random.default_rng(seed)
    population = Population(known.drawn(256, generator), np.zeros(256))

    def evaluate(hypotheses: FloatArray) -> tuple[FloatArray, FloatArray]:
        return np.zeros(len(hypotheses)), -0.5 * ((hypotheses[:, 0] - 3e-6) / 1e-7) ** 2

    rest = evaluate(population.hypotheses)[1]
    finish(take_in(population, rest, evaluate, known, 3, generator))
    found = population.hypotheses
    np.testing.assert_array_equal(found[:, 2:], np.tile([0, 0, 4e3, 1e-5, 0.2], (256, 1)))
    assert population.weights @ found[:, 0] == pytest.approx(3e-6, abs=3e-8)
    assert len(np.unique(found[:, 0])) > 100


def test_weights_add_up_to_one() -> None:
    population = Population(np.zeros((3, 7)), np.array([-1e4, -1e4 + math.log(2.0), -2e4]))
    np.testing.assert_allclose(population.weights, [1 / 3, 2 / 3, 0.0], rtol=1e-12)


@pytest.mark.parametrize(
    ("weights", "share"),
    [([1, 1, 1, 1], 1.0), ([1, 0, 0, 0], 0.25), ([1, 1, 0, 0], 0.5), ([3, 1, 0, 0], 0.4)],
)
def test_effective_share(weights: list[float], share: float) -> None:
    with np.errstate(divide="ignore"):
        log_weights = np.log(np.array(weights, dtype=float)) - 5e3
    assert effective_share(log_weights) == pytest.approx(share, rel=1e-9)


def test_resampling_is_systematic_and_unbiased() -> None:
    """Each is taken its expected number of times, rounded down or up; on average exactly."""
    weights = np.array([0.05, 0.4, 0.25, 0.3])
    hypotheses = np.repeat(np.arange(4.0)[:, np.newaxis], 7, axis=1)
    population = Population(hypotheses, np.log(weights) + 3.0)
    generator, n = np.random.default_rng(7), 10
    counts = np.array(
        [
            np.bincount(population.resampled(n, generator)[:, 0].astype(int), minlength=4)
            for _ in range(4000)
        ]
    )
    assert (counts.sum(axis=1) == n).all()
    assert (np.abs(counts - n * weights) < 1.0).all()
    # Deviation of a mean of 4000 numbers of which half are 0 and half 1: 0.008.
    np.testing.assert_allclose(counts.mean(axis=0), n * weights, rtol=0, atol=0.03)


def test_resampling_never_takes_what_is_ruled_out() -> None:
    population = Population(np.arange(5.0)[:, np.newaxis] * np.ones(7), np.zeros(5))
    population.log_weights[[0, 4]] = -1e3
    taken = {
        float(row[0])
        for s in range(50)
        for row in population.resampled(9, np.random.default_rng(s))
    }
    assert taken == {1.0, 2.0, 3.0}
