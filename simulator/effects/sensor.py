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
    demand_batch,
    none_per_axis,
    of_shape,
    on_grid,
    sum_rows,
)
from simulator.effects.flicker import Ladder
from simulator.effects.latency import delayed, full_of, left_over, queued

BoolArray = npt.NDArray[np.bool_]


@dataclass(frozen=True, slots=True, eq=False)
class SensorEffects:
    """Errors of a sensor that takes `sample_rate_Hz` samples a second; the default is ideal.

    Arrays have shape (..., 6) [N, N*m], unless stated otherwise. Raises `ValueError` for another
    shape, a size that is negative or not finite, a range that is not above zero, and a drift with
    corners above half the sample rate, where its sampled spectrum would fold.
    """

    sample_rate_Hz: float
    crosstalk: FloatArray | None = None
    """Response of each axis (row) to a load on each axis (column), shape (..., 6, 6); None for the
    identity."""
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
        if self.crosstalk is not None:
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
    def noise_std(self) -> FloatArray:
        """Standard deviation of the white noise of one sample, shape (..., 6) [N, N*m]."""
        return math.sqrt(0.5 * self.sample_rate_Hz) * self.noise_density

    @property
    def draws_at_start(self) -> int:
        """Standard normal draws that `warmed_up` takes: six per rung of the drift."""
        return AXES * len(self.drift.corners_Hz)

    @property
    def draws_per_sample(self) -> int:
        """Standard normal draws that each sample takes: six for the noise, then six per rung."""
        return AXES + self.draws_at_start


@dataclass(frozen=True, slots=True, eq=False)
class SensorState:
    """What a sensor carries from one sample to the next."""

    rungs: FloatArray
    """Of the drift (see `Ladder.steps`), shape (..., R, 6)."""
    readings: FloatArray
    """Still on their way, the oldest first, shape (..., L, 6) [N, N*m]."""
    flags: FloatArray
    """Saturation of the same readings, 1 or 0, shape (..., L, 6)."""


@dataclass(frozen=True, slots=True, eq=False)
class Recording:
    """T samples in a row."""

    readings: FloatArray
    """Shape (T, ..., 6) [N, N*m]."""
    saturated: BoolArray
    """Shape (T, ..., 6): whether the signal of an axis reached the end of its range in any of the
    samples that the reading is made of."""
    _latency_samples: float
    _rungs: FloatArray
    _taken: FloatArray
    _flags: FloatArray

    def after(self, count: int) -> SensorState:
        """The state of the sensor after the first `count` samples, 0 to T."""
        return SensorState(
            read_only(self._rungs[count]),
            read_only(left_over(self._taken, count, self._latency_samples)),
            read_only(left_over(self._flags, count, self._latency_samples)),
        )


def warmed_up(effects: SensorEffects, load: npt.ArrayLike, draws: npt.ArrayLike) -> SensorState:
    """A sensor that has long run under `load`, shape (..., 6) [N, N*m] in F.

    Its drift is anywhere in its distribution: `draws` has shape (..., draws_at_start). The readings
    on their way have no noise. Raises `ValueError` for a load or draws of another shape or not
    finite, and for effects of another batch.
    """
    wrench = finite_array("load", load, AXES)
    batch = wrench.shape[:-1]
    for name in ("bias", "noise_density", "range", "resolution"):
        demand_batch(f"SensorEffects.{name}", getattr(effects, name).shape[:-1], batch)
    demand_batch("Ladder.rms", effects.drift.rms.shape[:-1], batch)
    if effects.crosstalk is not None:
        demand_batch("SensorEffects.crosstalk", effects.crosstalk.shape[:-2], batch)
    normals = of_shape("draws", draws, (*batch, effects.draws_at_start))
    rungs = normals.reshape(*batch, len(effects.drift.corners_Hz), AXES).copy()
    reading, saturated = _converted(effects, _strained(effects, wrench, rungs))
    return SensorState(
        read_only(rungs),
        read_only(full_of(reading, effects.latency_samples)),
        read_only(full_of(saturated.astype(np.float64), effects.latency_samples)),
    )


def record(
    effects: SensorEffects, loads: npt.ArrayLike, state: SensorState, draws: npt.ArrayLike
) -> Recording:
    """The next T readings of loads in F.

    `loads` has shape (T, ..., 6) [N, N*m], `draws` (T, ..., draws_per_sample). Raises `ValueError`
    for loads or draws that are not finite or not of the state's batch.
    """
    batch = state.rungs.shape[:-2]
    wrenches = finite_array("loads", loads, AXES)
    count = len(wrenches)
    if wrenches.shape != (count, *batch, AXES):
        raise ValueError(f"loads has shape {wrenches.shape}; it must be {('T', *batch, AXES)}")
    normals = of_shape("draws", draws, (count, *batch, effects.draws_per_sample))
    kicks = normals[..., AXES:].reshape(count, *state.rungs.shape)
    rungs = effects.drift.steps(state.rungs, 1.0 / effects.sample_rate_Hz, kicks)
    signal = _strained(effects, wrenches, rungs[1:]) + effects.noise_std * normals[..., :AXES]
    reading, saturated = _converted(effects, signal)
    taken = queued(reading, state.readings)
    flags = queued(saturated.astype(np.float64), state.flags)
    return Recording(
        read_only(delayed(taken, effects.latency_samples)),
        delayed(flags, effects.latency_samples) > 0.0,
        effects.latency_samples,
        rungs,
        taken,
        flags,
    )


def sample(
    effects: SensorEffects, load: npt.ArrayLike, state: SensorState, draws: npt.ArrayLike
) -> tuple[FloatArray, BoolArray, SensorState]:
    """The next reading (..., 6) [N, N*m], which axes are saturated, and the state: `record` of one.

    `load` has shape (..., 6), `draws` (..., draws_per_sample). Raises `ValueError` as `record`.
    """
    one = record(effects, np.asarray(load)[np.newaxis], state, np.asarray(draws)[np.newaxis])
    return one.readings[0], one.saturated[0], one.after(1)


def _strained(effects: SensorEffects, wrench: FloatArray, rungs: FloatArray) -> FloatArray:
    """The signal (..., 6) [N, N*m] of a load, without noise."""
    if effects.crosstalk is not None:
        wrench = sum_rows(np.swapaxes(effects.crosstalk, -1, -2) * wrench[..., np.newaxis])
    signal = wrench + effects.bias
    return signal + effects.drift.drift(rungs) if effects.drift.corners_Hz else signal


def _converted(effects: SensorEffects, signal: FloatArray) -> tuple[FloatArray, BoolArray]:
    """The reading (..., 6) of a signal, and which axes are saturated."""
    inside = np.minimum(np.maximum(signal, -effects.range), effects.range)
    return on_grid(inside, effects.resolution), np.abs(signal) >= effects.range
