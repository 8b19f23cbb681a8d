"""First-order approach: what is left of a step falls by the factor e in each time constant."""

import numpy as np

from simulator.checks import FloatArray


def approach(
    start: FloatArray, end: FloatArray, elapsed_s: float | FloatArray, time_constant_s: float
) -> FloatArray:
    """Where a first-order system is, `elapsed_s` after it left `start` for `end`.

    Any shapes that broadcast, in any unit. Exactly `start` at time 0 and exactly `end` after an
    infinite time; a time constant of 0 arrives at once. Two approaches in a row are one of the
    summed time. Raises `ValueError` for a time that is negative or not a number.
    """
    if not np.all(np.greater_equal(elapsed_s, 0.0)):
        raise ValueError(f"elapsed_s is {elapsed_s!r}; it must be at least 0")
    if time_constant_s == 0.0:
        return end
    left = np.exp(-np.asarray(elapsed_s) / time_constant_s)
    return np.asarray(left * start + (1.0 - left) * end)
