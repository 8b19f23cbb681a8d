"""Quality against wall-clock time, one line per training."""

from collections.abc import Sequence

from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from benchmarks.off_the_shelf.runs import DIRECT, RESIDUAL, Run, by_name
from learning.drawing import drawing

COLOURS = {
    "paper": "#000000",
    "analytic": "#CC79A7",
    "ddpg": "#0072B2",
    "td3": "#D55E00",
    "sac": "#009E73",
}
NAMES = {
    "paper": "Tenon, Algorithm 1",
    "analytic": "Tenon, analytic gradient",
    "ddpg": "DDPG",
    "td3": "TD3",
    "sac": "SAC",
}
STYLES = {DIRECT: "-", RESIDUAL: (0, (4, 1.5))}
FIRST_S = 0.1
"""Where the axis of time begins; what is there before training is drawn at its edge."""


def draw(runs: Sequence[Run]) -> Figure:
    """Draw the share inserted, and what the score lacks, over time."""
    with drawing():
        figure = Figure(figsize=(9.0, 6.2), layout="constrained")
        upper, lower = figure.subplots(2, 1, sharex=True)
        for run in runs:
            seconds = [max(point.wall_s, FIRST_S) for point in run.points]
            look = {"color": COLOURS[run.task.trainer], "linestyle": STYLES[run.task.formulation]}
            for axes, values in (
                (upper, [100.0 * point.quality.inserted for point in run.points]),
                (lower, [1.0 - point.quality.score for point in run.points]),
            ):
                axes.plot(seconds, values, linewidth=1.1, alpha=0.8, **look)
        upper.set_ylabel("inserted within limits [%]")
        lower.set_ylabel("1 - score (better is above)")
        lower.set_yscale("log")
        lower.set_yticks(
            (1.0, 0.3, 0.1, 0.05, 0.03, 0.02, 0.01),
            ("1", "0.3", "0.1", "0.05", "0.03", "0.02", "0.01"),
        )
        lower.minorticks_off()
        lower.invert_yaxis()
        lower.set_xlabel("wall-clock time of training [s]")
        lower.set_xscale("log")
        lower.set_xlim(left=FIRST_S)
        handles = [
            Line2D(
                [],
                [],
                color=COLOURS[group[0].task.trainer],
                linestyle=STYLES[group[0].task.formulation],
                label=_label(group[0]),
            )
            for _, group in by_name(runs)
        ]
        figure.legend(handles=handles, loc="outside upper center", ncols=4)
        return figure


def _label(run: Run) -> str:
    how = "with expert" if run.task.formulation == RESIDUAL else "as registered"
    return f"{NAMES[run.task.trainer]}, {how}"
