"""What people see of a training while it runs: a progress line, and scalars for TensorBoard."""

from collections.abc import Mapping
from pathlib import Path
from types import TracebackType
from typing import Self

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn
from torch.utils.tensorboard.writer import SummaryWriter


class Display:
    """Shows how a training goes, one unit of it after the other, until it is left as a context."""

    def __init__(
        self, console: Console, scalars: Path, unit: str, total: int, done: int = 0
    ) -> None:
        """Go on after `done` of `total` units; scalars go to the folder `scalars`."""
        self._progress = Progress(
            TextColumn(unit),
            BarColumn(bar_width=8),
            MofNCompleteColumn(),
            TextColumn("{task.fields[figures]}"),
            TimeElapsedColumn(),
            console=console,
        )
        self._bar = self._progress.add_task("", total=total, completed=done, figures="")
        self._scalars = SummaryWriter(str(scalars), purge_step=done + 1)
        self._number = done

    def __enter__(self) -> Self:
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

    def tell(self, figures: Mapping[str, float], line: str) -> None:
        """Show the next unit: its scalars by name, and in a line."""
        self._number += 1
        for name, figure in figures.items():
            self._scalars.add_scalar(name, figure, self._number)
        self._progress.update(self._bar, advance=1, figures=line)
