"""DDPG with an expert on many insertions at once: more to learn from for each update.

The problem is that of a training's file; the updates are those of `learning.ddpg`. Their learning
rates fall evenly to zero, so that the last policy is a good one, not one on its way past.
"""

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated

import numpy as np
import torch
from annotated_types import Ge, Le
from pydantic import model_validator

from drivers.contract.configuration.problems import Problems
from drivers.contract.configuration.yaml_loader import read_yaml
from drivers.contract.settings import Settings
from learning.ddpg import Ddpg
from learning.environments.core import DualPegCore
from learning.environments.kernels import Outcome
from learning.replay import Replay
from learning.settings import DdpgSettings
from learning.training.plan import Plan, load_plan

_RUNNING = int(Outcome.RUNNING)
_WEIGHTS, _PLAY, _STARTS = 2, 3, 4
"""What random numbers are for: the second number that they are made from."""
_Count = Annotated[int, Ge(1), Le(1_000_000)]


class BatchedSettings(Settings):
    """How the problem of a training is learned on many insertions at once."""

    training: str
    """File of the training whose part, task, expert and residual are taken, relative to this."""
    insertions: _Count
    """At once."""
    steps: _Count
    """That all of them make."""
    updates_per_step: _Count
    sigma: Annotated[float, Ge(0), Le(1)]
    """Of the noise on actions, in units of the residual's range."""
    ddpg: DdpgSettings

    @model_validator(mode="after")
    def _check(self) -> "BatchedSettings":
        if self.insertions < self.ddpg.batch_size:
            raise ValueError(
                f"insertions = {self.insertions} is not valid: must be at least "
                f"ddpg.batch_size = {self.ddpg.batch_size}, to learn from the first step on"
            )
        additions = self.ddpg.additions
        if additions is not None and additions.return_steps > 1:
            raise ValueError(
                f"ddpg.additions.return_steps = {additions.return_steps} is not valid: must be 1, "
                "as insertions at once keep single steps"
            )
        return self


@dataclass(frozen=True, slots=True)
class BatchedPlan:
    """What is trained, and how."""

    plan: Plan
    settings: BatchedSettings


def load_batched(path: Path) -> BatchedPlan:
    """Load the settings at `path` and the training that they name.

    Raises ConfigurationError, one line per problem, if one of the files cannot be used.
    """
    problems = Problems()
    _, values = read_yaml(path)
    settings = problems.validated(BatchedSettings, values, path)
    if settings is None:
        raise problems.error()
    plan = load_plan(path.parent / settings.training)
    learned = plan.settings.model_copy(update={"ddpg": settings.ddpg})
    return BatchedPlan(replace(plan, settings=learned), settings)


class BatchedTrainer:
    """Plays a batched plan for a seed, one step of all insertions at a time.

    Where an insertion ends, a new one starts, from a pose of its own.
    """

    def __init__(self, batched: BatchedPlan, seed: int) -> None:
        plan, settings = batched.plan, batched.settings
        self.plan = plan
        self.settings = settings
        self.seed = seed
        self.task = plan.task()
        (weights,) = np.random.SeedSequence((seed, _WEIGHTS)).generate_state(1, np.uint32)
        (starts,) = np.random.SeedSequence((seed, _STARTS)).generate_state(1, np.uint64)
        n_states, n_actions = self.task.n_states, self.task.n_actions
        self.ddpg = Ddpg(settings.ddpg, n_states, n_actions, int(weights))
        self.replay = Replay(settings.ddpg.replay_size, n_states, n_actions)
        self._core = DualPegCore(plan.noisy_environment, settings.insertions)
        self._batch = self._core.reset(starts)
        self.steps = 0
        """Steps that all insertions have made."""

    @property
    def is_done(self) -> bool:
        """Whether all steps were made."""
        return self.steps >= self.settings.steps

    def play(self) -> None:
        """Step all insertions once and learn from it."""
        rng = np.random.default_rng((self.seed, _PLAY, self.steps))
        before = self._batch
        states = before.observation
        expert = self.task.expert(states)
        noise = rng.standard_normal(expert.shape, dtype=np.float32)
        with torch.no_grad():
            residual = self.ddpg.actor(torch.from_numpy(states)).numpy()
        sent = self.task.cut(expert + residual + np.float32(self.settings.sigma) * noise)
        unit = np.array(self.plan.settings.residual.range_m)
        after = self._core.step(self.plan.environment.action(sent * unit))
        terminal = after.terminated
        for row in np.flatnonzero(before.outcome == _RUNNING):
            self.replay.add(
                states[row],
                sent[row] - expert[row],
                after.reward[row],
                after.observation[row],
                terminal[row],
                self.settings.ddpg.discount,
            )
        self._batch = after
        self._learn(rng)
        self.steps += 1

    def _learn(self, rng: np.random.Generator) -> None:
        ddpg, share_left = self.ddpg, 1.0 - self.steps / self.settings.steps
        for optimiser, network in (
            (ddpg.actor_optimiser, self.settings.ddpg.actor),
            (ddpg.critic_optimiser, self.settings.ddpg.critic),
        ):
            for group in optimiser.param_groups:
                group["lr"] = share_left * network.learning_rate
        for _ in range(self.settings.updates_per_step):
            ddpg.update(self.replay.sample(self.settings.ddpg.batch_size, rng), rng)
