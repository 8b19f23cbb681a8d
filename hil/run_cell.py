"""Inserts parts with the cell that a configuration describes, and logs everything to MCAP."""

from contextlib import closing
from pathlib import Path
from typing import Annotated

import numpy as np
import typer
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeElapsedColumn

from drivers.contract.clock import ManualClock, SystemClock
from drivers.contract.errors import LogError, TenonError
from hil.cell import Cell
from hil.config import load_cell
from hil.interrupt import Interrupt, InterruptedRunError
from hil.log_process import PATIENCE_S, LogProcess
from hil.log_reader import read_log
from hil.metadata import metadata
from hil.recorder import Recorder
from hil.report import write_report
from hil.run import ExitCode, Run
from hil.summary import render_table, summarise
from hil.terminal import OutputError, print_error, standard_output
from hil.truth_probe import TruthProbe


def run_cell(
    config: Annotated[
        Path, typer.Option(help="The cell (YAML): its devices, limits, part and controllers.")
    ],
    log: Annotated[
        Path,
        typer.Option(
            help="File to write, named .mcap; it must not exist. The report goes beside it."
        ),
    ],
    insertions: Annotated[int, typer.Option(min=1, help="How many parts to insert.")] = 1,
    controller: Annotated[
        str, typer.Option(help="One of the controllers that the configuration names.")
    ] = "expert",
    part: Annotated[
        Path | None, typer.Option(help="A part (YAML) in place of the one that the cell names.")
    ] = None,
    seed: Annotated[
        int, typer.Option(min=0, help="Seed of all chance on a mock cell: same seed, same log.")
    ] = 0,
    real_time: Annotated[
        bool,
        typer.Option(
            "--real-time", help="Let time pass as on a rig; otherwise a mock cell runs ahead of it."
        ),
    ] = False,
) -> None:
    """Insert parts and log everything: raw forces, proposals, verdicts, and what was really sent.

    Ctrl-C, Ctrl-Z, SIGTERM and SIGHUP hold the cell and finish the log.

    Exit code: 0 every part inserted, 1 not every part or the shaft left in one, 2 unusable input
    (nothing has moved), 3 a fault of device, log, report or terminal, or a stop between insertions,
    129, 130, 143 or 148 interrupted.
    """
    with Interrupt() as interrupt:
        try:
            settings = load_cell(config, part)
            clock = SystemClock() if real_time else ManualClock()
            cell = Cell(settings, controller, clock, np.random.default_rng(seed))
            _make_room(log)
            about = metadata(settings, controller, insertions, seed, real_time)
            patience_s = 0.0 if real_time else PATIENCE_S
            recorder = Recorder(LogProcess(log, about, patience_s=patience_s))
        except TenonError as error:
            print_error(error)
            raise typer.Exit(ExitCode.UNUSABLE_INPUT) from error
        cell.follow(recorder)
        cell.follow(TruthProbe(cell.world, recorder))
        cell.follow(interrupt)
        run = Run(asked=insertions)
        _record(cell, recorder, run)
        _conclude(log, run)
    raise typer.Exit(run.exit_code)


def _make_room(log: Path) -> None:
    """Make the log's folder; raises LogError for a name that leaves none to the report."""
    if log.suffix != ".mcap":
        raise LogError(f"the log {log} is not valid: its name must end in .mcap")
    try:
        log.parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise LogError(f"cannot create the folder {log.parent}: {error.strerror}") from error


def _record(cell: Cell, recorder: Recorder, run: Run) -> None:
    """Insert the parts; whatever happens, the cell comes to rest, and then the log is finished."""
    try:
        with closing(recorder):
            try:
                with closing(cell):
                    _insert_parts(cell, run)
            except TenonError as error:
                run.fail(error)
            recorder.close(run.early_end)
    except LogError as error:
        run.fail(error)


def _conclude(log: Path, run: Run) -> None:
    """Report on the run; what keeps that from somebody is said on standard error."""
    try:
        _report(log, run)
    except TenonError as error:
        run.fail(error)
        print_error(error)
    else:
        if isinstance(run.error, OutputError):
            print_error(run.error)


def _report(log: Path, run: Run) -> None:
    """Write the page beside the log, then say how the run went."""
    recorded = read_log(log)
    report = log.with_suffix(".html")
    write_report(recorded, report)
    summary = summarise(recorded)
    with standard_output() as console:
        console.print(render_table(summary))
        if run.early_end not in ("", summary.facts.early_end):
            console.print(run.early_end, soft_wrap=True, markup=False, highlight=False)
        paths = f"Log: {log}\nReport: {report}"
        console.print(paths, soft_wrap=True, markup=False, highlight=False)


def _insert_parts(cell: Cell, run: Run) -> None:
    """Insert until all are done, one has left the shaft in its part, or somebody interrupts."""
    cell.connect()
    columns = (
        TextColumn("Inserting"),
        BarColumn(),
        MofNCompleteColumn(),
        TextColumn("{task.fields[last]}"),
        TimeElapsedColumn(),
    )
    with standard_output() as console, Progress(*columns, console=console) as progress:
        task = progress.add_task("", total=run.asked, last="")
        for number in range(1, run.asked + 1):
            try:
                outcome = cell.insert_part(number)
            except InterruptedRunError as interrupted:
                run.fail(interrupted)
                cell.hold()
                raise
            run.outcomes.append(outcome)
            last = f"{outcome.phase}, {outcome.steps} steps"
            progress.update(task, advance=1, last=last)
            if not outcome.is_clear:
                return


if __name__ == "__main__":
    typer.run(run_cell)
