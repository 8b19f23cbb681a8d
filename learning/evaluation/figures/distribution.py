"""How the forces of a number of insertions are distributed (as Figure 11 of the paper)."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from learning.drawing import BAND_COLOUR, drawing, svg
from learning.evaluation.comparison import Comparison, Result
from learning.evaluation.figures.style import (
    WIDTH_IN,
    force_axis_x,
    looks,
)
from simulator.checks import FloatArray


def distribution_figure(comparison: Comparison, insertions: int) -> str:
    """Draw the forces after all steps of the first so many insertions by each controller."""
    results, gentle_N = comparison.results, comparison.evaluation.settings.trial.gentle_N
    wrenches = [_wrenches(result, insertions) for result in results]
    columns = (
        ("|f_x|", [np.abs(w[:, 0]) for w in wrenches]),
        ("|f_y|", [np.abs(w[:, 1]) for w in wrenches]),
        ("|f_z|", [np.abs(w[:, 2]) for w in wrenches]),
    )
    largest_mN = max(float(v.max()) for _, column in columns for v in column) * 1e3
    with drawing():
        figure = Figure(figsize=(WIDTH_IN, 1.1 + 0.42 * len(results)))
        panels = figure.subplots(1, len(columns), sharey=True)
        figure.subplots_adjust(
            left=0.13,
            right=0.985,
            wspace=0.12,
            top=1.0 - 0.3 / figure.get_figheight(),
            bottom=0.5 / figure.get_figheight(),
        )
        for axes, (title, column) in zip(panels, columns, strict=True):
            _draw(axes, [v * 1e3 for v in column], comparison, gentle_N * 1e3, largest_mN)
            axes.set_title(title)
            axes.set_xlabel("force (mN)")
        return svg(figure, "distribution", "Distribution of the forces by controller")


def _wrenches(result: Result, insertions: int) -> FloatArray:
    return np.concatenate([record.wrenches for record in result.records[:insertions]])


def _draw(
    axes: Axes,
    forces_mN: list[FloatArray],
    comparison: Comparison,
    gentle_mN: float,
    largest_mN: float,
) -> None:
    names = [result.name for result in comparison.results]
    rows = range(len(names))
    boxes = axes.boxplot(
        forces_mN,
        positions=list(rows),
        orientation="horizontal",
        widths=0.6,
        whis=(5, 95),
        showfliers=False,
        patch_artist=True,
        medianprops={"color": "black", "linewidth": 1.4},
        manage_ticks=False,
    )
    for name, box in zip(names, boxes["boxes"], strict=True):
        box.set_facecolor(looks(names)[name].colour)
        box.set_alpha(0.75)
    axes.axvspan(0.0, gentle_mN, color=BAND_COLOUR, zorder=0, linewidth=0)
    # Room to the right of the largest force for the shares.
    force_axis_x(axes, 6.0 * largest_mN)
    for row, forces in zip(rows, forces_mN, strict=True):
        axes.plot(float(forces.max()), row, marker="|", color="black", markersize=9)
        share = float(np.mean(forces <= gentle_mN)) * 1e2
        axes.text(
            0.995,
            row,
            f"{share:.1f} %",
            transform=axes.get_yaxis_transform(),
            ha="right",
            va="center",
            fontsize=8.5,
        )
    axes.set_yticks(list(rows), names)
    axes.set_ylim(len(names) - 0.4, -0.6)
