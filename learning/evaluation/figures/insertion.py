"""Forces along single insertions by every controller (as Figure 10 of the paper)."""

from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from learning.drawing import drawing, svg
from learning.evaluation.comparison import Comparison
from learning.evaluation.figures.style import WIDTH_IN, Look, force_axis_y, looks, shade_wall
from learning.evaluation.metrics import radial_forces
from learning.evaluation.trial import Record
from simulator.checks import FloatArray
from simulator.geometry import Part

_HARD = 0.9
"""Share of the plants that the hard one is harder than."""


class Examples(NamedTuple):
    """Numbers of the plants that are shown, by mean radial force over all controllers."""

    middle: int
    hard: int
    """Harder than nine in ten."""


def examples(comparison: Comparison) -> Examples:
    """Choose the plants to show; every controller has the same say, by the ranks that it gives."""
    ranks: FloatArray = np.mean(
        [np.argsort(np.argsort(r.measured.values["radial_mean"])) for r in comparison.results],
        axis=0,
    )
    order = np.argsort(ranks, kind="stable")
    return Examples(int(order[len(order) // 2]), int(order[int(_HARD * len(order))]))


def insertion_figure(comparison: Comparison) -> str:
    """Draw radial and axial force by depth, of the middle plant on the left, a hard one right."""
    look = looks([result.name for result in comparison.results])
    plants = examples(comparison)
    with drawing():
        figure = Figure(figsize=(WIDTH_IN, 5.2))
        panels = figure.subplots(2, 2, sharex="col", sharey="row")
        figure.subplots_adjust(
            left=0.07, right=0.98, top=0.84, bottom=0.09, hspace=0.1, wspace=0.05
        )
        for column, plant in enumerate(plants):
            for result in comparison.results:
                record = result.records[plant]
                for row, force_mN in enumerate(_forces_mN(record)):
                    _draw(panels[row][column], record, force_mN, look[result.name], result.name)
            part = comparison.plants[plant].part
            _finish(panels[0][column], part, is_named=True)
            _finish(panels[1][column], part, is_named=False)
            panels[1][column].set_xlabel("depth (mm)")
            figure.text(
                panels[0][column].get_position().x0,
                0.915,
                f"plant {plant}, {('the middle one', 'a hard one')[column]}",
                weight="bold",
            )
        for row, label in enumerate(("radial force (mN)", "axial force f_z (mN)")):
            forces = [
                _forces_mN(result.records[plant])[row]
                for plant in plants
                for result in comparison.results
            ]
            low, high = min(float(f.min()) for f in forces), max(float(f.max()) for f in forces)
            force_axis_y(panels[row][0], min(low, 0.0), high)
            panels[row][0].set_ylabel(label)
        handles, labels = panels[0][0].get_legend_handles_labels()
        figure.legend(
            handles,
            labels,
            loc="upper left",
            bbox_to_anchor=(0.06, 1.0),
            ncols=8,
            columnspacing=1.4,
        )
        return svg(figure, "insertion", "Forces along two insertions by each controller")


def _forces_mN(record: Record) -> tuple[FloatArray, FloatArray]:
    """Radial and axial force after each step."""
    return radial_forces(record) * 1e3, record.wrenches[:, 2] * 1e3


def _draw(axes: Axes, record: Record, force_mN: FloatArray, look: Look, name: str) -> None:
    colour, dashes = look
    depth_mm = record.poses[:, 2] * 1e3
    axes.plot(depth_mm, force_mN, color=colour, linestyle=dashes, linewidth=1.5, label=name)


def _finish(axes: Axes, part: Part, is_named: bool) -> None:
    axes.axhline(0.0, color="#BBBBBB", linewidth=0.7, zorder=1)
    walls = zip(part.wall_entries_m * 1e3, part.wall_exits_m * 1e3, strict=True)
    for hole, (entry, end) in enumerate(walls, start=1):
        shade_wall(axes, float(entry), float(end), f"hole {hole}" if is_named else "")
