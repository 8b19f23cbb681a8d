"""Where a stage really goes: grid, backlash, hysteresis, repeatability and settling, in that order.

The order is that of the way from command to platform. The controller rounds the command to its
grid; gears and joints have play before the motion reaches the flexures; their and the drive's
hysteresis follows; the place so reached scatters from motion to motion; and the platform
approaches that place in time.
"""

from dataclasses import dataclass, field

import numpy.typing as npt

from simulator.checks import FloatArray, finite_array, non_negative, read_only
from simulator.effects.approach import approach
from simulator.effects.arrays import (
    AXES,
    axis_sizes,
    demand_batch,
    none_per_axis,
    of_shape,
    on_grid,
)
from simulator.effects.hysteresis import PrandtlIshlinskii, play


@dataclass(frozen=True, slots=True, eq=False)
class StageEffects:
    """How a stage departs from its commands; the default is an ideal one.

    Arrays have shape (..., 6) [m, rad]. Raises `ValueError` for another shape and for an entry that
    is negative or not finite.
    """

    minimum_step: FloatArray = field(default_factory=none_per_axis)
    """Minimum incremental motion: commands are carried out on the grid of its multiples."""
    backlash: FloatArray = field(default_factory=none_per_axis)
    """Free travel at each reversal."""
    hysteresis: PrandtlIshlinskii = field(default_factory=PrandtlIshlinskii)
    repeatability: FloatArray = field(default_factory=none_per_axis)
    """Standard deviation of the place that a motion ends at."""
    settling_time_constant_s: float = 0.0

    def __post_init__(self) -> None:
        for name in ("minimum_step", "backlash", "repeatability"):
            sizes = axis_sizes(f"StageEffects.{name}", getattr(self, name))
            object.__setattr__(self, name, sizes)
        non_negative("StageEffects.settling_time_constant_s", self.settling_time_constant_s)

    @property
    def draws_per_motion(self) -> int:
        """Standard normal draws that one motion takes."""
        return AXES


@dataclass(frozen=True, slots=True, eq=False)
class StageState:
    """Where the stage is and what its mechanism remembers; [m, rad], in M."""

    position: FloatArray
    """Of the platform, shape (..., 6)."""
    played: FloatArray
    """Of the side of the backlash that is driven, shape (..., 6)."""
    plays: FloatArray
    """Of the play operators of the hysteresis, shape (..., K, 6)."""


def at_rest(effects: StageEffects, position: npt.ArrayLike) -> StageState:
    """A stage that stands at `position`, shape (..., 6) [m, rad], in the middle of all its gaps.

    Raises `ValueError` for a wrong shape, an entry that is not finite, and effects of another
    batch.
    """
    place = read_only(finite_array("position", position, AXES).copy())
    batch = place.shape[:-1]
    for name in ("minimum_step", "backlash", "repeatability"):
        demand_batch(f"StageEffects.{name}", getattr(effects, name).shape[:-1], batch)
    for name in ("gaps", "weights"):
        rows = getattr(effects.hysteresis, name)
        demand_batch(f"PrandtlIshlinskii.{name}", rows.shape[:-2], batch)
    return StageState(place, place, read_only(effects.hysteresis.relaxed(place)))


def move(
    effects: StageEffects,
    command: npt.ArrayLike,
    state: StageState,
    elapsed_s: float | FloatArray,
    draws: npt.ArrayLike,
) -> StageState:
    """The stage `elapsed_s` after it set out for `command`, shape (..., 6) [m, rad] in M.

    `elapsed_s` is one time for all or has shape (..., 1). Call it once per motion: `draws`, shape
    (..., 6), decide where this one ends. To look at one motion at several times, start again from
    the same state with the same draws; an infinite time gives the place that it ends at. Raises
    `ValueError` for a command or draws that are not finite or not of the state's batch, and for a
    time that is negative or not a number.
    """
    wanted = of_shape("command", command, state.position.shape)
    normals = of_shape("draws", draws, state.position.shape)
    played = play(on_grid(wanted, effects.minimum_step), state.played, effects.backlash)
    reached, plays = effects.hysteresis.follow(played, state.plays)
    place = reached + effects.repeatability * normals
    position = approach(state.position, place, elapsed_s, effects.settling_time_constant_s)
    return StageState(read_only(position), read_only(played), read_only(plays))
