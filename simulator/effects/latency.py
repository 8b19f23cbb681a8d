"""Latency: a value is read some samples after it was taken."""

import math

import numpy as np

from simulator.checks import FloatArray, non_negative


def full_of(value: FloatArray, latency_samples: float) -> FloatArray:
    """The past values (..., L, A) of a source that has long had this value (..., A).

    L is the latency, rounded up. Raises `ValueError` for a latency below zero or not finite.
    """
    depth = math.ceil(non_negative("latency_samples", latency_samples))
    return np.repeat(value[..., np.newaxis, :], depth, axis=-2)


def delayed(
    value: FloatArray, past: FloatArray, latency_samples: float
) -> tuple[FloatArray, FloatArray]:
    """The value of `latency_samples` ago, shape (..., A), and the new past, shape (..., L, A).

    `value` is the newest one, `past` holds those before it, the newest first, and has the L of
    `full_of`. A latency between two whole numbers is interpolated linearly.
    """
    line = np.concatenate([value[..., np.newaxis, :], past], axis=-2)
    whole = math.floor(latency_samples)
    late, rest = line[..., whole, :], latency_samples - whole
    if rest > 0.0:
        late = (1.0 - rest) * late + rest * line[..., whole + 1, :]
    return late, line[..., :-1, :]
