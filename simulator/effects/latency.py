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


def queued(values: FloatArray, past: FloatArray) -> FloatArray:
    """The values of T samples behind those before them, shape (L + T, ..., A), the oldest first.

    `values` has shape (T, ..., A); `past`, shape (..., L, A), is that of `full_of` or `left_over`.
    """
    if past.shape[-2] == 0:
        return values
    last = past.ndim - 1
    return np.concatenate([past.transpose(last - 1, *range(last - 1), last), values])


def delayed(queue: FloatArray, latency_samples: float) -> FloatArray:
    """What is read at each of the T samples, shape (T, ..., A), of a queue (L + T, ..., A).

    A latency between two whole numbers is interpolated linearly.
    """
    depth = math.ceil(latency_samples)
    older = queue[: len(queue) - depth]
    newer_share = depth - latency_samples
    if newer_share == 0.0:
        return older
    return (1.0 - newer_share) * older + newer_share * queue[1 : len(queue) - depth + 1]


def left_over(queue: FloatArray, read: int, latency_samples: float) -> FloatArray:
    """The past (..., L, A), the oldest first, once `read` of the T samples have been read."""
    late = queue[read : read + math.ceil(latency_samples)]
    last = late.ndim - 1
    return late.transpose(*range(1, last), 0, last)
