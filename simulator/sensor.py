"""Force/torque sensor: bias, white noise, quantisation and saturation."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from simulator.checks import FloatArray, finite_array, non_negative

Pair = tuple[float, float]
"""A value for the three forces [N] and one for the three torques [N*m]."""


@dataclass(frozen=True, slots=True)
class SensorModel:
    """Errors of a six-axis sensor. The defaults are an ideal one.

    `noise_std` is the standard deviation of white noise, `resolution` the quantisation step (0 for
    none), `range` the largest magnitude that can be read: each a `Pair`. `bias` has one value per
    axis.
    """

    noise_std: Pair = (0.0, 0.0)
    bias: tuple[float, float, float, float, float, float] = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
    resolution: Pair = (0.0, 0.0)
    range: Pair = (np.inf, np.inf)

    def __post_init__(self) -> None:
        for name in ("noise_std", "resolution", "range"):
            pair = getattr(self, name)
            if len(pair) != 2:
                raise ValueError(f"{name} has {len(pair)} entries; it must be (force, torque)")
        for name in ("noise_std", "resolution"):
            for index, value in enumerate(getattr(self, name)):
                non_negative(f"{name}[{index}]", value)
        if not all(value > 0.0 for value in self.range):
            raise ValueError(f"range is {self.range!r}; both values must be greater than 0")
        if finite_array("bias", self.bias, 6).ndim != 1:
            raise ValueError("bias must have shape (6,)")


def measure(
    true_wrench: npt.ArrayLike, model: SensorModel, generator: np.random.Generator
) -> tuple[FloatArray, npt.NDArray[np.bool_]]:
    """Readings of the wrenches, shape (n, 6) [N, N*m], and which rows are saturated, shape (n,).

    Bias and noise are added, the sum is rounded to the resolution, then clipped to the range. A row
    is saturated if any of its axes reached the end of the range. Raises `ValueError` for a wrong
    shape or an entry that is not finite.
    """
    wrench = finite_array("true_wrench", true_wrench, 6)
    reading = wrench + np.array(model.bias)
    reading += _per_axis(model.noise_std) * generator.standard_normal(wrench.shape)
    step = _per_axis(model.resolution)
    safe = np.where(step > 0.0, step, 1.0)
    reading = np.where(step > 0.0, np.rint(reading / safe) * safe, reading)
    limit = _per_axis(model.range)
    saturated = (np.abs(reading) >= limit).any(axis=-1)
    return np.clip(reading, -limit, limit), saturated


def _per_axis(pair: Pair) -> FloatArray:
    return np.repeat(np.array(pair, dtype=np.float64), 3)
