"""Forces along insertions by depth, with hole walls and contact states."""

from collections.abc import Mapping, Sequence
from types import MappingProxyType

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D

from hil.figures.style import (
    DARK_COLOURS,
    draw_limits,
    legend,
    shade_walls,
    sheet,
    show_at_least,
    thinned,
)
from hil.log_reader import ForceTrace, Log, Rows
from hil.summary import RunFacts
from learning.drawing import AXIS_COLOURS, drawing, svg

STATE_COLOURS: Mapping[str, str] = MappingProxyType(
    {
        "free": "#FFFFFF",
        "a": "#C6E2F5",
        "b": "#7CBBE4",
        "c": "#3A8FC8",
        "d": "#D0D0D0",
        "e": "#9A9A9A",
        "f": "#FCE3B6",
        "g": "#F5BE4F",
        "h": "#EB8F1E",
        "i": "#C65A00",
    }
)
"""Blue in the upper hole, grey between the holes, orange in the lower; darker with more contact."""

_LEAST_MM = 0.05
"""No axis of depth is shorter than this."""


def insertion_figure(
    log: Log, facts: RunFacts, numbers: Sequence[int], titles: Sequence[str]
) -> str:
    """Draw f_x, f_y, f_z of insertions side by side over depth, each with its contact states.

    Every one of `numbers` must have samples with a depth in its insert phase.
    """
    traces = [log.trace(number) for number in numbers]
    with drawing():
        figure, grid = sheet(6.4, 0.78, (1, 1, 1, 0.17), columns=len(traces))
        deepest_mm = max(_LEAST_MM, *(float(np.nanmax(t.depth_m)) * 1e3 for t in traces))
        for column, (trace, title) in enumerate(zip(traces, titles, strict=True)):
            grid[3][column].set_xlim(0.0, deepest_mm)
            for axis in range(3):
                draw_force(grid[axis][column], log, trace, trace.depth_m * 1e3, axis)
                shade_walls(grid[axis][column], facts.walls_m, named=axis == 0)
            _draw_states(grid[3][column], log, trace)
            grid[0][column].set_title(title, pad=18)
            grid[3][column].set_xlabel("depth (mm)")
        label_forces(grid, facts)
        grid[3][0].set_ylabel("contact", rotation=0, ha="right", va="center")
        return svg(figure, "insertion", "Force along x, y and z over depth")


def label_forces(grid: list[list[Axes]], facts: RunFacts) -> None:
    """Finish the first three rows of panels, once their forces are drawn: axes, limits, legend."""
    for axis, name in enumerate("xyz"):
        grid[axis][0].set_ylabel(f"f_{name} (mN)")
        show_at_least(grid[axis][0], 5.0)
        if facts.limits is not None:
            for panel in grid[axis]:
                draw_limits(panel, facts.limits.force_N[axis])
    raw = Line2D([], [], color="#999999", alpha=0.6, linewidth=2.5)
    estimate = Line2D([], [], color="#222222")
    legend(grid[0][0], (raw, estimate), ("raw samples, bias removed", "filter's estimate"))


def draw_force(axes: Axes, log: Log, trace: ForceTrace, x: Rows, axis: int) -> None:
    """Draw one force [mN] of a trace over `x`, a value per sample: raw light, estimate dark."""
    force_mN = trace.wrench[:, axis] * 1e3
    axes.axhline(0.0, color="#BBBBBB", linewidth=0.7, zorder=1)
    axes.plot(*thinned(x, force_mN), color=AXIS_COLOURS[axis], alpha=0.45, linewidth=0.8)
    if trace.stamps_ns.size:
        first_ns, last_ns = int(trace.stamps_ns[0]), int(trace.stamps_ns[-1])
        inside = [e for e in log.estimates if first_ns <= e.stamp_ns <= last_ns]
        since_ns = np.array([e.stamp_ns - first_ns for e in inside], dtype=np.float64)
        at = np.interp(since_ns, (trace.stamps_ns - first_ns).astype(np.float64), x)
        estimate_mN = [e.wrench[axis] * 1e3 for e in inside]
        axes.plot(at, estimate_mN, color=DARK_COLOURS[axis], linewidth=1.2)


def _draw_states(axes: Axes, log: Log, trace: ForceTrace) -> None:
    axes.set_yticks([])
    axes.spines["left"].set_visible(False)
    axes.set_ylim(0.0, 1.0)
    first_ns, last_ns = int(trace.stamps_ns[0]), int(trace.stamps_ns[-1])
    truths = [
        truth
        for truth in log.contact_states
        if first_ns <= truth.stamp_ns <= last_ns and truth.state in STATE_COLOURS
    ]
    if not truths:
        axes.text(
            0.5,
            0.5,
            "not known on a rig",
            ha="center",
            va="center",
            color="#777777",
            transform=axes.transAxes,
        )
        return
    changes = [0, *(i for i in range(1, len(truths)) if truths[i].state != truths[i - 1].state)]
    starts_mm = [truths[i].depth_m * 1e3 for i in changes]
    ends_mm = [*starts_mm[1:], float(np.nanmax(trace.depth_m)) * 1e3]
    per_letter_mm = axes.get_xlim()[1] / 60.0
    for index, start_mm, end_mm in zip(changes, starts_mm, ends_mm, strict=True):
        state = truths[index].state
        axes.axvspan(start_mm, end_mm, color=STATE_COLOURS[state], linewidth=0)
        if end_mm - start_mm > per_letter_mm * (4 if state == "free" else 1):
            axes.text(0.5 * (start_mm + end_mm), 0.46, state, ha="center", va="center", fontsize=8)
