"""Measures what each addition to the paper's algorithm is worth: `docs/reference/ablation.md`.

    python benchmarks/ablation.py [--task paper|stiff] [--first-seed 1] [--seeds 5] [--processes 2]
                                  [name ...]

One line per ingredient: Algorithm 1 with it. Each cell is the mean over seeds and its 95 %
interval; "better" or "worse" stands where that of the difference to Algorithm 1, seed by seed,
excludes 0.
"""

import argparse
import math
import os
import time
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from pathlib import Path
from typing import NamedTuple

import numpy as np
import torch
from scipy.stats import t as student

from learning.settings import NO_ADDITIONS, DdpgSettings
from learning.training.evaluation import insert_all
from learning.training.plan import Plan, load_plan
from learning.training.policy_of import policy_of
from learning.training.trainer import Trainer
from simulator.checks import FloatArray

CONFIG = Path(__file__).parent.parent / "config/training/paper.yaml"


def paper(plan: Plan) -> Plan:
    """The paper's simulation; the first rounds, where the speed of learning shows."""
    return replace(plan, settings=plan.settings.model_copy(update={"rounds": 50}))


def stiff(plan: Plan) -> Plan:
    """Walls of twice the stiffness, where the expert overshoots and fast learning goes astray."""
    ddpg = plan.settings.ddpg
    settings = plan.settings.model_copy(
        update={
            "rounds": 80,
            "task": plan.settings.task.model_copy(update={"state_sigma": 0.02}),
            "residual": plan.settings.residual.model_copy(update={"range_m": (5e-6, 5e-6, 30e-6)}),
            "ddpg": ddpg.model_copy(
                update={"actor": ddpg.actor.model_copy(update={"learning_rate": 1e-4})}
            ),
        }
    )
    contact = plan.part.contact.model_copy(update={"stiffness_N_m": 8e3})
    return replace(plan, settings=settings, part=plan.part.model_copy(update={"contact": contact}))


class Task(NamedTuple):
    """What is learned, and how often it is looked at."""

    change: Callable[[Plan], Plan]
    skilled_steps: float
    """Mean steps with which, all parts being inserted, a policy is skilled: two fewer than the
    expert alone takes."""


TASKS: Mapping[str, Task] = {"paper": Task(paper, 45.0), "stiff": Task(stiff, 44.0)}
LOOK_ROUNDS = 10
"""Rounds from one look to the next; figures are means over the looks of the second half."""


def adding(
    replay_size: int = 200, terminal_mask: bool = False, **additions: object
) -> Callable[[DdpgSettings], DdpgSettings]:
    """A change of the algorithm's settings."""
    changes = {
        "replay_size": replay_size,
        "terminal_mask": terminal_mask,
        "additions": NO_ADDITIONS.model_copy(update=additions),
    }
    return lambda ddpg: ddpg.model_copy(update=changes)


INGREDIENTS: Mapping[str, Callable[[DdpgSettings], DdpgSettings]] = {
    "algorithm-1": adding(),
    "expert-alone": adding(),
    "twin-critics": adding(twin_critics=True),
    "layer-norm": adding(critic_norm="layer"),
    "crossq": adding(critic_norm="batch"),
    "replay-10000": adding(replay_size=10_000),
    "three-steps": adding(return_steps=3),
    "target-noise": adding(target_noise=0.2),
    "delayed-actor": adding(actor_period=2),
    "terminal-mask": adding(terminal_mask=True),
    "td3": adding(
        terminal_mask=True,
        replay_size=10_000,
        twin_critics=True,
        target_noise=0.2,
        actor_period=2,
    ),
    "td3-layer-norm": adding(
        terminal_mask=True,
        replay_size=10_000,
        twin_critics=True,
        critic_norm="layer",
        target_noise=0.2,
        actor_period=2,
    ),
}
REFERENCE, UNTRAINED = "algorithm-1", "expert-alone"


class Figures(NamedTuple):
    """Of one training."""

    inserted: float
    steps: float
    radial_mN: float
    lower_peak_mN: float
    skilled_round: float
    """First look at which the policy was skilled; infinite if at none."""
    cpu_s: float
    """Of the training without the looks; with one thread that is its wall time on an idle core."""


def look(trainer: Trainer, poses: FloatArray) -> tuple[float, float, float, float]:
    """The first four of the figures for the policy as it is now."""
    policy = policy_of(trainer.ddpg.actor, trainer.plan)
    figures = insert_all(policy, trainer.plan.environment, poses).metrics()
    radial, peak = figures["radial_force_mean_N"], figures["lower_hole_peak_p95_N"]
    return figures["succeeded"], figures["steps_mean"], 1e3 * radial, 1e3 * peak


def measured(task_name: str, name: str, seed: int) -> Figures:
    """Train one seed with an ingredient, and look at the policy on the way."""
    torch.set_num_threads(1)
    task = TASKS[task_name]
    plan = task.change(load_plan(CONFIG))
    ddpg = INGREDIENTS[name](plan.settings.ddpg)
    rounds = 0 if name == UNTRAINED else plan.settings.rounds
    settings = plan.settings.model_copy(update={"ddpg": ddpg, "rounds": rounds})
    plan = replace(plan, settings=settings)
    trainer, poses = Trainer(plan, seed), plan.evaluation_poses(seed)
    looks = [] if rounds else [look(trainer, poses)]
    skilled_round, cpu_s = math.inf, 0.0
    while not trainer.is_done:
        began = time.process_time()
        trainer.play()
        cpu_s += time.process_time() - began
        if (played := len(trainer.rounds)) % LOOK_ROUNDS == 0:
            looks.append(look(trainer, poses))
            inserted, steps, *_ = looks[-1]
            if inserted == len(poses) and steps <= task.skilled_steps:
                skilled_round = min(skilled_round, played)
    inserted, steps, radial_mN, peak_mN = np.mean(looks[len(looks) // 2 :], axis=0).tolist()
    return Figures(inserted, steps, radial_mN, peak_mN, skilled_round, cpu_s)


class Interval(NamedTuple):
    """A mean and half of the width of its 95 % interval (Student's t)."""

    mean: float
    half: float

    @classmethod
    def of(cls, values: Sequence[float]) -> "Interval":
        """Of one value per seed, two at least."""
        n = len(values)
        half = student.ppf(0.975, n - 1) * np.std(values, ddof=1) / math.sqrt(n)
        return cls(float(np.mean(values)), float(half))


def cell(key: str, seeds: Sequence[Figures], reference: Sequence[Figures], digits: int) -> str:
    """Mean and interval, marked where the difference by seed to the reference is not by chance."""
    mine, theirs = ([getattr(s, key) for s in group] for group in (seeds, reference))
    found = Interval.of(mine)
    sign = 1 if key == "inserted" else -1
    gain = Interval.of([sign * (a - b) for a, b in zip(mine, theirs, strict=True)])
    mark = "" if abs(gain.mean) <= gain.half else " better" if gain.mean > 0 else " worse"
    return f"{found.mean:.{digits}f} ± {found.half:.{digits}f}{mark}"


def show(name: str, seeds: Sequence[Figures], reference: Sequence[Figures]) -> None:
    """Print the row of an ingredient."""
    rounds = [s.skilled_round for s in seeds]
    reached = sum(map(math.isfinite, rounds))
    median = float(np.median(rounds))
    cells = [
        f"`{name}`",
        cell("inserted", seeds, reference, 0),
        cell("steps", seeds, reference, 1),
        cell("radial_mN", seeds, reference, 2),
        cell("lower_peak_mN", seeds, reference, 0),
        f"{f'{median:.0f}' if math.isfinite(median) else 'more'} ({reached} of {len(seeds)})",
        f"{np.mean([s.cpu_s for s in seeds]):.0f}",
    ]
    print(f"| {' | '.join(cells)} |", flush=True)


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--task", choices=[*TASKS], default="paper")
    parser.add_argument("--first-seed", type=int, default=1)
    parser.add_argument("--seeds", type=int, default=5)
    parser.add_argument("--processes", type=int, default=len(os.sched_getaffinity(0)))
    parser.add_argument("names", nargs="*", choices=[*INGREDIENTS, []], metavar="name")
    asked = parser.parse_args()
    if asked.seeds < 2:
        parser.error("--seeds must be at least 2: one seed has no interval")
    names = list(dict.fromkeys([REFERENCE, *(asked.names or INGREDIENTS)]))
    print(
        "| ingredient | inserted of 300 | steps | radial force, mN | lower peak p95, mN "
        "| rounds to skill | CPU, s |"
    )
    print("|---|" + "---|" * 6, flush=True)
    chosen = range(asked.first_seed, asked.first_seed + asked.seeds)
    with ProcessPoolExecutor(asked.processes) as pool:
        runs = {
            name: [pool.submit(measured, asked.task, name, s) for s in chosen] for name in names
        }
        reference = [future.result() for future in runs[REFERENCE]]
        for name, futures in runs.items():
            show(name, [future.result() for future in futures], reference)


if __name__ == "__main__":
    main()
