"""Trains a skill by the gradient through the contact simulation, and writes the policy."""

from pathlib import Path
from typing import Annotated

import torch
import typer
from pydantic import JsonValue
from rich.console import Console

from drivers.contract.errors import ConfigurationError, TenonError
from learning.analytic.display import UpdateDisplay
from learning.analytic.judged import judged, judged_cases, metrics
from learning.analytic.plan import load_analytic
from learning.analytic.trainer import AnalyticTrainer
from learning.command import make_folder, refused
from learning.evaluation.metrics import Measured
from learning.policy.file import SUFFIX, save_policy


def pretrain_analytic(
    config: Annotated[Path, typer.Option(help="The training (YAML): plants, policy, updates.")],
    out: Annotated[Path, typer.Option(help="Folder to write to; a new or an empty one.")],
    seed: Annotated[
        int, typer.Option(min=0, help="Seed of all chance: same seed, same policy.")
    ] = 0,
) -> None:
    """Train a skill and write its policy, with TensorBoard scalars on the way.

    Exit code: 0 done, 2 a file that cannot be used or written, 130 interrupted.
    """
    try:
        _pretrain(config, out, seed)
    except TenonError as error:
        raise refused(error) from error


def _pretrain(config: Path, out: Path, seed: int) -> None:
    # Threads only slow networks of this size down.
    torch.set_num_threads(1)
    plan = load_analytic(config)
    try:
        trainer, cases = AnalyticTrainer(plan, seed), judged_cases(plan)
        trainer.policy()
    except ValueError as error:
        raise ConfigurationError(f"{config}: {error}") from error
    make_folder(out)
    if held := sorted(path.name for path in out.iterdir()):
        raise ConfigurationError(f"the folder {out} is not empty ({held[0]}); name another one")
    console = Console()
    try:
        shown = UpdateDisplay(console, out / "tensorboard", plan.settings.updates)
    except OSError as error:
        raise ConfigurationError(f"cannot write to {out}: {error.strerror}") from error
    with shown as display:
        while not trainer.is_done:
            display.show(trainer.update())
    policy = trainer.policy()
    figures = judged(policy, cases, plan)
    path = out / f"policy{SUFFIX}"
    about: dict[str, JsonValue] = {
        "trainer": "learning/pretrain_analytic.py",
        "seed": seed,
        "updates": len(trainer.updates),
        "insertions": len(trainer.updates) * plan.settings.insertions,
        "training_steps": trainer.steps,
        "configuration": plan.configuration(),
        "metrics": {**metrics(figures)},
    }
    save_policy(policy, path, about)
    _report(console, figures, path)


def _report(console: Console, figures: Measured, policy: Path) -> None:
    inserted, values = int(figures.is_success.sum()), figures.values
    lines = (
        f"Inserted {inserted} of {len(figures.is_success)} plants that were not trained on, "
        f"in {values['steps'].mean():.1f} steps on average.",
        f"Radial force {1e3 * values['radial_mean'].mean():.2f} mN on average, "
        f"{1e3 * values['radial_peak'].max():.0f} mN at most.",
        f"Policy: {policy} and {policy.with_suffix('.onnx').name} beside it",
    )
    console.print("\n".join(lines), soft_wrap=True, markup=False, highlight=False)


if __name__ == "__main__":
    typer.run(pretrain_analytic)
