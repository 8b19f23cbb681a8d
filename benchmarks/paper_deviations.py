"""Measures what each choice in docs/reference/paper-deviations.md does to the trained skill.

    python benchmarks/paper_deviations.py [--seeds 5] [--processes 2] [name ...]

One line per choice: trained for each seed as `learning/pretrain.py` does, then judged on start
poses that training has not seen, and on the part of the online experiment with 2 mN of noise on
the forces.
"""

import argparse
import os
from collections.abc import Callable, Mapping
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple, TypeVar, cast

import numpy as np
import numpy.typing as npt
import torch

from drivers.contract.settings import Settings
from learning.environments.config import Float32Array
from learning.environments.core import Batch, DualPegCore
from learning.policy.expert import Expert
from learning.replay import Replay
from learning.task import InsertionTask, Start, Step
from learning.training.evaluation import insert_all
from learning.training.plan import Plan, load_plan
from learning.training.policy_of import policy_of
from learning.training.trainer import Trainer

CONFIG = Path(__file__).parent.parent / "config/training/paper.yaml"
ONLINE = CONFIG.parent / "../parts/paper_online.yaml"
FORCE_NOISE_N = 2e-3
ONLINE_INSERTIONS = 30


AnySettings = TypeVar("AnySettings", bound=Settings)
OtherAction = Callable[[Float32Array, Float32Array], Float32Array]
"""From a state and the residual made in it to the action that is kept."""


class OtherRewardTask(InsertionTask):
    """Reward with one of the other readings of eqs. (12) and (13)."""

    def __init__(self, plan: Plan, signed: bool, after_step: bool) -> None:
        super().__init__(plan.noisy_environment, plan.expert, plan.settings.residual.range_m)
        self._config = plan.environment
        self._signed, self._after_step = signed, after_step
        self._axial_step, self._before = 0.0, 0.0

    def reset(self, start: Start) -> Float32Array:
        state = super().reset(start)
        batch = self._core.batch
        if batch is not None:
            self._before = self._force_reward(batch)
        return state

    def step(self, action: Float32Array) -> Step:
        self._axial_step = float(action[2] * self._to_action[2])
        return super().step(action)

    def reward(self, batch: Batch) -> float:
        weights = self._config.reward
        now = self._force_reward(batch)
        over = self._axial_step - (now if self._after_step else self._before)
        self._before = now
        return now - (over if over >= 0.0 else -over / weights.omega)

    def _force_reward(self, batch: Batch) -> float:
        load = batch.force_N[0, :2] / self._config.force_limit_N[:2]
        x, y = load if self._signed else np.abs(load)
        weights = self._config.reward
        return float(1.0 - weights.alpha_x * x - weights.alpha_y * y)


class OtherActionReplay(Replay):
    """Keeps another action than the residual that was made."""

    def __init__(self, trainer: Trainer, action: OtherAction) -> None:
        old = trainer.replay
        super().__init__(old.capacity, trainer.task.n_states, trainer.task.n_actions)
        self._action = action

    def add(
        self,
        state: npt.ArrayLike,
        action: npt.ArrayLike,
        reward: float,
        next_state: npt.ArrayLike,
        terminal: bool,
        discount: float,
    ) -> None:
        other = self._action(np.asarray(state), np.asarray(action))
        super().add(state, other, reward, next_state, terminal, discount)


def with_keys(**groups: Mapping[str, object]) -> Callable[[Plan], Plan]:
    """A change of settings: groups of keys, attributes in SI units."""

    def change(plan: Plan) -> Plan:
        return replace(plan, settings=updated(plan.settings, groups))

    return change


def updated(settings: AnySettings, changes: Mapping[str, object]) -> AnySettings:
    values = {
        key: updated(old, cast(Mapping[str, object], value))
        if isinstance(old := getattr(settings, key), Settings)
        else value
        for key, value in changes.items()
    }
    return settings.model_copy(update=values)


def reward(signed: bool, after_step: bool) -> Callable[[Trainer], None]:
    def change(trainer: Trainer) -> None:
        trainer.task = OtherRewardTask(trainer.plan, signed, after_step)

    return change


def total_action(trainer: Trainer) -> None:
    trainer.replay = OtherActionReplay(trainer, lambda s, a: a + trainer.task.expert(s))


def action_without_noise(trainer: Trainer) -> None:
    trainer.replay = OtherActionReplay(trainer, lambda s, _: trainer.ddpg.act(s))


def untrained(trainer: Trainer) -> None:
    trainer.plan = replace(
        trainer.plan, settings=trainer.plan.settings.model_copy(update={"rounds": 0})
    )


class Choice(NamedTuple):
    """One change to the shipped configuration, of its settings or of what they make."""

    plan: Callable[[Plan], Plan] = lambda plan: plan
    trainer: Callable[[Trainer], None] = lambda trainer: None
    expert: Expert | None = None
    """That the policy is judged on, in place of the one that it was trained on."""


UM = 1e-6
CHOICES: Mapping[str, Choice] = {
    "shipped": Choice(),
    "expert-alone": Choice(trainer=untrained),
    "conventional-p": Choice(
        trainer=untrained, expert=Expert(800 * UM, 60 * UM, (20 * UM, 20 * UM, 60 * UM))
    ),
    "sigma-as-printed": Choice(
        with_keys(exploration={"sigma_success": 0.4, "sigma_failure": 0.1, "sigma_first": 0.1})
    ),
    "sigma-first-0.4": Choice(with_keys(exploration={"sigma_first": 0.4})),
    "noise-by-step-box": Choice(with_keys(residual={"range_m": (20 * UM, 20 * UM, 60 * UM)})),
    "range-4-4-30-um": Choice(with_keys(residual={"range_m": (4 * UM, 4 * UM, 30 * UM)})),
    "store-total-action": Choice(trainer=total_action),
    "store-action-without-noise": Choice(trainer=action_without_noise),
    "terminal-mask": Choice(with_keys(ddpg={"terminal_mask": True})),
    "signed-forces": Choice(trainer=reward(signed=True, after_step=False)),
    "reward-of-same-step": Choice(trainer=reward(signed=False, after_step=True)),
    "target-period-10": Choice(with_keys(ddpg={"target_period": 10})),
    "rates-0.001": Choice(with_keys(ddpg={"actor": {"learning_rate": 1e-3}})),
    "actor-rate-3e-5": Choice(with_keys(ddpg={"actor": {"learning_rate": 3e-5}})),
    "no-state-noise": Choice(with_keys(task={"state_sigma": 0.0})),
    "state-noise-0.003": Choice(with_keys(task={"state_sigma": 0.003})),
    "replay-20000": Choice(with_keys(ddpg={"replay_size": 20_000})),
    "last-layer-0.125": Choice(with_keys(ddpg={"actor_last_weight": 0.125})),
}


def measured(name: str, seed: int) -> dict[str, float]:
    """Train one seed of a choice and judge it."""
    torch.set_num_threads(1)
    choice = CHOICES[name]
    plan = choice.plan(load_plan(CONFIG))
    trainer = Trainer(plan, seed)
    choice.trainer(trainer)
    while not trainer.is_done:
        trainer.play()
    policy = policy_of(trainer.ddpg.actor, plan)
    if choice.expert is not None:
        policy = replace(policy, expert=choice.expert)
    simulation = insert_all(policy, plan.environment, plan.evaluation_poses(seed))
    online = load_plan(CONFIG, ONLINE).environment
    noisy = replace(online, force_noise_N=(FORCE_NOISE_N,) * 3)
    poses = DualPegCore(online, ONLINE_INSERTIONS).reset(np.uint64(10_000 + seed)).pose
    rig = insert_all(policy, noisy, poses, key=20_000 + seed)
    return {
        "rounds": float(len(trainer.rounds)),
        "training": float(sum(r.succeeded for r in trainer.rounds)),
        **{f"simulation_{key}": value for key, value in simulation.metrics().items()},
        **{f"online_{key}": value for key, value in rig.metrics().items()},
    }


def show(name: str, seeds: list[dict[str, float]]) -> None:
    """Print the row of a choice."""

    def mean(key: str) -> float:
        return float(np.mean([seed[key] for seed in seeds]))

    def worst(key: str) -> float:
        return max(seed[key] for seed in seeds)

    full = sum(s["simulation_succeeded"] == s["simulation_insertions"] for s in seeds)
    least = min(s["simulation_succeeded"] for s in seeds)
    cells = [
        f"`{name}`",
        f"{full} of {len(seeds)}",
        f"{least:.0f}",
        f"{mean('training'):.0f}",
        f"{mean('simulation_steps_mean'):.1f}",
        f"{1e3 * mean('simulation_radial_force_mean_N'):.1f}",
        f"{1e3 * mean('simulation_lower_hole_peak_p95_N'):.0f}",
        f"{min(s['online_succeeded'] for s in seeds):.0f}",
        f"{worst('online_steps_max'):.0f}",
        f"{1e3 * worst('online_lower_hole_peak_max_N'):.0f}",
    ]
    print(f"| {' | '.join(cells)} |", flush=True)


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--seeds", type=int, default=5)
    parser.add_argument("--processes", type=int, default=len(os.sched_getaffinity(0)))
    parser.add_argument("names", nargs="*", choices=[*CHOICES, []], metavar="name")
    asked = parser.parse_args()
    names = asked.names or [*CHOICES]
    print(
        "| choice | seeds with all inserted | inserted, worst seed | successes in training | steps "
        "| radial force, mN | lower peak p95, mN | online: inserted, worst seed | most steps "
        "| highest lower peak, mN |"
    )
    print("|---|" + "---|" * 9)
    with ProcessPoolExecutor(asked.processes) as pool:
        runs = {
            name: [pool.submit(measured, name, seed) for seed in range(1, asked.seeds + 1)]
            for name in names
        }
        for name, futures in runs.items():
            show(name, [future.result() for future in futures])


if __name__ == "__main__":
    main()
