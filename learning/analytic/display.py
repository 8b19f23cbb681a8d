"""What people see of a training while it runs: a progress line, and scalars for TensorBoard."""

from pathlib import Path
from types import TracebackType

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn
from torch.utils.tensorboard.writer import SummaryWriter

from learning.analytic.trainer import Update


class Display:
    """Shows update by update how a training goes, until it is left as a context."""

    def __init__(self, console: Console, scalars: Path, total: int) -> None:
        self._progress = Progress(
            TextColumn("Update"),
            BarColumn(bar_width=8),
            MofNCompleteColumn(),
            TextColumn("{task.fields[figures]}"),
            TimeElapsedColumn(),
            console=console,
        )
        self._bar = self._progress.add_task("", total=total, figures="")
        self._scalars = SummaryWriter(str(scalars))
        self._number = 0

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

    def show(self, made: Update) -> None:
        """Show an update that was made."""
        self._number += 1
        figures = {
            "insertion/reward_per_step": made.reward,
            "insertion/radial_force_mN": 1e3 * made.radial_N,
            "insertion/steps": made.steps,
            "update/gradient_norm": made.gradient_norm,
        }
        for name, figure in figures.items():
            self._scalars.add_scalar(name, figure, self._number)
        line = (
            f"reward {made.reward:.3f} radial {1e3 * made.radial_N:.2f} mN {made.steps:.0f} steps"
        )
        self._progress.update(self._bar, advance=1, figures=line)
