"""How an arm that is told to stand still moves: thermal drift, random walk and vibration.

The three are independent and small, so that their displacements add.
"""

import math
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from simulator.checks import FloatArray, finite_array, positive, read_only
from simulator.effects.approach import approach
from simulator.effects.arrays import (
    AXES,
    axis_sizes,
    axis_values,
    demand_batch,
    none_per_axis,
    of_shape,
    sum_rows,
)
from simulator.effects.vibration import VibrationMode


@dataclass(frozen=True, slots=True, eq=False)
class ThermalDrift:
    """Exponential approach of a body that warms up: from 0 to `end`, shape (..., 6) [m, rad] in M.

    Raises `ValueError` for a time constant that is not above zero and an `end` of another shape or
    not finite.
    """

    time_constant_s: float
    end: FloatArray

    def __post_init__(self) -> None:
        positive("ThermalDrift.time_constant_s", self.time_constant_s)
        object.__setattr__(self, "end", axis_values("ThermalDrift.end", self.end))


@dataclass(frozen=True, slots=True, eq=False)
class ArmEffects:
    """D thermal drifts, a random walk and M modes of vibration; the default arm stands still."""

    thermal: tuple[ThermalDrift, ...] = ()
    walk_density: FloatArray = field(default_factory=none_per_axis)
    """Standard deviation of the random walk after 1 s, shape (..., 6) [m/sqrt(s), rad/sqrt(s)]."""
    modes: tuple[VibrationMode, ...] = ()

    def __post_init__(self) -> None:
        """Raise `ValueError` for a walk of another shape, below zero or not finite."""
        density = axis_sizes("ArmEffects.walk_density", self.walk_density)
        object.__setattr__(self, "walk_density", density)

    @property
    def draws_at_start(self) -> int:
        """Standard normal draws that `cold` takes: two per mode."""
        return 2 * len(self.modes)

    @property
    def draws_per_step(self) -> int:
        """Standard normal draws that `step` takes: one per axis, then two per mode."""
        return AXES + 2 * len(self.modes)


@dataclass(frozen=True, slots=True, eq=False)
class ArmState:
    """What the effects of an arm carry from one time to the next."""

    thermal: FloatArray
    """Displacement by each thermal drift, shape (..., D, 6) [m, rad] in M."""
    walk: FloatArray
    """Displacement by the random walk, shape (..., 6) [m, rad] in M."""
    modes: FloatArray
    """State of each mode of vibration (see `VibrationMode.steps`), shape (..., M, 2)."""

    def at(self, index: int) -> "ArmState":
        """One of the states that `steps` returns along their first axis."""
        return ArmState(self.thermal[index], self.walk[index], self.modes[index])


def cold(effects: ArmEffects, draws: npt.ArrayLike) -> ArmState:
    """An arm before its drift, in full vibration; `draws` has shape (..., draws_at_start).

    The shape of the draws is that of the batch, also where there are no modes and its last axis is
    0. Raises `ValueError` for draws of another shape or not finite, and for effects of another
    batch.
    """
    normals = np.asarray(draws, dtype=np.float64)
    batch = normals.shape[:-1]
    demand_batch("ArmEffects.walk_density", effects.walk_density.shape[:-1], batch)
    for drift in effects.thermal:
        demand_batch("ThermalDrift.end", drift.end.shape[:-1], batch)
    for mode in effects.modes:
        demand_batch("VibrationMode.rms", mode.rms.shape[:-1], batch)
    modes = of_shape("draws", normals, (*batch, effects.draws_at_start))
    return ArmState(
        read_only(np.zeros((*batch, len(effects.thermal), AXES))),
        read_only(np.zeros((*batch, AXES))),
        read_only(modes.reshape(*batch, len(effects.modes), 2).copy()),
    )


def steps(effects: ArmEffects, state: ArmState, dt_s: float, draws: npt.ArrayLike) -> ArmState:
    """The arm after each of T steps of `dt_s`, exact for any time step.

    `draws` has shape (T, ..., draws_per_step); the first axis of the states is that of the steps
    too. Raises `ValueError` for a time step that is not above zero, and for draws that are not
    finite or not of the state's batch.
    """
    positive("dt_s", dt_s)
    batch = state.walk.shape[:-1]
    normals = finite_array("draws", draws, effects.draws_per_step)
    count = len(normals)
    if normals.shape[1:-1] != batch:
        shape = ("T", *batch, effects.draws_per_step)
        raise ValueError(f"draws has shape {normals.shape}; it must be {shape}")
    elapsed_s = dt_s * np.arange(1.0, count + 1.0).reshape(count, *(1,) * (len(batch) + 1))
    thermal = np.empty((count, *state.thermal.shape))
    for k, drift in enumerate(effects.thermal):
        thermal[..., k, :] = approach(
            state.thermal[..., k, :], drift.end, elapsed_s, drift.time_constant_s
        )
    walk = np.cumsum(math.sqrt(dt_s) * effects.walk_density * normals[..., :AXES], axis=0)
    kicks = normals[..., AXES:].reshape(count, *state.modes.shape)
    modes = np.empty_like(kicks)
    for k, mode in enumerate(effects.modes):
        modes[..., k, :] = mode.steps(state.modes[..., k, :], dt_s, kicks[..., k, :])
    return ArmState(read_only(thermal), read_only(state.walk + walk), read_only(modes))


def step(effects: ArmEffects, state: ArmState, dt_s: float, draws: npt.ArrayLike) -> ArmState:
    """The arm `dt_s` later: `steps` of one. `draws` has shape (..., draws_per_step)."""
    return steps(effects, state, dt_s, np.asarray(draws)[np.newaxis]).at(0)


def displacement(effects: ArmEffects, state: ArmState) -> FloatArray:
    """How far the arm is from where it was told to stand, shape (..., 6) [m, rad] in M."""
    total = sum_rows(state.thermal) + state.walk
    for k, mode in enumerate(effects.modes):
        total = total + mode.rms * state.modes[..., k, :1]
    return total
