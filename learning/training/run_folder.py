"""The folder of a training: checkpoints, and the policy once it is done."""

from pathlib import Path

from drivers.contract.errors import TrainingError
from learning.training.checkpoint import SUFFIX, read_checkpoint, write_checkpoint
from learning.training.trainer import Trainer

_KEPT = 2
"""Checkpoints that stay: the latest, and one to fall back on."""


class RunFolder:
    """Files of one training; making it makes the folder, or raises TrainingError."""

    def __init__(self, path: Path) -> None:
        self.path = path
        self.checkpoints = path / "checkpoints"
        try:
            self.checkpoints.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise TrainingError(
                f"cannot create the folder {self.checkpoints}: {error.strerror}"
            ) from error

    @property
    def policy(self) -> Path:
        """The policy's file."""
        return self.path / f"policy{SUFFIX}"

    @property
    def scalars(self) -> Path:
        """TensorBoard's folder."""
        return self.path / "tensorboard"

    def take_up(self, trainer: Trainer) -> int:
        """Set a fresh trainer to the latest checkpoint, if there is one; return the rounds played.

        Raises TrainingError if the checkpoint cannot be used.
        """
        if found := self._found():
            read_checkpoint(trainer, found[-1])
        return len(trainer.rounds)

    def keep(self, trainer: Trainer) -> None:
        """Write a checkpoint and remove the oldest; raises TrainingError if it cannot."""
        number = f"{len(trainer.rounds):08}"
        write_checkpoint(trainer, self.checkpoints / f"round-{number}{SUFFIX}")
        for old in self._found()[:-_KEPT]:
            old.unlink(missing_ok=True)

    def _found(self) -> list[Path]:
        """Return the checkpoints from the earliest to the latest."""
        return sorted(self.checkpoints.glob(f"round-*{SUFFIX}"))
