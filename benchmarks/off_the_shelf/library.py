"""DDPG, TD3 and SAC of stable-baselines3 on the registered environment, and their actors as ours.

The settings are the library's, but for those in `train`; `docs/reference/off-the-shelf.md` lists
both.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any

import gymnasium
import numpy as np
import torch
from stable_baselines3 import DDPG, SAC, TD3
from stable_baselines3.common.callbacks import BaseCallback
from stable_baselines3.common.noise import NormalActionNoise
from torch import nn

from benchmarks.off_the_shelf.quality import Recorder
from drivers.contract.messages import Vector3
from learning.environments.config import (
    ACTION,
    OBSERVATION,
    OBSERVATION_BOUND,
    PAPER,
    DualPegConfig,
    Float32Array,
)
from learning.policy.expert import Expert
from learning.policy.inputs import Input, Output
from learning.policy.policy import Layer, Policy
from learning.training.plan import Plan
from simulator.checks import FloatArray

Model = DDPG | TD3 | SAC
ENVIRONMENT = "learning.environments:tenon/DualPeg-v0"
ALGORITHMS: Mapping[str, type[Model]] = MappingProxyType({"ddpg": DDPG, "td3": TD3, "sac": SAC})
HIDDEN = (64, 64)
"""Widths of the hidden layers of actor and critics: the same as in `config/training/paper.yaml`."""
NOISE_SIGMA = 0.1
"""Of the actions of DDPG and TD3, by their range; SAC has noise of its own."""


@dataclass(frozen=True, slots=True)
class Formulation:
    """What an algorithm's environment and action are."""

    environment: DualPegConfig
    expert: Expert
    """Whose step is added to the action's."""
    range_m: Vector3
    """Step that an action of 1 means."""
    ends: bool
    """Whether nothing is to be gained after the end of an episode."""


AS_REGISTERED = Formulation(PAPER, Expert(0.0, 0.0, PAPER.step_box_m), PAPER.step_box_m, ends=True)
"""The registered environment as it is: the action is the whole step."""


def residual(plan: Plan) -> Formulation:
    """Return the environment with the expert, the range and the ends of a plan."""
    settings = plan.settings
    return Formulation(
        plan.environment,
        plan.expert,
        settings.residual.range_m,
        ends=settings.ddpg.terminal_mask,
    )


class ExpertBeside(gymnasium.Wrapper[Float32Array, Float32Array, Float32Array, Float32Array]):
    """The registered environment with the step of an expert added to that of the action.

    Without `ends`, an end counts as running out of steps, after which the library's algorithms
    expect more to come: as in Algorithm 1, which does not tell ends from other steps.
    """

    def __init__(self, env: gymnasium.Env[Float32Array, Float32Array], form: Formulation) -> None:
        super().__init__(env)
        self._form = form
        self._expert_m = np.zeros(3)

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Float32Array, dict[str, Any]]:
        observation, info = self.env.reset(seed=seed, options=options)
        self._expert_m = self._expert_step(observation)
        return observation, info

    def step(self, action: Float32Array) -> tuple[Float32Array, float, bool, bool, dict[str, Any]]:
        form = self._form
        step_m = np.array(form.range_m) * action + self._expert_m
        observation, reward, ended, ran_out, info = self.env.step(form.environment.action(step_m))
        self._expert_m = self._expert_step(observation)
        if not form.ends:
            ended, ran_out = False, ended or ran_out
        return observation, float(reward), ended, ran_out, info

    def _expert_step(self, observation: Float32Array) -> FloatArray:
        config = self._form.environment
        return self._form.expert.step(config.force_N(observation)[:2], config.depth_m(observation))


def make(algorithm: str, form: Formulation, seed: int, buffer_size: int) -> Model:
    """Return an untrained model, on one thread of the processor."""
    torch.set_num_threads(1)
    env = gymnasium.make(ENVIRONMENT, config=form.environment)
    if form is not AS_REGISTERED:
        env = ExpertBeside(env, form)
    settings: dict[str, Any] = {
        "policy_kwargs": {"net_arch": list(HIDDEN)},
        "buffer_size": buffer_size,
        "seed": seed,
        "device": "cpu",
    }
    if algorithm != "sac":
        n = len(ACTION)
        settings["action_noise"] = NormalActionNoise(np.zeros(n), np.full(n, NOISE_SIGMA))
    return ALGORITHMS[algorithm]("MlpPolicy", env, **settings)


def train(
    algorithm: str, form: Formulation, seed: int, steps: int, every: int, began: float
) -> Recorder:
    """Train for `steps` and judge the policy at first and `every` so many of them."""
    model = make(algorithm, form, seed, steps)
    recorder = Recorder(began)
    model.learn(steps, callback=_Judge(recorder, form, every))
    return recorder


class _Judge(BaseCallback):
    def __init__(self, recorder: Recorder, form: Formulation, every: int) -> None:
        super().__init__()
        self._recorder, self._form, self._every = recorder, form, every

    def _on_training_start(self) -> None:
        self._judge()

    def _on_step(self) -> bool:
        if self.num_timesteps % self._every == 0:
            self._judge()
        return True

    def _judge(self) -> None:
        self._recorder.judge(self.num_timesteps, converted(self.model, self._form))


def converted(model: Model, form: Formulation) -> Policy:
    """Return the actor, without the noise that it learns with, as a policy of ours.

    Raises `ValueError` if it is not linear layers with ReLU between them and tanh at the end.
    """
    actor = model.actor
    is_sac = isinstance(model, SAC)
    modules = [*actor.latent_pi, actor.mu, nn.Tanh()] if is_sac else [*actor.mu]
    linear, between = modules[:-1:2], modules[1::2]
    kinds = [*(nn.ReLU for _ in between[:-1]), nn.Tanh]
    if not all(map(isinstance, between, kinds)) or not all(
        isinstance(m, nn.Linear) for m in linear
    ):
        raise ValueError(
            f"the actor is {', '.join(type(m).__name__ for m in modules)}; it must be linear "
            "layers with ReLU between them and Tanh at the end"
        )
    scales = (*form.environment.force_limit_N, form.environment.stroke_m)
    return Policy(
        inputs=tuple(Input(*pair) for pair in zip(OBSERVATION, scales, strict=True)),
        outputs=tuple(Output(*pair) for pair in zip(ACTION, form.range_m, strict=True)),
        bound=OBSERVATION_BOUND,
        layers=tuple(
            Layer(layer.weight.detach().numpy(), layer.bias.detach().numpy()) for layer in linear
        ),
        expert=form.expert,
    )
