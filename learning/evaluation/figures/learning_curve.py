"""How trainings went, round by round (as Figure 9 of the paper)."""

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

from learning.drawing import drawing, svg
from learning.evaluation.figures.style import WIDTH_IN
from learning.evaluation.training_log import TrainingLog
from simulator.checks import FloatArray

_RECENT = 20
"""Rounds that success is averaged over."""
_COLOUR = "#0072B2"


def learning_curve_figure(logs: Sequence[TrainingLog]) -> str:
    """Draw reward, steps, peak force and success by round: median and range over the trainings."""
    panels = (
        ("reward of a step, mean", "reward_per_step"),
        ("steps of the round", "steps"),
        ("peak radial force (mN)", "peak_mN"),
        (f"success, last {_RECENT} rounds (%)", "success"),
    )
    rounds = min(len(log.success) for log in logs)
    numbers = np.arange(1, rounds + 1)
    with drawing():
        figure = Figure(figsize=(WIDTH_IN, 4.6))
        grid = figure.subplots(2, 2, sharex=True)
        figure.subplots_adjust(
            left=0.07, right=0.98, top=0.95, bottom=0.1, hspace=0.14, wspace=0.16
        )
        for axes, (label, name) in zip(grid.flat, panels, strict=True):
            rows = np.array([getattr(log, name)[:rounds] for log in logs])
            if name == "success":
                rows = 1e2 * np.array([_recent(row) for row in rows])
                axes.set_ylim(-3.0, 103.0)
            if len(logs) > 1:
                axes.fill_between(
                    numbers,
                    rows.min(axis=0),
                    rows.max(axis=0),
                    color=_COLOUR,
                    alpha=0.2,
                    linewidth=0,
                    label=f"range over {len(logs)} trainings",
                )
            line = "median" if len(logs) > 1 else "training"
            axes.plot(numbers, np.median(rows, axis=0), color=_COLOUR, label=line)
            axes.set_ylabel(label)
            axes.set_xlim(1, rounds)
        for axes in grid[1]:
            axes.set_xlabel("round")
        if len(logs) > 1:
            grid[0][0].legend(loc="lower right")
        return svg(figure, "learning-curve", "Reward, steps, peak force and success by round")


def _recent(success: FloatArray) -> FloatArray:
    """Return the share of successes of the rounds up to each one, at most `_RECENT` of them."""
    total = np.cumsum(success)
    before = np.concatenate([np.zeros(_RECENT), total[:-_RECENT]])[: len(total)]
    shares: FloatArray = (total - before) / np.minimum(np.arange(1, len(total) + 1), _RECENT)
    return shares
