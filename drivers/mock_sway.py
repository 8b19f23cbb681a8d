"""How the mock arm moves where it should stand still, as a function of time."""

import math
from collections.abc import Sequence

import numpy as np

from simulator.checks import FloatArray
from simulator.effects.arm import ArmEffects, cold, displacement, steps

_STEP_NS = 1_000_000
_BLOCK = 256
"""Steps made at a time."""
_KEPT = 4096
"""Steps of the past that can at least be asked for."""


class Sway:
    """Displacement of the arm, made step by step and interpolated between.

    The same time gives the same displacement, however often and in what order it is asked for.
    """

    def __init__(self, effects: ArmEffects, start_ns: int, generator: np.random.Generator) -> None:
        self._effects = effects
        self._generator = generator
        self._state = cold(effects, generator.standard_normal(effects.draws_at_start))
        self._first_ns = start_ns
        self._rows = displacement(effects, self._state)[np.newaxis]

    def displacement(self, times_ns: Sequence[int]) -> FloatArray:
        """Return x, y, z [m], rx, ry, rz [rad] at each time, shape (n, 6).

        Before the start, and longer ago than is kept, it is the oldest that is known.
        """
        if len(self._rows) > 2 * _KEPT + _BLOCK:
            self._first_ns += _KEPT * _STEP_NS
            self._rows = self._rows[_KEPT:]
        places = np.maximum(np.array(times_ns) - self._first_ns, 0) / _STEP_NS
        oldest, newest = math.floor(places.min()), math.floor(places.max()) + 1
        while newest >= len(self._rows):
            self._grow()
        rows = self._rows[oldest : newest + 1]
        places -= oldest
        below = places.astype(np.int64)
        share = (places - below)[:, np.newaxis]
        moved: FloatArray = (1.0 - share) * rows[below] + share * rows[below + 1]
        return moved

    def seen_from_part(self, times_ns: Sequence[int], poses: FloatArray) -> FloatArray:
        """Poses of the shaft, shape (n, 5) in M, seen from the part that the arm carries along."""
        moved = self.displacement(times_ns)
        turn = moved[:, 3:]
        seen = poses.copy()
        seen[:, :3] -= moved[:, :3] + np.cross(turn, poses[:, :3])
        seen[:, 3:] -= turn[:, :2]
        return seen

    def _grow(self) -> None:
        draws = self._generator.standard_normal((_BLOCK, self._effects.draws_per_step))
        states = steps(self._effects, self._state, _STEP_NS * 1e-9, draws)
        self._state = states.at(-1)
        self._rows = np.concatenate([self._rows, displacement(self._effects, states)])
