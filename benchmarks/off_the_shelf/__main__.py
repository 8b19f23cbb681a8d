"""How long our trainers take to the quality that stable-baselines3's best reaches, side by side.

Every training runs alone, one after the other, in a process of its own and on one thread; seeds are
the outer loop, so that a change of the machine meets all. The time is that of training: judging
policies is not counted for anyone, and start-up is stated beside it.

Run from the repository's root: python -m benchmarks.off_the_shelf
"""

from importlib.metadata import version
from pathlib import Path
from typing import Annotated

import typer

from benchmarks.machine import describe
from benchmarks.off_the_shelf import result
from benchmarks.off_the_shelf.quality import STATES
from benchmarks.off_the_shelf.runs import (
    ANALYTIC,
    FORMULATIONS,
    OURS,
    PAPER,
    RESIDUAL,
    Run,
    Task,
    done,
    write_curves,
)
from learning.policy.file import save_policy

ALGORITHMS = ("ddpg", "td3", "sac")


def main(
    out: Annotated[Path, typer.Option(help="Folder of curves, figure and best policies.")] = Path(
        "runs/off-the-shelf"
    ),
    steps: Annotated[int, typer.Option(min=1, help="Steps that the library trains for.")] = 20_000,
    every: Annotated[int, typer.Option(min=1, help="Steps from one judgement to the next.")] = 500,
    every_round: Annotated[
        int, typer.Option(min=1, help="The same in ours: insertions, or updates.")
    ] = 2,
    seeds: Annotated[int, typer.Option(min=1)] = 3,
    config: Annotated[Path, typer.Option(help="Our training (YAML).")] = Path(
        "config/training/paper.yaml"
    ),
    analytic: Annotated[Path, typer.Option(help="Our analytic training (YAML).")] = Path(
        "config/training/paper_analytic.yaml"
    ),
    algorithm: Annotated[list[str] | None, typer.Option(help="Of the library; all.")] = None,
    formulation: Annotated[list[str] | None, typer.Option(help="direct, residual; both.")] = None,
) -> None:
    algorithms, forms = algorithm or ALGORITHMS, formulation or FORMULATIONS
    for asked, valid in ((algorithms, ALGORITHMS), (forms, FORMULATIONS)):
        if unknown := [name for name in asked if name not in valid]:
            raise typer.BadParameter(f"{unknown[0]!r} is not one of {', '.join(valid)}")
    out.mkdir(parents=True, exist_ok=True)
    print(describe())
    packages = ("stable-baselines3", "torch", "gymnasium", "numba")
    print(", ".join(f"{name} {version(name)}" for name in packages))
    print(f"judged from {STATES} start poses that no training sees; library: {steps} steps")
    runs: list[Run] = []
    for seed in range(seeds):
        tasks = [Task(PAPER, RESIDUAL, seed, 0, every_round, config)]
        tasks += [Task(ANALYTIC, f, seed, 0, every_round, analytic) for f in forms]
        tasks += [Task(a, f, seed, steps, every, config) for f in forms for a in algorithms]
        for task in tasks:
            runs.append(done(task))
            print(result.run_line(runs[-1]), flush=True)
            write_curves(runs, out / "curves.csv")
    for line in result.lines(runs):
        print(line)
    _save_best(runs, out)
    _draw(runs, out)
    print(f"\nCurves, figure and policies: {out}")


def _save_best(runs: list[Run], out: Path) -> None:
    """Write the best policy of each of the library's algorithms and formulations."""
    best: dict[str, Run] = {}
    for run in runs:
        name = f"{run.task.trainer}-{run.task.formulation}"
        if name not in best or not best[name].best.quality.reaches(run.best.quality):
            best[name] = run
    for name, run in best.items():
        if run.task.trainer not in OURS:
            save_policy(
                run.policy,
                out / f"{name}.safetensors",
                {
                    "trainer": f"stable-baselines3 {version('stable-baselines3')}",
                    "algorithm": run.task.trainer,
                    "formulation": run.task.formulation,
                    "seed": run.task.seed,
                    "training_steps": run.best.training_steps,
                    "metrics": run.best.quality._asdict(),
                },
            )


def _draw(runs: list[Run], out: Path) -> None:
    from benchmarks.off_the_shelf.figure import draw  # no training has to wait for it

    figure = draw(runs)
    for kind in ("png", "svg"):
        figure.savefig(out / f"quality-against-time.{kind}", dpi=120)


if __name__ == "__main__":
    typer.run(main)
