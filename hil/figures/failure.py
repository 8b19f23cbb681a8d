"""An insertion that went wrong, by time: forces, steps, depth and the moment of the end."""

from collections.abc import Iterator

import numpy as np
from matplotlib.axes import Axes
from numpy.typing import NDArray

from controllers.messages import SkillPhase
from hil.figures.insertion import draw_force, label_forces
from hil.figures.style import sheet, show_at_least
from hil.log_reader import ForceTrace, Log
from hil.summary import InsertionSummary, Outcome, RunSummary
from learning.drawing import AXIS_COLOURS, LIMIT_COLOUR, drawing, svg

_TAIL_NS = 100_000_000
"""So much is shown of what came after the end."""
_CLOSE_S = 0.3
"""So much of the end is shown enlarged."""


def failure_figure(log: Log, summary: RunSummary, insertion: InsertionSummary) -> str:
    """Draw forces, lateral steps and depth of one insertion over time, and when it was ended.

    Empty where the log holds less than two samples of it.
    """
    trace = _whole(log, insertion)
    if trace.stamps_ns.size < 2:
        return ""
    time_s = (trace.stamps_ns - insertion.start_ns).astype(np.float64) * 1e-9
    with drawing():
        figure, grid = sheet(7.6, 0.75, (1, 1, 1, 1, 0.8), columns=2)
        last_s = float(time_s[-1])
        views = (("All of it", float(time_s[0])), ("Its end", max(0.0, last_s - _CLOSE_S)))
        for column, (title, first_s) in enumerate(views):
            panels = [row[column] for row in grid]
            shown = np.flatnonzero(time_s >= first_s)
            for axis in range(3):
                draw_force(panels[axis], log, _rows(trace, shown), time_s[shown], axis)
            _draw_steps(panels[3], log, insertion)
            panels[4].plot(time_s, trace.depth_m * 1e3, color="#333333")
            panels[4].set_xlim(first_s, last_s)
            panels[4].set_xlabel(f"time since insertion {insertion.number} began (s)")
            panels[0].set_title(title, pad=18)
            for moment_s, label, is_stop in _moments(summary, insertion):
                _mark(panels, moment_s, label, is_stop)
        label_forces(grid, summary.facts)
        show_at_least(grid[3][0], 5.0)
        grid[3][0].set_ylabel("step sent (um)")
        grid[3][0].legend(loc="best", ncols=2)
        grid[4][0].set_ylabel("depth (mm)")
        return svg(figure, "failure", "Force, steps and depth of one insertion over time")


def _whole(log: Log, insertion: InsertionSummary) -> ForceTrace:
    parts = [log.trace(insertion.number, phase) for phase in SkillPhase]
    stamps_ns = np.concatenate([part.stamps_ns for part in parts])
    order = np.argsort(stamps_ns, kind="stable")
    whole = ForceTrace(
        stamps_ns=stamps_ns,
        raw=np.concatenate([part.raw for part in parts]),
        bias=np.concatenate([part.bias for part in parts]),
        depth_m=np.concatenate([part.depth_m for part in parts]),
    )
    return _rows(whole, order[stamps_ns[order] <= insertion.end_ns + _TAIL_NS])


def _rows(trace: ForceTrace, chosen: NDArray[np.intp]) -> ForceTrace:
    return ForceTrace(
        stamps_ns=trace.stamps_ns[chosen],
        raw=trace.raw[chosen],
        bias=trace.bias[chosen],
        depth_m=trace.depth_m[chosen],
    )


def _draw_steps(axes: Axes, log: Log, insertion: InsertionSummary) -> None:
    sent = [
        s
        for s in log.sent
        if insertion.start_ns <= s.stamp_ns <= insertion.end_ns and s.target is not None
    ]
    time_s = [(s.stamp_ns - insertion.start_ns) * 1e-9 for s in sent]
    for axis, name in enumerate("xy"):
        step_um = [s.translation[axis] * 1e6 for s in sent]
        colour = AXIS_COLOURS[axis]
        axes.plot(time_s, step_um, color=colour, marker=".", markersize=5, label=f"along {name}")
    axes.axhline(0.0, color="#BBBBBB", linewidth=0.7, zorder=1)


def _moments(summary: RunSummary, insertion: InsertionSummary) -> Iterator[tuple[float, str, bool]]:
    """Yield time [s], label and whether it was a stop, of what ended the insertion."""
    start_ns = insertion.start_ns
    stops = [s for s in summary.stops if start_ns <= s.stamp_ns <= insertion.end_ns]
    for stop in stops[:1]:
        yield (stop.stamp_ns - start_ns) * 1e-9, f"STOP ({stop.reason.rule})", True
    if insertion.given_up_ns is not None:
        yield (insertion.given_up_ns - start_ns) * 1e-9, "given up, led out", False
    if insertion.outcome is Outcome.NOT_FINISHED:
        yield insertion.duration_s, "end of the log", False


def _mark(panels: list[Axes], moment_s: float, label: str, is_stop: bool) -> None:
    colour = LIMIT_COLOUR if is_stop else "#444444"
    for axes in panels:
        axes.axvline(moment_s, color=colour, linewidth=1.8 if is_stop else 1.2, zorder=3)
    panels[0].annotate(
        label,
        (moment_s, 1.0),
        xycoords=panels[0].get_xaxis_transform(),
        xytext=(0, 3),
        textcoords="offset points",
        ha="right",
        va="bottom",
        color=colour,
        fontweight="bold",
    )
