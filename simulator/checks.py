"""Refusal of invalid input: a check returns the accepted value or raises `ValueError`."""

import math

import numpy as np
import numpy.typing as npt

FloatArray = npt.NDArray[np.float64]


def positive(name: str, value: float) -> float:
    """Return `value` if it is finite and above zero."""
    if not (math.isfinite(value) and value > 0.0):
        raise ValueError(f"{name} is {value!r}; it must be finite and greater than 0")
    return value


def non_negative(name: str, value: float) -> float:
    """Return `value` if it is finite and at least zero."""
    if not (math.isfinite(value) and value >= 0.0):
        raise ValueError(f"{name} is {value!r}; it must be finite and at least 0")
    return value


def finite_array(name: str, value: npt.ArrayLike, last_axis: int) -> FloatArray:
    """Return `value` as float64 if its shape is (..., last_axis) and every entry is finite."""
    array = np.asarray(value, dtype=np.float64)
    if array.ndim == 0 or array.shape[-1] != last_axis:
        raise ValueError(f"{name} has shape {array.shape}; it must be (..., {last_axis})")
    if not np.logical_and.reduce(np.isfinite(array), axis=None):
        first = tuple(int(i) for i in np.argwhere(~np.isfinite(array))[0])
        raise ValueError(f"{name} is {array[first]} at index {first}; every entry must be finite")
    return array


def read_only(array: FloatArray) -> FloatArray:
    """Return `array`, locked against writing."""
    array.setflags(write=False)
    return array
