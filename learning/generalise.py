"""Pushes plants out of the range that controllers expect, one parameter after the other."""

import os
from pathlib import Path
from typing import Annotated

import typer
from rich.console import Console
from rich.text import Text

from drivers.contract.errors import TenonError
from learning.evaluation.progress import shown_progress
from learning.evaluation.sweep import Point, Sweep, load_sweep, run_sweep
from learning.evaluation.sweep_figure import draw_sweep
from learning.evaluation.trials import workers

_UNUSABLE = 2
"""Exit code for input that cannot be used, as of `hil/run_cell.py`."""


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
        out.mkdir(parents=True, exist_ok=True)
        points = _run(sweep, processes or len(os.sched_getaffinity(0)))
        (out / "sweep.csv").write_text(_csv(points), encoding="utf-8")
        draw_sweep(sweep.pushes, points, sweep.settings.controllers).savefig(out / "sweep.svg")
    except (TenonError, OSError) as error:
        text = Text.assemble(("error:", "red"), f" {error}")
        Console(stderr=True).print(text, soft_wrap=True, highlight=False)
        raise typer.Exit(_UNUSABLE) from error
    Console().print(f"Wrote {out / 'sweep.csv'} and {out / 'sweep.svg'}", highlight=False)


def _run(sweep: Sweep, processes: int) -> list[Point]:
    with workers(processes) as team, shown_progress() as told:
        return list(run_sweep(sweep, team, told))


def _csv(points: list[Point]) -> str:
    head = "parameter,value,controller,insertions,success,success_low,success_high"
    lines = [f"{head},radial_mean_mN,radial_peak_p95_mN,steps_mean"]
    for p in points:
        peaks = sorted(p.figures.values["radial_peak"])
        lines.append(
            f"{p.push},{p.value:g},{p.controller},{len(peaks)},{p.success.value:.4f},"
            f"{p.success.low:.4f},{p.success.high:.4f},"
            f"{1e3 * p.figures.values['radial_mean'].mean():.3f},"
            f"{1e3 * peaks[int(0.95 * (len(peaks) - 1))]:.2f},"
            f"{p.figures.values['steps'].mean():.2f}"
        )
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    typer.run(generalise)
