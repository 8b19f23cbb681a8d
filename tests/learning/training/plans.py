"""A short training that several tests use."""

from pathlib import Path
from typing import Any

import yaml

from learning.training.plan import Plan, load_plan
from learning.training.trainer import Trainer

PAPER = Path("config/training/paper.yaml")


def values() -> dict[str, Any]:
    """The shipped file, with the part's path made absolute."""
    loaded: dict[str, Any] = yaml.safe_load(PAPER.read_text())
    loaded["part"] = str((PAPER.parent / loaded["part"]).resolve())
    for network in ("actor", "critic"):  # YAML 1.1 reads 3e-6 as text
        loaded["ddpg"][network]["learning_rate"] = float(loaded["ddpg"][network]["learning_rate"])
    return loaded


def short_file(folder: Path, rounds: int = 4, checkpoint_rounds: int = 2) -> Path:
    """A training of few rounds with small networks."""
    short = values()
    short |= {"rounds": rounds, "initial_states": 5, "checkpoint_rounds": checkpoint_rounds}
    for network in ("actor", "critic"):
        short["ddpg"][network]["hidden"] = [8, 8]
    short["evaluation"]["initial_states"] = 10
    path = folder / "short.yaml"
    path.write_text(yaml.safe_dump(short))
    return path


def short_plan(folder: Path, rounds: int = 4) -> Plan:
    return load_plan(short_file(folder, rounds))


def played(plan: Plan, seed: int, rounds: int) -> Trainer:
    trainer = Trainer(plan, seed)
    for _ in range(rounds):
        trainer.play()
    return trainer
