"""Checks and sums of arrays that the effects share.

The six axes are x, y, z and the rotations about them: [m, rad] for motion, [N, N*m] for a wrench.
"""

import numpy as np
import numpy.typing as npt

from simulator.checks import FloatArray, finite_array, read_only

AXES = 6


def none_per_axis() -> FloatArray:
    """Zero for each axis, shape (6,), read-only: the size of an effect that is off."""
    return read_only(np.zeros(AXES))


def axis_values(name: str, value: npt.ArrayLike) -> FloatArray:
    """A read-only copy of `value`, shape (..., 6).

    Raises `ValueError`, which names the parameter, for another shape or an entry that is not
    finite.
    """
    return read_only(finite_array(name, value, AXES).copy())


def axis_sizes(name: str, value: npt.ArrayLike) -> FloatArray:
    """As `axis_values`; an entry below zero is refused too."""
    sizes = axis_values(name, value)
    if (sizes < 0.0).any():
        first = tuple(int(i) for i in np.argwhere(sizes < 0.0)[0])
        raise ValueError(f"{name} is {sizes[first]} at index {first}; it must be at least 0")
    return sizes


def of_shape(name: str, value: npt.ArrayLike, shape: tuple[int, ...]) -> FloatArray:
    """Return `value` as float64 if it has exactly this shape and every entry is finite.

    Raises `ValueError`, which names the argument, otherwise.
    """
    array = finite_array(name, value, shape[-1])
    if array.shape != shape:
        raise ValueError(f"{name} has shape {array.shape}; it must be {shape}")
    return array


def demand_batch(name: str, own: tuple[int, ...], batch: tuple[int, ...]) -> None:
    """Raise `ValueError` unless the leading shape of some sizes is that of a batch, or ().

    Sizes of more environments than a state has would let those share its draws.
    """
    if own and own != batch:
        raise ValueError(f"{name} is of a batch of shape {own}; the state's is {batch}")


def sum_rows(terms: FloatArray) -> FloatArray:
    """Sum over the second last axis, (..., K, A) to (..., A), row after row.

    `numpy.sum` orders its additions by the memory layout, which depends on the batch; this does
    not.
    """
    total = np.zeros(terms.shape[:-2] + terms.shape[-1:])
    for k in range(terms.shape[-2]):
        total += terms[..., k, :]
    return total


def on_grid(value: FloatArray, step: FloatArray) -> FloatArray:
    """The multiple of `step` nearest to `value`, entry by entry; `value` itself where it is 0.

    `value` has shape (..., 6), `step` the same or one that broadcasts to it. A tie goes to the even
    multiple.
    """
    if step.all():
        return np.asarray(np.rint(value / step) * step)
    divisor = np.where(step > 0.0, step, 1.0)
    return np.where(step > 0.0, np.rint(value / divisor) * divisor, value)
