"""The compiled generator against numpy's own, bit for bit."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from learning.environments.philox import normals, uniforms, words

WORDS = st.integers(0, 2**64 - 1)
COUNTERS = st.tuples(WORDS, WORDS, WORDS, WORDS)
KEYS = st.tuples(WORDS, WORDS)


def numpy_philox(counter: tuple[int, ...], key: tuple[int, ...]) -> np.random.Philox:
    """numpy's generator, set such that its next four words are those of `counter`."""
    whole = sum(word << (64 * place) for place, word in enumerate(counter))
    before = (whole - 1) % 2**256
    parts = [(before >> (64 * place)) % 2**64 for place in range(4)]
    return np.random.Philox(
        counter=np.array(parts, dtype=np.uint64), key=np.array(key, dtype=np.uint64)
    )


def arguments(counter: tuple[int, ...], key: tuple[int, ...]) -> list[np.uint64]:
    return [np.uint64(word) for word in (*counter, *key)]


@settings(deadline=None)  # the first example may compile
@given(COUNTERS, KEYS)
def test_words_are_those_of_numpy(counter: tuple[int, ...], key: tuple[int, ...]) -> None:
    expected = numpy_philox(counter, key).random_raw(4)
    np.testing.assert_array_equal(words(*arguments(counter, key)), expected)


@settings(deadline=None)  # the first example may compile
@given(COUNTERS, KEYS)
def test_uniform_numbers_are_those_of_numpy(counter: tuple[int, ...], key: tuple[int, ...]) -> None:
    expected = np.random.Generator(numpy_philox(counter, key)).random(4)
    np.testing.assert_array_equal(uniforms(*arguments(counter, key)), expected)


def test_normal_numbers_are_standard_normal_and_uncorrelated() -> None:
    draws = np.array([normals(*arguments((n, 0, 0, 0), (3, 4))) for n in range(20_000)])
    # Bounds of about five standard errors: of a mean, a variance, a fourth moment, a correlation.
    assert np.abs(draws.mean(axis=0)).max() < 0.035
    assert np.abs(draws.var(axis=0) - 1.0).max() < 0.05
    assert np.abs((draws**4).mean(axis=0) - 3.0).max() < 0.35
    off_diagonal = np.corrcoef(draws.T) - np.eye(4)
    assert np.abs(off_diagonal).max() < 0.035


def test_normal_numbers_are_finite_for_any_word() -> None:
    draws = [normals(*arguments((n, 1, 1, 0), (n, 0))) for n in range(2_000)]
    assert np.isfinite(draws).all()
