"""Where the mock stage's platform really is while the controller believes in its profile."""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from drivers.contract.messages import Vector3
from drivers.mock_motion import StraightMove
from simulator.checks import FloatArray
from simulator.effects.stage import StageEffects, StageState, at_rest, move

_SETTLED = 30.0
"""Time constants after which e^-30 of a motion is left, less than a femtometre of 1 mm."""


@dataclass(frozen=True, slots=True, eq=False)
class ImperfectMove:
    """A motion along a line, on which the commanded place never turns back.

    The place at any time therefore follows from that commanded for it and from how things were when
    the motion set out.
    """

    commanded: StraightMove
    effects: StageEffects
    before: StageState
    """As the motion set out."""
    draws: FloatArray
    """Shape (6,): they decide where this motion ends."""
    set_out_ns: int

    @classmethod
    def rest(cls, commanded: StraightMove, effects: StageEffects) -> "ImperfectMove":
        """At rest, in the middle of all gaps."""
        (place,) = commanded.poses([commanded.start_ns])
        before = at_rest(effects, place)
        return cls(commanded, effects, before, np.zeros(6), commanded.start_ns)

    def then(self, commanded: StraightMove, draws: FloatArray) -> "ImperfectMove":
        """The next motion, which sets out where this one has come to."""
        now_ns = commanded.start_ns
        before = self._states([now_ns])
        state = StageState(before.position[0], before.played[0], before.plays[0])
        return ImperfectMove(commanded, self.effects, state, draws, now_ns)

    def going_on(self, commanded: StraightMove) -> "ImperfectMove":
        """The same motion, slowed or braked."""
        return replace(self, commanded=commanded)

    @property
    def translation(self) -> Vector3:
        return self.commanded.translation

    @property
    def end_ns(self) -> int:
        settling_ns = math.ceil(_SETTLED * self.effects.settling_time_constant_s * 1e9)
        return self.commanded.end_ns + settling_ns

    def poses(self, times_ns: Sequence[int]) -> FloatArray:
        """Return x, y, z [m], rx, ry, rz [rad] at each time, shape (n, 6)."""
        return self._states(times_ns).position

    def _states(self, times_ns: Sequence[int]) -> StageState:
        n, b = len(times_ns), self.before
        before = (np.broadcast_to(a, (n, *a.shape)) for a in (b.position, b.played, b.plays))
        elapsed_s = [max(time_ns - self.set_out_ns, 0) * 1e-9 for time_ns in times_ns]
        return move(
            self.effects,
            self.commanded.poses(times_ns),
            StageState(*before),
            np.array(elapsed_s)[:, np.newaxis],
            np.broadcast_to(self.draws, (n, 6)),
        )
