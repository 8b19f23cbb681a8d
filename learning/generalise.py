"""Pushes plants out of the range that controllers expect, one parameter after the other."""

import os
from pathlib import Path
from typing import Annotated

import numpy as np
import typer
from rich.console import Console

from drivers.contract.errors import TenonError
from learning.command import make_folder, refused, write_text
from learning.drawing import alone
from learning.evaluation.figures.sweep import sweep_figure
from learning.evaluation.progress import shown_progress
from learning.evaluation.sweep import Point, Sweep, load_sweep, run_sweep
from learning.evaluation.trials import workers


def generalise(
    config: Annotated[Path, typer.Option(help="The sweep (YAML): parameters and values.")],
    out: Annotated[Path, typer.Option(help="Folder to write to.")],
    processes: Annotated[
        int | None,
        typer.Option(min=1, help="Processes to share the work; all cores, if not given."),
    ] = None,
) -> None:
    """Insert plants whose parameters lie further and further out; write sweep.csv and sweep.svg.

    Exit code: 0 done, 2 a file that cannot be used or written.
    """
    try:
        sweep = load_sweep(config)
        make_folder(out)
        points = _run(sweep, processes or len(os.sched_getaffinity(0)))
        write_text(out / "sweep.csv", _csv(points))
        figure = sweep_figure(sweep.pushes, points, sweep.settings.controllers)
        write_text(out / "sweep.svg", alone(figure))
    except TenonError as error:
        raise refused(error) from error
    Console().print(f"Wrote {out / 'sweep.csv'} and {out / 'sweep.svg'}", highlight=False)


def _run(sweep: Sweep, processes: int) -> list[Point]:
    with workers(processes) as team, shown_progress() as told:
        return list(run_sweep(sweep, team, told))


def _csv(points: list[Point]) -> str:
    head = "parameter,value,controller,insertions,success,success_low,success_high"
    lines = [f"{head},radial_mean_mN,radial_peak_p95_mN,steps_mean"]
    for p in points:
        peaks = p.figures.values["radial_peak"]
        lines.append(
            f"{p.push},{p.value:g},{p.controller},{len(peaks)},{p.success.value:.4f},"
            f"{p.success.low:.4f},{p.success.high:.4f},"
            f"{1e3 * p.figures.values['radial_mean'].mean():.3f},"
            f"{1e3 * np.percentile(peaks, 95):.2f},"
            f"{p.figures.values['steps'].mean():.2f}"
        )
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    typer.run(generalise)
