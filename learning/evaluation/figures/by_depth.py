"""Forces of two controllers by depth, over all insertions (as Figure 12 of the paper).

Parts differ in where their last hole is. So depth is counted from the first hole on the left, and
from the last hole on the right.
"""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from learning.drawing import drawing, svg
from learning.evaluation.comparison import Comparison, Result
from learning.evaluation.figures.style import WIDTH_IN, Look, force_axis_y, looks, shade_wall
from learning.evaluation.metrics import radial_forces
from simulator.checks import FloatArray

_BIN_MM = 0.06
_BEFORE_MM = 0.5
"""Way before the last hole that is shown on the right."""


def by_depth_figure(comparison: Comparison, names: tuple[str, str]) -> str:
    """Draw median, 5 to 95 % and largest of radial and axial force at each depth."""
    results = [result for result in comparison.results if result.name in names]
    look = looks([result.name for result in comparison.results])
    parts = [plant.part for plant in comparison.plants]
    first_mm = min(float(part.wall_entries_m[-1]) for part in parts) * 1e3
    beyond_mm = comparison.evaluation.settings.trial.beyond_m * 1e3
    start_mm = comparison.evaluation.settings.trial.start_depth_m * 1e3
    spans = (start_mm, first_mm), (-_BEFORE_MM, beyond_mm)
    with drawing():
        figure = Figure(figsize=(WIDTH_IN, 5.2))
        panels = figure.subplots(
            2, 2, sharex="col", sharey="row", width_ratios=[s[1] - s[0] for s in spans]
        )
        figure.subplots_adjust(
            left=0.07, right=0.98, top=0.85, bottom=0.09, hspace=0.1, wspace=0.04
        )
        ranges = [[0.0, 0.0], [0.0, 0.0]]
        for column, span in enumerate(spans):
            edges = np.arange(span[0], span[1] + _BIN_MM, _BIN_MM)
            for result in results:
                for row, (depth, force) in enumerate(_samples(result, from_last=column == 1)):
                    axes = panels[row][column]
                    _draw(axes, depth, force, edges, look[result.name], result.name)
                    ranges[row] = [
                        min(ranges[row][0], float(force.min())),
                        max(ranges[row][1], float(force.max())),
                    ]
            panels[0][column].set_xlim(*span)
        for row in (0, 1):
            force_axis_y(panels[row][0], *ranges[row])
            for axes in panels[row]:
                axes.axhline(0.0, color="#BBBBBB", linewidth=0.7, zorder=1)
        for column, hole, name in ((0, 0, "first hole"), (1, -1, "last hole")):
            # As far as all parts have it.
            walls = [p.wall_exits_m[hole] - p.wall_entries_m[hole] for p in parts]
            for row in (0, 1):
                shade_wall(panels[row][column], 0.0, float(min(walls)) * 1e3, "" if row else name)
        panels[0][0].set_ylabel("radial force (mN)")
        panels[1][0].set_ylabel("axial force f_z (mN)")
        panels[1][0].set_xlabel("depth below the first rim (mm)")
        panels[1][1].set_xlabel("depth below the last rim (mm)")
        handles, labels = panels[0][0].get_legend_handles_labels()
        # A legend is filled column by column; a controller is a row of it.
        order = [row * 3 + column for column in range(3) for row in range(len(results))]
        figure.legend(
            [handles[i] for i in order],
            [labels[i] for i in order],
            loc="upper left",
            bbox_to_anchor=(0.06, 1.0),
            ncols=3,
        )
        return svg(figure, "by-depth", f"Forces by depth of {names[0]} and {names[1]}")


def _samples(result: Result, from_last: bool) -> list[tuple[FloatArray, FloatArray]]:
    """Depth [mm] and force [mN] of all steps: radial, then axial."""
    depth = np.concatenate(
        [r.poses[:, 2] - (r.last_mouth_m if from_last else 0.0) for r in result.records]
    )
    radial = np.concatenate([radial_forces(record) for record in result.records])
    axial = np.concatenate([record.wrenches[:, 2] for record in result.records])
    return [(depth * 1e3, radial * 1e3), (depth * 1e3, axial * 1e3)]


def _draw(
    axes: Axes, depth: FloatArray, force: FloatArray, edges: FloatArray, look: Look, name: str
) -> None:
    # A step ends on the edge of a bin where all steps are as long as it.
    bin_of = np.searchsorted(edges, depth + 1e-6, side="right") - 1
    quantiles = np.full((len(edges) - 1, 4), np.nan)
    for index in range(len(quantiles)):
        inside = force[bin_of == index]
        if inside.size:
            quantiles[index] = np.percentile(inside, (5, 50, 95, 100))
    low, median, high, most = quantiles.T
    centres = 0.5 * (edges[:-1] + edges[1:])
    colour, dashes = look
    axes.fill_between(
        centres, low, high, color=colour, alpha=0.25, linewidth=0, label=f"{name}: 5 to 95 %"
    )
    axes.plot(
        centres, median, color=colour, linestyle=dashes, linewidth=1.8, label=f"{name}: median"
    )
    axes.plot(centres, most, color=colour, linestyle=":", linewidth=1.0, label=f"{name}: largest")
