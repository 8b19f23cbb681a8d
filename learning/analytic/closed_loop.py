"""Insertions played by expert and actor such that their rewards have gradients."""

from typing import NamedTuple

import numpy as np
import torch
from torch import Tensor

from drivers.contract.messages import Vector3
from learning.analytic.contact import cut, wrench_after
from learning.analytic.plant_batch import PlantBatch
from learning.analytic.settings import AnalyticSettings
from learning.evaluation.trial import REACHED_M
from learning.networks import Actor
from learning.policy.expert import Expert
from simulator.checks import FloatArray
from simulator.wrench import move_torque

_ZERO_N = 1e-6
"""Radial forces have a slope of zero at none, as their root has none there."""


class Course(NamedTuple):
    """How n insertions went, step by step, up to T steps.

    One ends where its part is inserted or a force is above its limit.
    """

    reward: Tensor
    """(T, n): eq. (11), less what the force weight takes; 0 after the end."""
    radial_N: Tensor
    """(T, n): radial force after each step; 0 after the end."""
    is_running: Tensor
    """(T, n): 1 for steps of an insertion under way, else 0."""

    @property
    def reward_per_step(self) -> Tensor:
        """Mean over the insertions of the mean reward of their steps."""
        return (self.reward.sum(0) / self.is_running.sum(0)).mean()


class ClosedLoop:
    """Expert and actor in a loop with sensor and stage, by the rules of `Trial`."""

    def __init__(self, settings: AnalyticSettings, expert: Expert) -> None:
        trial, outputs = settings.trial, settings.residual.outputs()
        inputs = settings.inputs.inputs()
        self._settings = settings
        self._expert = expert
        columns = [_READINGS.index(name) for name, _ in inputs]
        scales = np.array([scale for _, scale in inputs])
        # Scaled inputs are linear in the wrench about the origin of M and in the stage's pose.
        self._of_wrench = torch.from_numpy(_at(trial.sensor_m)[:, columns] / scales)
        self._of_stage = torch.from_numpy(_PLACE[:, columns] / scales)
        self._of_noise = _NOISE[:, columns] / scales
        self._force_scale, self._depth_scale = scales[:2], scales[-1]
        box = np.array([*trial.step_box_m, trial.turn_rad, trial.turn_rad])[: len(outputs)]
        self._box = torch.from_numpy(box)
        self._residual = torch.from_numpy(np.array([scale for _, scale in outputs]) / box)
        self._gain = torch.from_numpy(expert.gain_m_N * self._force_scale / box[:2])
        self._force_limit = torch.tensor(trial.force_limit_N, dtype=torch.float64)

    @property
    def n_states(self) -> int:
        """Numbers that the actor sees."""
        return len(self._of_wrench[0]) * self._settings.history

    @property
    def n_actions(self) -> int:
        return len(self._box)

    def play(self, actor: Actor, plants: PlantBatch, generator: np.random.Generator) -> Course:
        """Insert each of the plants once; noise is drawn from `generator`."""
        n, trial = len(plants), self._settings.trial
        misalignment = torch.tensor(plants.misalignment)
        stroke = torch.from_numpy(plants.last_mouth_m + trial.beyond_m)
        stage = torch.zeros(n, 5, dtype=torch.float64)
        stage[:, 2] = trial.start_depth_m
        no_step = torch.zeros(n, self.n_actions, dtype=torch.float64)
        wrench = wrench_after(stage + misalignment, no_step, plants)
        before = self._force_reward(wrench)
        frames = torch.zeros(n, self.n_states)
        running = torch.ones(n, dtype=torch.float64)
        rewards, forces, runs = [], [], []
        for _ in range(self._settings.steps):
            seen = self._seen(wrench, stage, plants, generator)
            frames = torch.cat((self._bounded(seen), frames[:, : -seen.shape[1]]), 1)
            action = cut(self._residual * actor(frames).double() + self._expert_action(seen))
            step = self._no_deeper(action * self._box, stroke - stage[:, 2]) * running[:, None]
            wrench = wrench_after(stage + misalignment, step, plants)
            stage = stage + torch.nn.functional.pad(step, (0, 5 - self.n_actions))
            now = self._force_reward(wrench)
            radial = (wrench[:, :2].square().sum(1) + _ZERO_N**2).sqrt()
            reward = now - self._depth_penalty(action[:, 2], before) - self._extra(radial)
            rewards.append(reward * running)
            forces.append(radial * running)
            runs.append(running)
            before = now
            running = running * self._goes_on(stage.detach(), wrench.detach(), stroke)
            if not running.any():
                break
        return Course(torch.stack(rewards), torch.stack(forces), torch.stack(runs))

    def _seen(
        self, wrench: Tensor, stage: Tensor, plants: PlantBatch, generator: np.random.Generator
    ) -> Tensor:
        """Scaled inputs (n, n_inputs), as sensor and stage report them."""
        noise = np.hstack((plants.force_noise, plants.position_noise_m))
        noise *= generator.standard_normal(noise.shape)
        read = torch.addmm(torch.from_numpy(noise @ self._of_noise), wrench, self._of_wrench)
        return torch.addmm(read, stage, self._of_stage)

    def _bounded(self, seen: Tensor) -> Tensor:
        bound = self._settings.input_bound
        return seen.clamp(-bound, bound).float()

    def _expert_action(self, seen: Tensor) -> Tensor:
        """The expert's step by the step box (n, n_actions); against the force it has a gradient."""
        known = seen.detach().numpy()
        force_N, depth_m = known[:, :2] * self._force_scale, known[:, -1] * self._depth_scale
        rest = np.zeros((len(known), self.n_actions - 2))
        rest[:, 0] = self._expert.step(force_N, depth_m)[:, 2] / self._settings.trial.step_box_m[2]
        return torch.cat((-self._gain * seen[:, :2], torch.from_numpy(rest)), 1)

    def _no_deeper(self, step: Tensor, left_m: Tensor) -> Tensor:
        """Cut steps (n, n_actions) to the depth that is left (n,)."""
        most = torch.nn.functional.pad(left_m[:, None], (2, self.n_actions - 3), value=torch.inf)
        return torch.minimum(step, most)

    def _goes_on(self, stage: Tensor, wrench: Tensor, stroke: Tensor) -> Tensor:
        """1 where the part is not yet inserted and no force is above its limit, else 0."""
        is_within = (wrench[:, :3].abs() <= self._force_limit).all(1)
        return ((stage[:, 2] < stroke - REACHED_M) & is_within).double()

    def _force_reward(self, wrench: Tensor) -> Tensor:
        """R_p, eq. (12)."""
        x, y = (wrench[:, :2].abs() / self._force_limit[:2]).unbind(1)
        weights = self._settings.reward
        return 1.0 - weights.alpha_x * x - weights.alpha_y * y

    def _depth_penalty(self, axial: Tensor, ideal: Tensor) -> Tensor:
        """R_n, eq. (13)."""
        over = axial - ideal
        return torch.where(over >= 0.0, over, -over / self._settings.reward.omega)

    def _extra(self, radial_N: Tensor) -> Tensor:
        share = radial_N / self._settings.trial.gentle_N
        return self._settings.force_weight * (share + share.square())


_READINGS = (
    *("force_x", "force_y", "force_z", "torque_x", "torque_y", "torque_z"),
    *("displacement_x", "displacement_y", "depth", "turn_x", "turn_y"),
)
"""What can be seen. The stage starts at x = y = 0, so its place is its displacement."""
_PLACE = np.eye(5, len(_READINGS), 6)
"""(5, 11): from the stage's pose to what is seen."""
_NOISE = np.eye(9, len(_READINGS))
"""(9, 11): from noise of the wrench and of the place to what is seen."""


def _at(point: Vector3) -> FloatArray:
    """(6, 11): from a wrench about the origin of M to what a sensor at `point` sees of it."""
    return np.hstack((move_torque(np.eye(6), point), np.zeros((6, 5))))
