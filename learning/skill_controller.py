"""The trained skill: the expert (eq. 6) and a policy's residual on top of it (eq. 5)."""

import math

from controllers.insertion import Controller
from controllers.messages import Move, Observation
from learning.policy.policy import Policy

_PLACES = {"step_x": 0, "step_y": 1, "step_z": 2, "turn_x": 3, "turn_y": 4}
"""Where each output of a policy goes in a move."""


class SkillController(Controller):
    """Answers with the expert's step and the residual, together cut to the policy's step box."""

    def __init__(self, policy: Policy) -> None:
        self._policy = policy
        self._expert = policy.expert
        self._places = [_PLACES[name] for name, _ in policy.outputs]

    def step(self, observation: Observation) -> Move:
        """Return the move to propose.

        A number that is not finite is not cut to one that is, so that the supervisor sees it.
        """
        gain_m_N, axial_step_m, step_box_m = self._expert
        fx, fy = observation.wrench[:2]
        move = [-gain_m_N * fx, -gain_m_N * fy, axial_step_m, 0.0, 0.0]
        residual = self._policy.residual(self._policy.read(observation)).tolist()
        for place, value in zip(self._places, residual, strict=True):
            move[place] += value
        x, y, z = (_cut(v, box) for v, box in zip(move[:3], step_box_m, strict=True))
        return Move((x, y, z), (move[3], move[4], 0.0))


def _cut(value: float, bound: float) -> float:
    return max(-bound, min(bound, value)) if math.isfinite(value) else value
