"""What a six-axis force/torque sensor says of a load, sample by sample.

The order is that of a real transducer. The load strains a body whose axes couple (crosstalk); the
gauges and the amplifier add bias, drift and noise; the amplifier ends at its range (saturation),
so that all of these use up range; the converter rounds what is left (quantisation); and the line
delivers the finished reading late (latency).
"""

import math
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from simulator.checks import FloatArray, finite_array, non_negative, positive, read_only
from simulator.effects.arrays import (
    AXES,
    axis_sizes,
    axis_values,
    none_per_axis,
    of_shape,
    on_grid,
    sum_rows,
)
from simulator.effects.flicker import Ladder
from simulator.effects.latency import delayed, full_of

BoolArray = npt.NDArray[np.bool_]


@dataclass(frozen=True, slots=True, eq=False)
class SensorEffects:
    """Errors of a sensor that takes `sample_rate_Hz` samples a second; the default is ideal.

    Arrays have shape (..., 6) [N, N*m], unless stated otherwise. Raises `ValueError` for another
    shape, a size that is negative or not finite, a range that is not above zero, and a drift with
    corners above half the sample rate, where its sampled spectrum would fold.
    """

    sample_rate_Hz: float
    crosstalk: FloatArray = field(default_factory=lambda: np.eye(AXES))
    """Response of each axis (row) to a load on each axis (column), shape (..., 6, 6)."""
    bias: FloatArray = field(default_factory=none_per_axis)
    drift: Ladder = field(default_factory=Ladder)
    """1/f drift; see `simulator.effects.flicker.flicker`."""
    noise_density: FloatArray = field(default_factory=none_per_axis)
    """One-sided amplitude density of white noise up to half the sample rate, [N/sqrt(Hz), ...]."""
    range: FloatArray = field(default_factory=lambda: np.full(AXES, np.inf))
    """The largest magnitude that can be read; infinite for no end."""
    resolution: FloatArray = field(default_factory=none_per_axis)
    """Step of the reading; where the range is no multiple, a reading may pass it by half a step."""
    latency_samples: float = 0.0
    """May be a fraction; the reading is then interpolated, and lies between the steps."""

    def __post_init__(self) -> None:
        positive("SensorEffects.sample_rate_Hz", self.sample_rate_Hz)
        non_negative("SensorEffects.latency_samples", self.latency_samples)
        for name in ("noise_density", "resolution"):
            sizes = axis_sizes(f"SensorEffects.{name}", getattr(self, name))
            object.__setattr__(self, name, sizes)
        object.__setattr__(self, "bias", axis_values("SensorEffects.bias", self.bias))
        crosstalk = axis_values("SensorEffects.crosstalk", self.crosstalk)
        if crosstalk.shape[-2:] != (AXES, AXES):
            raise ValueError(
                f"SensorEffects.crosstalk has shape {crosstalk.shape}; it must be (..., 6, 6)"
            )
        object.__setattr__(self, "crosstalk", crosstalk)
        ends = np.array(self.range, dtype=np.float64)
        if ends.shape[-1:] != (AXES,) or not (ends > 0.0).all():
            raise ValueError(
                f"SensorEffects.range is {self.range!r}; it must have shape (..., 6) and every "
                "entry must be greater than 0"
            )
        object.__setattr__(self, "range", read_only(ends))
        highest = max(self.drift.corners_Hz, default=0.0)
        if highest > 0.5 * self.sample_rate_Hz:
            raise ValueError(
                f"SensorEffects.drift has a corner at {highest!r} Hz; at sample_rate_Hz = "
                f"{self.sample_rate_Hz!r} it must be at most {0.5 * self.sample_rate_Hz!r} Hz"
            )

    @property
    def draws_at_start(self) -> int:
        """Standard normal draws that `warmed_up` takes: six per rung of the drift."""
        return AXES * len(self.drift.corners_Hz)

    @property
    def draws_per_sample(self) -> int:
        """Standard normal draws that `sample` takes: six for the noise, then six per rung."""
        return AXES + self.draws_at_start


@dataclass(frozen=True, slots=True, eq=False)
class SensorState:
    """What a sensor carries from one sample to the next."""

    rungs: FloatArray
    """Of the drift (see `Ladder.step`), shape (..., R, 6)."""
    readings: FloatArray
    """Still on their way, the newest first, shape (..., L, 6) [N, N*m]."""
    flags: FloatArray
    """Saturation of the same readings, 1 or 0, shape (..., L, 6)."""


def warmed_up(effects: SensorEffects, load: npt.ArrayLike, draws: npt.ArrayLike) -> SensorState:
    """A sensor that has long run under `load`, shape (..., 6) [N, N*m] in F.

    Its drift is anywhere in its distribution: `draws` has shape (..., draws_at_start). The readings
    on their way have no noise. Raises `ValueError` for a load or draws of another shape or not
    finite.
    """
    wrench = finite_array("load", load, AXES)
    batch = wrench.shape[:-1]
    normals = of_shape("draws", draws, (*batch, effects.draws_at_start))
    rungs = normals.reshape(*batch, len(effects.drift.corners_Hz), AXES).copy()
    reading, saturated = _converted(effects, _strained(effects, wrench, rungs))
    return SensorState(
        read_only(rungs),
        read_only(full_of(reading, effects.latency_samples)),
        read_only(full_of(saturated.astype(np.float64), effects.latency_samples)),
    )


def sample(
    effects: SensorEffects, load: npt.ArrayLike, state: SensorState, draws: npt.ArrayLike
) -> tuple[FloatArray, BoolArray, SensorState]:
    """The next reading (..., 6) [N, N*m] of a load in F, which axes are saturated, and the state.

    `load` has shape (..., 6), `draws` (..., draws_per_sample). An axis is saturated if its signal
    reached the end of the range in any of the samples that the reading is made of. Raises
    `ValueError` for a load or draws that are not finite or not of the state's batch.
    """
    batch = state.rungs.shape[:-2]
    wrench = of_shape("load", load, (*batch, AXES))
    normals = of_shape("draws", draws, (*batch, effects.draws_per_sample))
    kicks = normals[..., AXES:].reshape(state.rungs.shape)
    rungs = effects.drift.step(state.rungs, 1.0 / effects.sample_rate_Hz, kicks)
    noise = math.sqrt(0.5 * effects.sample_rate_Hz) * effects.noise_density * normals[..., :AXES]
    reading, saturated = _converted(effects, _strained(effects, wrench, rungs) + noise)
    late, readings = delayed(reading, state.readings, effects.latency_samples)
    flag, flags = delayed(saturated.astype(np.float64), state.flags, effects.latency_samples)
    return late, flag > 0.0, SensorState(read_only(rungs), read_only(readings), read_only(flags))


def _strained(effects: SensorEffects, wrench: FloatArray, rungs: FloatArray) -> FloatArray:
    """The signal (..., 6) [N, N*m] of a load, without noise."""
    columns = np.swapaxes(effects.crosstalk, -1, -2)
    return sum_rows(columns * wrench[..., np.newaxis]) + effects.bias + effects.drift.drift(rungs)


def _converted(effects: SensorEffects, signal: FloatArray) -> tuple[FloatArray, BoolArray]:
    """The reading (..., 6) of a signal, and which axes are saturated."""
    inside = np.clip(signal, -effects.range, effects.range)
    return on_grid(inside, effects.resolution), np.abs(signal) >= effects.range
