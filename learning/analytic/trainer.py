"""A training by the analytic policy gradient under way."""

from typing import NamedTuple

import numpy as np
import torch
from torch.nn.utils import clip_grad_norm_

from drivers.contract.errors import TrainingError
from learning.analytic.closed_loop import ClosedLoop
from learning.analytic.plan import AnalyticPlan
from learning.analytic.plant_batch import drawn_batch
from learning.networks import Actor
from learning.policy.policy import Layer, Policy

_PLANTS, _WEIGHTS, _UPDATE = 0, 1, 2
"""What random numbers are for: the second number that they are made from."""


class Update(NamedTuple):
    """What the insertions of an update were like, before it."""

    reward: float
    """Mean over the insertions of the mean reward of their steps."""
    radial_N: float
    """Mean radial force over all steps."""
    steps: float
    """Mean number of steps."""
    gradient_norm: float
    """Before it was shortened."""


class AnalyticTrainer:
    """Makes the updates of a plan for a seed.

    An update plays insertions of plants drawn from the pool and steps the actor along the gradient
    of their reward: what the critic of DDPG has to learn, the contact model knows.
    """

    def __init__(self, plan: AnalyticPlan, seed: int) -> None:
        settings = plan.settings
        self.plan = plan
        self.seed = seed
        (plants,) = np.random.SeedSequence((seed, _PLANTS)).generate_state(1, np.uint64)
        (weights,) = np.random.SeedSequence((seed, _WEIGHTS)).generate_state(1, np.uint32)
        self.pool = drawn_batch(plan.plants.distribution(), settings.pool, int(plants))
        self.loop = ClosedLoop(settings, plan.expert)
        with torch.random.fork_rng(devices=[]):
            torch.manual_seed(int(weights))
            self.actor = Actor(
                self.loop.n_states,
                self.loop.n_actions,
                settings.actor.hidden,
                settings.actor_last_weight,
            )
        self._optimiser = torch.optim.Adam(
            self.actor.weights, lr=settings.actor.learning_rate, fused=True
        )
        self.updates: list[Update] = []
        """Those that were made."""

    @property
    def is_done(self) -> bool:
        """Whether all updates were made."""
        return len(self.updates) >= self.plan.settings.updates

    @property
    def steps(self) -> int:
        """Steps that all insertions have made."""
        return round(sum(made.steps for made in self.updates) * self.plan.settings.insertions)

    def update(self) -> Update:
        """Play one batch of insertions and step the actor.

        Raises TrainingError if their gradient is not finite.
        """
        settings, number = self.plan.settings, len(self.updates)
        generator = np.random.default_rng((self.seed, _UPDATE, number))
        rows = generator.integers(len(self.pool), size=settings.insertions)
        course = self.loop.play(self.actor, self.pool.taken(rows), generator)
        loss, weights = -course.reward_per_step, self.actor.weights
        for weight, gradient in zip(weights, torch.autograd.grad(loss, weights), strict=True):
            weight.grad = gradient
        norm = clip_grad_norm_(weights, settings.gradient_norm_max)
        if not torch.isfinite(norm):
            raise TrainingError(
                f"the gradient is not finite in update {number + 1}: the insertions are unstable; "
                "a smaller expert gain, residual or learning rate may help"
            )
        share_left = 1.0 - number / settings.updates
        for group in self._optimiser.param_groups:
            group["lr"] = share_left * settings.actor.learning_rate
        self._optimiser.step()
        steps = course.is_running.sum().item()
        made = Update(
            reward=-loss.item(),
            radial_N=course.radial_N.sum().item() / steps,
            steps=steps / settings.insertions,
            gradient_norm=norm.item(),
        )
        self.updates.append(made)
        return made

    def policy(self) -> Policy:
        """Return what has been learned so far as cells run it."""
        return policy_of(self.actor, self.plan)


def policy_of(actor: Actor, plan: AnalyticPlan) -> Policy:
    """Return the actor with the processing that it is trained with."""
    settings = plan.settings
    weights = [weight.detach().numpy() for weight in actor.weights]
    return Policy(
        inputs=settings.inputs.inputs(),
        outputs=settings.residual.outputs(),
        bound=settings.input_bound,
        layers=tuple(Layer(*pair) for pair in zip(weights[0::2], weights[1::2], strict=True)),
        expert=plan.expert,
        history=settings.history,
        torque_origin_m=settings.torque_origin_m,
    )
