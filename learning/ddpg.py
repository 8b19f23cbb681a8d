"""Deep deterministic policy gradient with an expert: the paper's Algorithm 1.

The policy is a residual on top of the expert (eq. 5). States are observations of the environment;
actions are in units of the residual's range, so the actor's answer, the noise and what the critic
sees are alike in size. `docs/reference/paper-deviations.md` says where this differs from the paper,
`docs/reference/ablation.md` what the settings' additions to Algorithm 1 are worth.
"""

import copy
from typing import NamedTuple

import numpy as np
import torch
from torch import Tensor
from torch.nn import functional

from learning.environments.config import Float32Array
from learning.environments.kernels import Outcome
from learning.exploration import Exploration
from learning.networks import Actor, Critic
from learning.replay import Replay, Returns, Transitions
from learning.settings import NO_ADDITIONS, DdpgSettings
from learning.task import InsertionTask, Start

_INSERTED = int(Outcome.INSERTED)
_NOISE_CUT = 2.5
"""Standard deviations that the noise on a goal's action is cut at, as in TD3."""


class Losses(NamedTuple):
    """Of one update, as tensors, which costs no time."""

    critic: Tensor
    """Eq. (8)."""
    value: Tensor
    """Mean value of the actor's actions, which it raises (eq. 7)."""


class Ddpg:
    """Actor, critic, their slow copies (targets) and their optimisers."""

    def __init__(self, settings: DdpgSettings, n_states: int, n_actions: int, seed: int) -> None:
        self.settings = settings
        self.additions = settings.additions or NO_ADDITIONS
        self._joint = self.additions.critic_norm == "batch"
        """Whether a batch and what followed it pass the critic together, without targets."""
        with torch.random.fork_rng(devices=[]):
            torch.manual_seed(seed)
            self.actor = Actor(
                n_states, n_actions, settings.actor.hidden, settings.actor_last_weight
            )
            self.critic = Critic(
                n_states,
                n_actions,
                settings.critic.hidden,
                opinions=2 if self.additions.twin_critics else 1,
                norm=self.additions.critic_norm,
            )
        self.target_actor, self.target_critic = copy.deepcopy((self.actor, self.critic))
        self._learned = [w.data for w in (*self.actor.weights, *self.critic.weights)]
        targets = (*self.target_actor.weights, *self.target_critic.weights)
        self._following = [w.data for w in targets]
        self.actor_optimiser = torch.optim.Adam(
            self.actor.weights, lr=settings.actor.learning_rate, fused=True
        )
        self.critic_optimiser = torch.optim.Adam(
            self.critic.weights, lr=settings.critic.learning_rate, fused=True
        )
        self.updates = 0

    def act(self, state: Float32Array) -> Float32Array:
        """Return the actor's action (n_actions,) for a state (n_states,)."""
        with torch.no_grad():
            action: Float32Array = self.actor(torch.from_numpy(state)).numpy()
        return action

    def next_action(self, batch: Transitions, rng: np.random.Generator) -> Tensor:
        """Return the action whose value the goals rely on (n, n_actions)."""
        action: Tensor = (self.actor if self._joint else self.target_actor)(batch.next_state)
        if sigma := self.additions.target_noise:
            noise = rng.standard_normal(action.shape, dtype=np.float32)
            noise = np.float32(sigma) * noise.clip(-_NOISE_CUT, _NOISE_CUT)
            action = (action + torch.from_numpy(noise)).clip(-1.0, 1.0)
        return action

    def goals(self, batch: Transitions, then: Tensor) -> Tensor:
        """Return what the values of a batch should be, y (n,), from those then (opinions, n)."""
        least = then.amin(0)
        if self.settings.terminal_mask:
            least = least * (1.0 - batch.terminal)
        return batch.reward + batch.discount * least

    def values_and_goals(
        self, batch: Transitions, rng: np.random.Generator
    ) -> tuple[Tensor, Tensor]:
        """Return what the critic says (opinions, n) and what it should (n,)."""
        with torch.no_grad():
            next_action = self.next_action(batch, rng)
            if not self._joint:
                then = self.target_critic(batch.next_state, next_action)
        if self._joint:
            states = torch.cat((batch.state, batch.next_state))
            actions = torch.cat((batch.action, next_action))
            values, then = self.critic(states, actions).tensor_split(2, dim=1)
        else:
            values = self.critic(batch.state, batch.action)
        return values, self.goals(batch, then.detach())

    def update(self, batch: Transitions, rng: np.random.Generator) -> Losses:
        """Make one step of critic and actor, and let the targets follow."""
        if self._joint:
            self.critic.train()
        values, goals = self.values_and_goals(batch, rng)
        critic_loss = functional.mse_loss(values, goals.expand_as(values))
        _step(self.critic_optimiser, self.critic.weights, critic_loss)

        self.updates += 1
        if self._joint:
            self.critic.eval()
        value = self.critic.first(batch.state, self.actor(batch.state)).mean()
        if self.updates % self.additions.actor_period == 0:
            _step(self.actor_optimiser, self.actor.weights, -value)

        if self.updates % self.settings.target_period == 0:
            torch._foreach_lerp_(self._following, self._learned, self.settings.target_rate)
        return Losses(critic_loss.detach(), value.detach())


def _step(optimiser: torch.optim.Adam, weights: list[torch.nn.Parameter], loss: Tensor) -> None:
    """Lower `loss` by these weights alone; the others it depends on get no gradient."""
    for weight, gradient in zip(weights, torch.autograd.grad(loss, weights), strict=True):
        weight.grad = gradient
    optimiser.step()


class Round(NamedTuple):
    """One insertion while learning."""

    outcome: int
    """Code of `Outcome`."""
    steps: int
    reward: float
    """Sum over the steps."""
    peak_radial_N: float
    """Largest force along x or y."""
    sigma: float
    """Of the action noise."""
    critic_loss: float
    """Mean over the updates; 0 without any."""
    value: float
    """Mean over the updates; 0 without any."""

    @property
    def succeeded(self) -> bool:
        """Whether the part was inserted."""
        return self.outcome == _INSERTED


def insert_once(
    task: InsertionTask,
    start: Start,
    ddpg: Ddpg,
    replay: Replay,
    exploration: Exploration,
    rng: np.random.Generator,
) -> Round:
    """Insert once from `start` and learn from each step: the body of Algorithm 1's outer loop."""
    settings = ddpg.settings
    returns = Returns(replay, ddpg.additions.return_steps, settings.discount)
    reward, peak_N = 0.0, 0.0
    critic_loss, value, updates = torch.zeros(()), torch.zeros(()), 0
    sigma = exploration.sigma
    state = task.reset(start)
    while True:
        expert = task.expert(state)
        residual = ddpg.act(state)
        sent = task.cut(expert + residual + exploration.noise(len(residual), rng))
        step = task.step(sent)
        ended = step.outcome != Outcome.RUNNING
        returns.add(state, sent - expert, step.reward, step.state, step.terminal, ended)
        if len(replay) >= settings.batch_size:
            losses = ddpg.update(replay.sample(settings.batch_size, rng), rng)
            critic_loss += losses.critic
            value += losses.value
            updates += 1
        reward += step.reward
        peak_N = max(peak_N, step.radial_force_N)
        state = step.state
        if ended:
            break
    exploration.conclude(step.outcome == _INSERTED)
    return Round(
        outcome=step.outcome,
        steps=step.number,
        reward=reward,
        peak_radial_N=peak_N,
        sigma=sigma,
        critic_loss=critic_loss.item() / max(updates, 1),
        value=value.item() / max(updates, 1),
    )
