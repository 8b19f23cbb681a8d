"""What people see of a training while it runs: a progress line, and scalars for TensorBoard."""

from collections.abc import Sequence
from pathlib import Path
from types import TracebackType

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn
from torch.utils.tensorboard.writer import SummaryWriter

from learning.ddpg import Round

RECENT = 20
"""Rounds that the share of successes is taken over."""


class Display:
    """Shows round by round how a training goes, until it is left as a context."""

    def __init__(
        self, console: Console, scalars: Path, total: int, played: Sequence[Round]
    ) -> None:
        self._progress = Progress(
            TextColumn("Round"),
            BarColumn(bar_width=8),
            MofNCompleteColumn(),
            TextColumn("{task.fields[figures]}"),
            TimeElapsedColumn(),
            console=console,
        )
        self._rounds = [*played]
        self._bar = self._progress.add_task("", total=total, completed=len(played), figures="")
        self._scalars = SummaryWriter(str(scalars), purge_step=len(played) + 1)
        self._steps = sum(r.steps for r in played)

    def __enter__(self) -> "Display":
        self._progress.start()
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._progress.stop()
        self._scalars.close()

    def show(self, played: Round) -> None:
        """Show a round that was played."""
        self._rounds.append(played)
        self._steps += played.steps
        number = len(self._rounds)
        recent = self._rounds[-RECENT:]
        share = sum(r.succeeded for r in recent) / len(recent)
        figures = {
            "round/success": float(played.succeeded),
            f"round/success_of_{RECENT}": share,
            "round/steps": played.steps,
            "round/reward_per_step": played.reward / played.steps,
            "round/peak_radial_force_mN": 1e3 * played.peak_radial_N,
            "round/sigma": played.sigma,
            "update/critic_loss": played.critic_loss,
            "update/value": played.value,
            "total/steps": self._steps,
        }
        for name, figure in figures.items():
            self._scalars.add_scalar(name, figure, number)
        line = (
            f"success {share:.0%} {played.steps} steps {1e3 * played.peak_radial_N:.0f} mN "
            f"reward {played.reward / played.steps:.2f} sigma {played.sigma:g}"
        )
        self._progress.update(self._bar, advance=1, figures=line)
