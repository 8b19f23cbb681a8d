"""Distributions of one number, by their quantiles."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.special import ndtr, ndtri

from simulator.checks import FloatArray, positive

Generators = Sequence[np.random.Generator]
"""One per environment."""


@dataclass(frozen=True, slots=True)
class Constant:
    """Always the same. Raises `ValueError` for a value that is not finite."""

    value: float

    def __post_init__(self) -> None:
        _finite("Constant.value", self.value)

    def quantile(self, shares: FloatArray) -> FloatArray:
        """The value, in the shape of `shares`."""
        return np.full_like(shares, self.value)


@dataclass(frozen=True, slots=True)
class Uniform:
    """Every value from `low` to `high` alike. Raises `ValueError` unless low < high."""

    low: float
    high: float

    def __post_init__(self) -> None:
        _in_order("Uniform", self.low, self.high)

    def quantile(self, shares: FloatArray) -> FloatArray:
        """The values that these shares, in [0, 1), of all values lie below; of any shape."""
        return np.minimum(self.low + (self.high - self.low) * shares, self.high)


@dataclass(frozen=True, slots=True)
class LogUniform:
    """Every ratio alike: uniform in the logarithm. Raises `ValueError` unless 0 < low < high."""

    low: float
    high: float

    def __post_init__(self) -> None:
        positive("LogUniform.low", self.low)
        _in_order("LogUniform", self.low, self.high)

    def quantile(self, shares: FloatArray) -> FloatArray:
        """The values that these shares, in [0, 1), of all values lie below; of any shape."""
        low, high = math.log(self.low), math.log(self.high)
        return np.asarray(np.clip(np.exp(low + (high - low) * shares), self.low, self.high))


@dataclass(frozen=True, slots=True)
class TruncatedNormal:
    """A normal distribution without what lies outside of [low, high].

    `mean` and `std` are those before it is cut. Raises `ValueError` unless low < high, the mean
    lies between them, and the deviation is above zero.
    """

    mean: float
    std: float
    low: float
    high: float

    def __post_init__(self) -> None:
        positive("TruncatedNormal.std", self.std)
        _in_order("TruncatedNormal", self.low, self.high)
        if not self.low <= self.mean <= self.high:
            raise ValueError(
                f"TruncatedNormal.mean is {self.mean!r}; "
                f"it must lie between {self.low!r} and {self.high!r}"
            )

    def quantile(self, shares: FloatArray) -> FloatArray:
        """The values that these shares, in [0, 1), of all values lie below; of any shape."""
        below, upto = (ndtr((end - self.mean) / self.std) for end in (self.low, self.high))
        values = self.mean + self.std * ndtri(below + (upto - below) * shares)
        return np.asarray(np.clip(values, self.low, self.high))


@dataclass(frozen=True, slots=True)
class Choice:
    """One of some values, each as likely; one that stands twice is twice as likely.

    Raises `ValueError` where there is none, or one that is not finite.
    """

    values: tuple[float, ...]

    def __post_init__(self) -> None:
        if not self.values:
            raise ValueError("Choice.values is empty; it must hold at least one value")
        for index, value in enumerate(self.values):
            _finite(f"Choice.values[{index}]", value)

    def quantile(self, shares: FloatArray) -> FloatArray:
        """The values in the order given, an equal share of [0, 1) to each; of any shape."""
        return np.array(self.values)[(shares * len(self.values)).astype(np.int64)]


Distribution = Constant | Uniform | LogUniform | TruncatedNormal | Choice


def drawn(distribution: Distribution, count: int, generators: Generators) -> FloatArray:
    """`count` independent draws for each environment, shape (n, count).

    Row i takes `count` uniform numbers from generator i alone, whatever the distribution.
    """
    shares = np.empty((len(generators), count))
    for row, generator in zip(shares, generators, strict=True):
        generator.random(out=row)
    return distribution.quantile(shares)


def _finite(name: str, value: float) -> None:
    if not math.isfinite(value):
        raise ValueError(f"{name} is {value!r}; it must be finite")


def _in_order(name: str, low: float, high: float) -> None:
    if not (math.isfinite(low) and math.isfinite(high) and low < high):
        raise ValueError(f"{name} is from {low!r} to {high!r}; low must be less than high")


NONE = Constant(0.0)
"""Always zero: what is off."""
