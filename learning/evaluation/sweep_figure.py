"""The figure of a sweep: success and radial force while one parameter leaves its range."""

from collections.abc import Sequence

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from learning.evaluation.sweep import Point, Push

COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7")
"""Of the controllers; the colour-blind tell them apart (Okabe and Ito)."""
EXPECTED_COLOUR = "#DDF0E6"
_ACROSS = 4


def draw_sweep(
    pushes: Sequence[Push], points: Sequence[Point], controllers: Sequence[str]
) -> Figure:
    """One column per parameter, in rows of four: success above, mean radial force below."""
    rows = -(-len(pushes) // _ACROSS)
    with mpl.rc_context({"font.size": 8.5, "axes.spines.top": False, "axes.spines.right": False}):
        figure = Figure(figsize=(12.0, 4.1 * rows + 0.5), layout="constrained")
        grid = figure.subplots(2 * rows, _ACROSS, squeeze=False)
        for number, push in enumerate(pushes):
            row, column = divmod(number, _ACROSS)
            success, force = grid[2 * row][column], grid[2 * row + 1][column]
            for axes in (success, force):
                axes.axvspan(*push.settings.expected, color=EXPECTED_COLOUR, zorder=0)
            for colour, name in zip(COLOURS, controllers, strict=False):
                own = [p for p in points if p.push == push.name and p.controller == name]
                _draw(success, force, own, colour, name)
            success.set_ylim(-4.0, 104.0)
            success.tick_params(labelbottom=False)
            force.set_ylim(bottom=0.0)
            force.set_xlabel(push.settings.label)
            if column == 0:
                success.set_ylabel("success [%]")
                force.set_ylabel("mean radial force [mN]")
        for number in range(len(pushes), rows * _ACROSS):
            row, column = divmod(number, _ACROSS)
            grid[2 * row][column].remove()
            grid[2 * row + 1][column].remove()
        handles, labels = grid[0][0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside upper left", ncols=len(labels), frameon=False)
    return figure


def _draw(success: Axes, force: Axes, points: Sequence[Point], colour: str, name: str) -> None:
    values = [p.value for p in points]
    success.plot(
        values, [100.0 * p.success.value for p in points], "o-", ms=3, color=colour, label=name
    )
    success.fill_between(
        values,
        [100.0 * p.success.low for p in points],
        [100.0 * p.success.high for p in points],
        color=colour,
        alpha=0.15,
        linewidth=0.0,
    )
    means = [1e3 * float(p.figures.values["radial_mean"].mean()) for p in points]
    force.plot(values, means, "o-", ms=3, color=colour)
