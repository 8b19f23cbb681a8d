"""What each ingredient of the extended skill is worth: trained and judged with one of them off.

Prints a table of means over seeds with 95 % intervals (Student's t). Every variant is trained for
each seed, and inserts the same plants that none has seen with the same noise.
"""

import argparse
from collections.abc import Callable, Mapping
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from multiprocessing import get_context
from pathlib import Path

import numpy as np
import torch
from belief_ablation import cell
from machine import cores, describe

from learning.analytic.judged import judged, judged_cases
from learning.analytic.plan import AnalyticPlan, load_analytic
from learning.analytic.settings import AnalyticSettings
from learning.analytic.trainer import AnalyticTrainer

CONFIG = Path(__file__).parents[1] / "config" / "training" / "extended.yaml"


def with_inputs(**changes: object) -> Callable[[AnalyticSettings], dict[str, object]]:
    """A change of what the policy sees."""
    return lambda s: {"inputs": s.inputs.model_copy(update=changes)}


def no_turns(settings: AnalyticSettings) -> dict[str, object]:
    return {
        "inputs": settings.inputs.model_copy(update={"turn_rad": None}),
        "residual": settings.residual.model_copy(update={"turn_rad": None}),
    }


def no_approach(settings: AnalyticSettings) -> dict[str, object]:
    return {"expert": settings.expert.model_copy(update={"approach": None})}


VARIANTS: Mapping[str, Callable[[AnalyticSettings], dict[str, object]]] = {
    "all of it": lambda s: {},
    "no torque": with_inputs(torque_Nm=None),
    "no displacement": with_inputs(displacement_m=None),
    "no history: the newest observation alone": lambda s: {"history": 1},
    "history of 3": lambda s: {"history": 3},
    "no turns": no_turns,
    "no short steps at the first rim": no_approach,
    "the paper's reward alone": lambda s: {"force_weight": 0.0},
    "not trained: next to nothing on top of the expert": lambda s: {"updates": 0},
}


def changed(plan: AnalyticPlan, name: str, updates: int) -> AnalyticPlan:
    """Return the plan as a variant has it, with so many updates where it has any."""
    shortened = plan.settings.model_copy(update={"updates": updates})
    settings = shortened.model_copy(update=VARIANTS[name](shortened))
    return replace(plan, settings=settings, expert=settings.policy_expert)


def measured(name: str, seed: int, updates: int) -> list[float]:
    """Train and judge: success [%], steps, mean radial force and last hole's p95 [mN]."""
    torch.set_num_threads(1)
    plan = changed(load_analytic(CONFIG), name, updates)
    trainer = AnalyticTrainer(plan, seed)
    while not trainer.is_done:
        trainer.update()
    figures = judged(trainer.policy(), judged_cases(plan), plan)
    return [
        100.0 * float(figures.is_success.mean()),
        float(figures.values["steps"].mean()),
        1e3 * float(figures.values["radial_mean"].mean()),
        1e3 * float(np.nanpercentile(figures.values["last_hole_peak"], 95)),
    ]


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--seeds", type=int, default=5)
    parser.add_argument("--updates", type=int, default=300, help="of each training")
    parser.add_argument("--processes", type=int, default=cores())
    parser.add_argument("names", nargs="*", metavar="variant", help="all, if none is named")
    asked = parser.parse_args()
    names = asked.names or [*VARIANTS]
    if asked.seeds < 2:
        parser.error(f"--seeds is {asked.seeds}; it must be at least 2, to have an interval")
    if unknown := [name for name in names if name not in VARIANTS]:
        parser.error(f"{unknown[0]!r} is no variant; valid are {', '.join(map(repr, VARIANTS))}")
    print(f"{describe()}\n{asked.seeds} seeds with {asked.updates} updates each\n")
    print("| | success [%] | steps | radial force, mean [mN] | last hole, p95 peak [mN] |")
    print("|---|---|---|---|---|")
    with ProcessPoolExecutor(asked.processes, get_context("spawn")) as pool:
        runs = {
            name: [pool.submit(measured, name, seed, asked.updates) for seed in range(asked.seeds)]
            for name in names
        }
        for name, futures in runs.items():
            columns = zip(*(future.result() for future in futures), strict=True)
            print(f"| {name} | {' | '.join(map(cell, columns))} |", flush=True)


if __name__ == "__main__":
    main()
