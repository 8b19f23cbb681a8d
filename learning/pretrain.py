"""Trains a skill offline, as a file asks for it, and writes the policy."""

from pathlib import Path
from typing import Annotated

import torch
import typer
from pydantic import JsonValue
from rich.console import Console

from drivers.contract.errors import TenonError
from learning.command import refused
from learning.policy.file import save_policy
from learning.training.checkpoint import configuration
from learning.training.display import RoundDisplay
from learning.training.evaluation import Insertions, insert_all
from learning.training.plan import load_plan
from learning.training.policy_of import policy_of
from learning.training.run_folder import RunFolder
from learning.training.trainer import Trainer


def pretrain(
    config: Annotated[Path, typer.Option(help="The training (YAML): part, algorithm, rounds.")],
    out: Annotated[
        Path,
        typer.Option(help="Folder to write to. A training that it holds unfinished goes on."),
    ],
    seed: Annotated[
        int, typer.Option(min=0, help="Seed of all chance: same seed, same policy.")
    ] = 0,
) -> None:
    """Train a skill and write its policy, with checkpoints and TensorBoard scalars on the way.

    Killed and started again with the same options, it goes on from the latest checkpoint and ends
    at the same policy.

    Exit code: 0 done, 2 a file that cannot be used or written, 130 interrupted.
    """
    try:
        _pretrain(config, out, seed)
    except TenonError as error:
        raise refused(error) from error


def _pretrain(config: Path, out: Path, seed: int) -> None:
    # Threads only slow networks of this size down.
    torch.set_num_threads(1)
    plan = load_plan(config)
    trainer = Trainer(plan, seed)
    folder = RunFolder(out)
    console = Console()
    if played := folder.take_up(trainer):
        console.print(f"Goes on after round {played}.", highlight=False)
    total = plan.settings.rounds
    with RoundDisplay(console, folder.scalars, total, trainer.rounds) as display:
        while not trainer.is_done:
            display.show(trainer.play())
            if len(trainer.rounds) % plan.settings.checkpoint_rounds == 0 or trainer.is_done:
                folder.keep(trainer)
    policy = policy_of(trainer.ddpg.actor, plan)
    judged = insert_all(policy, plan.environment, plan.evaluation_poses(seed))
    about: dict[str, JsonValue] = {
        "trainer": "learning/pretrain.py",
        "seed": seed,
        "rounds": len(trainer.rounds),
        "training_steps": sum(r.steps for r in trainer.rounds),
        "configuration": configuration(plan),
        "metrics": {**judged.metrics()},
    }
    save_policy(policy, folder.policy, about)
    _report(console, judged, folder.policy)


def _report(console: Console, judged: Insertions, policy: Path) -> None:
    figures = judged.metrics()
    lines = (
        f"Inserted {judged.succeeded} of {len(judged.outcome)} from start poses "
        f"that were not trained on, in {figures['steps_mean']:.1f} steps on average.",
        f"Radial force {1e3 * figures['radial_force_mean_N']:.1f} mN on average; largest along "
        f"x, y, z {1e3 * figures['peak_x_N']:.0f}, {1e3 * figures['peak_y_N']:.0f}, "
        f"{1e3 * figures['peak_z_N']:.0f} mN.",
        f"Policy: {policy} and {policy.with_suffix('.onnx').name} beside it",
    )
    console.print("\n".join(lines), soft_wrap=True, markup=False, highlight=False)


if __name__ == "__main__":
    typer.run(pretrain)
