"""The trained skill: the expert (eq. 6) and a policy's residual on top of it (eq. 5)."""

import math

import numpy as np

from controllers.insertion import Controller
from controllers.messages import Move, Observation
from learning.policy.policy import Policy

_PLACES = {"step_x": 0, "step_y": 1, "step_z": 2, "turn_x": 3, "turn_y": 4}
"""Where each output of a policy goes in a move."""


class SkillController(Controller):
    """Answers with the expert's step and the residual, together cut to the policy's step box.

    An insertion begins with an observation of step 0. Until it has had as many as the policy sees,
    the frames that are missing are zeros. There is one frame for each step: asked again before
    another step is made, the newer observation takes the place of the older.
    """

    def __init__(self, policy: Policy) -> None:
        self._policy = policy
        self._expert = policy.expert
        self._places = [_PLACES[name] for name, _ in policy.outputs]
        self._frames = np.zeros((policy.history, len(policy.inputs)))
        self._values = self._frames.reshape(-1)
        """The same memory, the newest frame first."""
        self._last_step: int | None = None

    def step(self, observation: Observation) -> Move:
        """Return the move to propose.

        A number that is not finite is not cut to one that is, so that the supervisor sees it.
        """
        self._see(observation)
        expert = self._expert.step(observation.wrench[:2], observation.depth_m)
        move = [*expert, 0.0, 0.0]
        residual = self._policy.residual(self._values).tolist()
        for place, value in zip(self._places, residual, strict=True):
            move[place] += value
        box_m = self._expert.step_box_m
        x, y, z = (_cut(v, box) for v, box in zip(move[:3], box_m, strict=True))
        return Move((x, y, z), (move[3], move[4], 0.0))

    def _see(self, observation: Observation) -> None:
        if observation.step == 0:
            self._frames[1:] = 0.0
        elif observation.step != self._last_step:
            self._frames[1:] = self._frames[:-1]
        self._frames[0] = self._policy.read(observation)
        self._last_step = observation.step


def _cut(value: float, bound: float) -> float:
    return max(-bound, min(bound, value)) if math.isfinite(value) else value
