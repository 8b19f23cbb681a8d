"""The insertion as an algorithm sees it: states, and actions that correct an expert."""

from typing import NamedTuple

import numpy as np

from drivers.contract.messages import Vector3
from learning.environments.config import OBSERVATION, DualPegConfig, Float32Array
from learning.environments.core import Batch, DualPegCore
from learning.environments.kernels import Outcome
from learning.policy.expert import Expert
from simulator.checks import FloatArray

_RUNNING, _OUT_OF_STEPS = int(Outcome.RUNNING), int(Outcome.OUT_OF_STEPS)


class Start(NamedTuple):
    """How an insertion starts."""

    pose: FloatArray
    """(5,): of the shaft."""
    key: np.uint64
    """Of the noise on what is observed."""


class Step(NamedTuple):
    """What a step led to."""

    state: Float32Array
    """(n_states,)"""
    reward: float
    outcome: int
    """Code of `Outcome`."""
    terminal: bool
    """Whether the episode ended by what happened in it; steps that ran out are no such end."""
    radial_force_N: float
    """Largest of the true forces along x and y."""
    number: int
    """Of steps in the episode."""


class InsertionTask:
    """One insertion environment with the expert (eq. 6) beside it.

    Actions are in units of the residual's range `residual_m` along each axis. The expert acts on
    the observed state, as the policy does. Raises `ValueError` for an expert with an approach.
    """

    n_states = len(OBSERVATION)
    n_actions = 3

    def __init__(self, config: DualPegConfig, expert: Expert, residual_m: Vector3) -> None:
        if expert.approach is not None:
            raise ValueError("the expert has an approach; this task has none")
        self._core = DualPegCore(config, 1)
        box, unit = np.array(expert.step_box_m), np.array(residual_m)
        self._box = (box / unit).astype(np.float32)
        self._to_action = (unit / box).astype(np.float32)
        limits = np.array([*config.force_limit_N[:2], 0.0])
        self._feedback = (-expert.gain_m_N * limits / unit).astype(np.float32)
        self._feed = np.array([0.0, 0.0, expert.axial_step_m / unit[2]], dtype=np.float32)

    def reset(self, start: Start) -> Float32Array:
        """Start an insertion; return its first state."""
        state: Float32Array = self._core.reset(start.key, start.pose[np.newaxis]).observation[0]
        return state

    def expert(self, state: Float32Array) -> Float32Array:
        """Return the expert's action (..., 3) in a state (..., n_states)."""
        action: Float32Array = self._feed + self._feedback * state[..., :3]
        return action

    def cut(self, action: Float32Array) -> Float32Array:
        """Return an action (..., 3), cut to the step box."""
        inside: Float32Array = np.clip(action, -self._box, self._box)
        return inside

    def step(self, action: Float32Array) -> Step:
        """Move by the sum of expert and residual (3,)."""
        batch = self._core.step((action * self._to_action)[np.newaxis])
        outcome = int(batch.outcome[0])
        return Step(
            state=batch.observation[0],
            reward=self.reward(batch),
            outcome=outcome,
            terminal=outcome not in (_RUNNING, _OUT_OF_STEPS),
            radial_force_N=float(np.abs(batch.force_N[0, :2]).max()),
            number=int(batch.steps[0]),
        )

    def reward(self, batch: Batch) -> float:
        """Return the reward of the step that led to `batch`, eqs. (11) to (13)."""
        return float(batch.reward[0])
