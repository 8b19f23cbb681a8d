"""Standard normal draws for a batch of environments."""

from collections.abc import Sequence

import numpy as np

from simulator.checks import FloatArray


def standard_normals(generators: Sequence[np.random.Generator], count: int) -> FloatArray:
    """`count` draws from each generator, shape (n, count): row i comes from generator i alone.

    Raises `ValueError` for a negative count.
    """
    if count < 0:
        raise ValueError(f"count is {count}; it must be at least 0")
    draws = np.empty((len(generators), count))
    for row, generator in zip(draws, generators, strict=True):
        generator.standard_normal(out=row)
    return draws
