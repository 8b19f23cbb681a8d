"""A bound: the gentlest move for one who knows the true pose and plant.

At each step the lateral move, and the turn where that is allowed, is the one that the contact model
expects the least radial force of, the axial step being the longest. Of moves that are as gentle as
each other the one that leaves the shaft most upright and central counts. It is no bound on what
can be had by more or shorter axial steps, nor by giving way early to force for less of it later.
"""

from collections.abc import Callable
from itertools import product

import numpy as np

from controllers.insertion import Controller
from controllers.messages import Move, Observation
from learning.evaluation.plant import Plant
from learning.evaluation.trial import TrialRules
from simulator.checks import FloatArray
from simulator.engine.solve import solve

_GRID = {2: 17, 4: 5}
"""Places along each axis that a search begins with, by the number of axes."""
_FINER = {2: 5, 4: 3}
"""Places along each axis around the best so far."""
_ROUNDS = 9
"""Each halves the distance between places."""
_UPRIGHT_N_RAD, _CENTRAL_N_M = 1e-3, 1.0
"""Force that a tilt, or a place beside the centre, is held to be worth; far below any noise."""


class PrivilegedController(Controller):
    """Chooses moves by the true contact model from the true pose; for one insertion."""

    def __init__(
        self, plant: Plant, rules: TrialRules, true_pose: Callable[[], FloatArray], tilt: bool
    ) -> None:
        """`true_pose` tells where the shaft is in M, shape (5,)."""
        self._plant = plant
        self._true_pose = true_pose
        box = [*rules.step_box_m[:2], *([rules.turn_rad] * 2 if tilt else [])]
        self._box = np.array(box)
        self._longest_m = rules.step_box_m[2]
        self._stroke_m = plant.last_mouth_m + rules.beyond_m
        part = plant.part
        self._pivot_m = 0.5 * float(part.wall_entries_m[0] + part.wall_exits_m[0])

    def step(self, observation: Observation) -> Move:
        """Return the move to propose."""
        pose, axes = self._true_pose(), len(self._box)
        best = self._aligned(pose)
        least = float(self._cost(pose, best[np.newaxis])[0])
        if self._force(pose, best[np.newaxis])[0] > 0.0:
            spacing = 2.0 * self._box / (_GRID[axes] - 1)
            candidates = _grid(axes, _GRID[axes]) * self._box
            for _ in range(_ROUNDS):
                costs = self._cost(pose, candidates)
                if costs.min() < least:
                    best, least = candidates[np.argmin(costs)], float(costs.min())
                spacing = 0.5 * spacing
                around = best + _grid(axes, _FINER[axes]) * (spacing * (_FINER[axes] // 2))
                candidates = np.clip(around, -self._box, self._box)
        move = np.zeros(4)
        move[:axes] = best
        dx, dy, rx, ry = move.tolist()
        return Move((dx, dy, self._axial_m(pose)), (rx, ry, 0.0))

    def _axial_m(self, pose: FloatArray) -> float:
        return min(self._longest_m, self._stroke_m - float(pose[2]))

    def _aligned(self, pose: FloatArray) -> FloatArray:
        """The move, shape (2,) or (4,), towards a shaft that is upright and amid the first wall."""
        axes = len(self._box)
        moves = np.zeros(axes)
        turns = pose[3 : 1 + axes]
        moves[2:] = np.clip(-turns, -self._box[2:], self._box[2:])
        tilt = pose[3:].copy()
        tilt[: axes - 2] += moves[2:]
        lever = max(pose[2] + self._axial_m(pose) - self._pivot_m, 0.0)
        # The axis points along (ry, -rx, 1): B2 is beside the pivot by that times the lever.
        place = lever * np.array([tilt[1], -tilt[0]]) - pose[:2]
        moves[:2] = np.clip(place, -self._box[:2], self._box[:2])
        return moves

    def _cost(self, pose: FloatArray, moves: FloatArray) -> FloatArray:
        steps = self._steps(pose, moves)
        after = pose + steps
        upright = np.hypot(after[:, 3], after[:, 4])
        lever = np.maximum(after[:, 2] - self._pivot_m, 0.0)
        beside = after[:, :2] - lever[:, np.newaxis] * np.stack([after[:, 4], -after[:, 3]], -1)
        central = np.hypot(beside[:, 0], beside[:, 1])
        cost: FloatArray = (
            self._force(pose, moves) + _UPRIGHT_N_RAD * upright + _CENTRAL_N_M * central
        )
        return cost

    def _force(self, pose: FloatArray, moves: FloatArray) -> FloatArray:
        """Radial force after each of the moves [N], shape (n,)."""
        steps, law = self._steps(pose, moves), self._plant.law
        found = solve(
            self._plant.table,
            pose + steps,
            np.ascontiguousarray(steps[:, :3]),
            stiffness_N_m=law.stiffness_N_m,
            friction=law.friction,
        )
        return np.hypot(found.wrench[:, 0], found.wrench[:, 1])

    def _steps(self, pose: FloatArray, moves: FloatArray) -> FloatArray:
        steps = np.zeros((len(moves), 5))
        steps[:, :2] = moves[:, :2]
        steps[:, 2] = self._axial_m(pose)
        steps[:, 3 : 1 + moves.shape[1]] = moves[:, 2:]
        return steps


def _grid(axes: int, places: int) -> FloatArray:
    """All corners of a grid from -1 to 1 along each of the axes, shape (places**axes, axes)."""
    return np.array(list(product(np.linspace(-1.0, 1.0, places), repeat=axes)))
