"""Compares controllers on plants, as a file asks for it, and writes tables and figures."""

import os
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console

from drivers.contract.errors import TenonError
from learning.command import make_folder, refused, write_text
from learning.evaluation.comparison import Comparison, compare
from learning.evaluation.load import Evaluation, load_evaluation
from learning.evaluation.page import PAGE, pages
from learning.evaluation.progress import shown_progress
from learning.evaluation.table import insertions_csv, results_csv, terminal_table
from learning.evaluation.training_log import read_training_log
from learning.evaluation.trials import workers


def evaluate(
    config: Annotated[Path, typer.Option(help="The comparison (YAML): plants and controllers.")],
    out: Annotated[Path, typer.Option(help="Folder to write to.")],
    plants: Annotated[
        int | None, typer.Option(min=1, help="Number of plants in place of the file's.")
    ] = None,
    seed: Annotated[
        int | None, typer.Option(min=0, help="Seed of the plants in place of the file's.")
    ] = None,
    training: Annotated[
        list[Path] | None,
        typer.Option(help="Folder of a training to show the learning curve of; may be repeated."),
    ] = None,
    processes: Annotated[
        int | None,
        typer.Option(min=1, help="Processes to share the work; all cores, if not given."),
    ] = None,
) -> None:
    """Insert every plant by every controller; write tables and figures, index.html to begin with.

    The same file and seed give the same numbers, with any number of processes.

    Exit code: 0 done, 2 a file that cannot be used or written.
    """
    try:
        evaluation = load_evaluation(config, plants, seed)
        logs = [read_training_log(folder) for folder in training or []]
        make_folder(out)
        comparison = _run(evaluation, processes or len(os.sched_getaffinity(0)))
        write_text(out / "results.csv", results_csv(comparison))
        write_text(out / "insertions.csv", insertions_csv(comparison))
        for name, content in pages(comparison, logs).items():
            write_text(out / name, content)
    except TenonError as error:
        raise refused(error) from error
    console = Console()
    console.print(terminal_table(comparison))
    console.print(f"Tables and figures: {out / PAGE}", soft_wrap=True, highlight=False)


def _run(evaluation: Evaluation, processes: int) -> Comparison:
    with workers(processes) as team, shown_progress() as told:
        return compare(evaluation, team, told)


if __name__ == "__main__":
    typer.run(evaluate)
