"""Populations of hypotheses that follow a likelihood: tempering, resampling and random moves.

A sequential Monte Carlo sampler for parameters that do not change (Chopin, "A sequential particle
filter method for static models", Biometrika 2002). The likelihood is taken in by shares, each so
large that half of the population stays effective; after each share the population is resampled and
moved at random by differences of its own members (ter Braak, "A Markov chain Monte Carlo version
of the genetic algorithm differential evolution", 2006). All move at once: that leaves the
distribution as it is but for an error that falls with the size of the population.
"""

import math
from collections.abc import Callable, Generator, Iterator
from dataclasses import dataclass

import numpy as np

from controllers.contact_pose.hypotheses import Prior
from simulator.checks import FloatArray

Evaluate = Callable[[FloatArray], tuple[FloatArray, FloatArray]]
"""Maps hypotheses (n, 7) to log-likelihoods (n,): of what has been taken in, and of the rest."""

EFFECTIVE = 0.5
"""Share of the population that stays effective."""
_FIRST_SHARE, _GROWTH = 1e-6, 0.1
"""Least share of the likelihood that is taken in at once: of all of it, and of what has been taken
in. So there are at most 131 stages, also where one reading rules out nearly all hypotheses."""
_BISECTIONS = 25
_JITTER = 1e-5
"""Of a parameter's range, added to each move so that no direction is ever lost. Far below what is
ever known of a parameter: a larger one would throw most moves out of a narrow distribution."""
_SCALES = 0.3, 1.2
"""Of the moves, times the best one for a normal distribution."""


@dataclass(slots=True, eq=False)
class Population:
    """Weighted hypotheses; changed in place."""

    hypotheses: FloatArray
    """(n, 7)."""
    log_weights: FloatArray
    """(n,), up to a constant."""

    @property
    def weights(self) -> FloatArray:
        """Weights (n,) that add up to 1."""
        weights = np.exp(self.log_weights - np.max(self.log_weights))
        shares: FloatArray = weights / np.sum(weights)
        return shares

    def resampled(self, n: int, generator: np.random.Generator) -> FloatArray:
        """`n` hypotheses of equal weight, shape (n, 7): systematic resampling."""
        places = (generator.random() + np.arange(n)) / n
        rows = np.searchsorted(np.cumsum(self.weights), places)
        return self.hypotheses[np.minimum(rows, len(self.hypotheses) - 1)]


def effective_share(log_weights: FloatArray) -> float:
    """Effective number of the weighted members over their number."""
    weights = np.exp(log_weights - np.max(log_weights))
    return float(np.sum(weights) ** 2 / np.sum(weights * weights) / len(weights))


def take_in(
    population: Population,
    rest: FloatArray,
    evaluate: Evaluate,
    prior: Prior,
    moves: int,
    generator: np.random.Generator,
    piece: int | None = None,
) -> Iterator[None]:
    """Take the log-likelihood `rest` (n,) into the population.

    Pauses after the evaluation of so many hypotheses as a `piece` has, else of all of them.
    """
    left = 1.0
    while True:
        share = _share(population.log_weights, rest, left)
        population.log_weights = population.log_weights + share * rest
        left -= share
        if left <= 0.0:
            return
        hypotheses = population.resampled(len(rest), generator)
        taken, rest = yield from in_pieces(evaluate, hypotheses, piece)
        for _ in range(moves):
            proposed = _proposed(hypotheses, prior, generator)
            possible = prior.holds(proposed)
            proposed[~possible] = hypotheses[~possible]
            new_taken, new_rest = yield from in_pieces(evaluate, proposed, piece)
            gain = new_taken - taken + (1.0 - left) * (new_rest - rest)
            accepted = possible & (np.log(generator.random(len(rest))) < gain)
            hypotheses = np.where(accepted[:, np.newaxis], proposed, hypotheses)
            taken, rest = np.where(accepted, new_taken, taken), np.where(accepted, new_rest, rest)
        population.hypotheses = hypotheses
        population.log_weights = np.zeros(len(rest))


def in_pieces(
    evaluate: Evaluate, hypotheses: FloatArray, piece: int | None
) -> Generator[None, None, tuple[FloatArray, FloatArray]]:
    """What `evaluate` says of the `hypotheses`; pauses after so many as a `piece` has."""
    taken, rest = np.empty(len(hypotheses)), np.empty(len(hypotheses))
    size = piece or len(hypotheses)
    for first in range(0, len(hypotheses), size):
        some = slice(first, first + size)
        taken[some], rest[some] = evaluate(hypotheses[some])
        yield
    return taken, rest


def _share(log_weights: FloatArray, rest: FloatArray, left: float) -> float:
    """The largest share of `rest`, at most `left`, that leaves enough of them effective."""
    if effective_share(log_weights + left * rest) >= EFFECTIVE:
        return left
    low, high = 0.0, left
    for _ in range(_BISECTIONS):
        middle = 0.5 * (low + high)
        if effective_share(log_weights + middle * rest) >= EFFECTIVE:
            low = middle
        else:
            high = middle
    return min(max(low, _FIRST_SHARE, _GROWTH * (1.0 - left)), left)


def _proposed(hypotheses: FloatArray, prior: Prior, generator: np.random.Generator) -> FloatArray:
    """Each moved by the difference of two others, never of itself: so the way back is as likely."""
    n, count = hypotheses.shape
    order = generator.permutation(n)
    difference = np.empty_like(hypotheses)
    difference[order] = hypotheses[np.roll(order, 1)] - hypotheses[np.roll(order, 2)]
    low, high = np.log(_SCALES)
    scale = 2.38 / math.sqrt(2.0 * count) * np.exp(generator.uniform(low, high, (n, 1)))
    jitter = _JITTER * prior.widths * generator.standard_normal((n, count))
    return np.asarray(hypotheses + scale * difference + jitter)
