"""The figure of a sweep: success and radial force while one parameter leaves its range."""

from collections.abc import Sequence

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from learning.drawing import BAND_COLOUR, drawing, svg
from learning.evaluation.figures.style import Look, looks
from learning.evaluation.sweep import Point, Push

_ACROSS = 4


def sweep_figure(
    pushes: Sequence[Push], points: Sequence[Point], controllers: Sequence[str]
) -> str:
    """One column per parameter, in rows of four: success above, mean radial force below."""
    rows = -(-len(pushes) // _ACROSS)
    with drawing():
        figure = Figure(figsize=(12.0, 4.1 * rows + 0.5), layout="constrained")
        grid = figure.subplots(2 * rows, _ACROSS, squeeze=False)
        for number, push in enumerate(pushes):
            row, column = divmod(number, _ACROSS)
            success, force = grid[2 * row][column], grid[2 * row + 1][column]
            for axes in (success, force):
                axes.axvspan(*push.settings.expected, color=BAND_COLOUR, zorder=0)
            for name, look in looks(controllers).items():
                own = [p for p in points if p.push == push.name and p.controller == name]
                _draw(success, force, own, look, name)
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
        figure.legend(handles, labels, loc="outside upper left", ncols=len(labels))
        return svg(figure, "sweep", "Success and radial force while one parameter leaves its range")


def _draw(success: Axes, force: Axes, points: Sequence[Point], look: Look, name: str) -> None:
    values = [p.value for p in points]
    rates = [100.0 * p.success.value for p in points]
    means = [1e3 * float(p.figures.values["radial_mean"].mean()) for p in points]
    for axes, heights in ((success, rates), (force, means)):
        axes.plot(
            values,
            heights,
            color=look.colour,
            linestyle=look.dashes,
            marker="o",
            markersize=3.0,
            label=name,
        )
    success.fill_between(
        values,
        [100.0 * p.success.low for p in points],
        [100.0 * p.success.high for p in points],
        color=look.colour,
        alpha=0.15,
        linewidth=0.0,
    )
