"""What the contact-pose filter believed along an insertion, against the truth where it is known."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from controllers.messages import ContactBelief
from hil.figures.style import DARK_COLOURS, legend, shade_walls, sheet
from hil.log_reader import Log, Rows
from hil.summary import RunFacts
from learning.drawing import AXIS_COLOURS, drawing, svg

SIGMAS = 2.0
"""Half the width of a band, in standard deviations."""


def beliefs_of(log: Log, number: int) -> list[ContactBelief]:
    """What was believed in insertion `number`, in order."""
    trace = log.trace(number)
    if not trace.stamps_ns.size:
        return []
    first_ns, last_ns = int(trace.stamps_ns[0]), int(trace.stamps_ns[-1])
    return [belief for belief in log.beliefs if first_ns <= belief.stamp_ns <= last_ns]


def true_pose_errors(log: Log, beliefs: list[ContactBelief]) -> Rows:
    """Offset x, y [m] and tilt x, y [rad] as they were at each belief: (n, 4), NaN if unknown."""
    reported = {seen.stamp_ns: seen.pose for seen in log.observations}
    true = {truth.stamp_ns: truth.shaft for truth in log.contact_states}
    errors = np.full((len(beliefs), 4), np.nan)
    for row, belief in enumerate(beliefs):
        if belief.stamp_ns in true and belief.stamp_ns in reported:
            shaft, stage = true[belief.stamp_ns], reported[belief.stamp_ns]
            errors[row, :2] = np.subtract(shaft.position, stage.position)[:2]
            errors[row, 2:] = np.subtract(shaft.rotation, stage.rotation)[:2]
    return errors


def belief_figure(log: Log, facts: RunFacts, number: int) -> str:
    """Draw offset and tilt of insertion `number` over depth, with bands and the truth.

    The insertion must have beliefs.
    """
    beliefs = beliefs_of(log, number)
    depth_of = {seen.stamp_ns: seen.depth_m for seen in log.observations}
    depth_mm = np.array([depth_of.get(belief.stamp_ns, np.nan) for belief in beliefs]) * 1e3
    mean = np.array([belief.mean[:4] for belief in beliefs])
    std = np.array([belief.std[:4] for belief in beliefs])
    truth = true_pose_errors(log, beliefs)
    scales = (1e6, 1e6, np.degrees(1.0), np.degrees(1.0))
    with drawing():
        figure, grid = sheet(4.4, 0.6, (1, 1), columns=2)
        for parameter, scale in enumerate(scales):
            row, axis = divmod(parameter, 2)
            panel = grid[row][axis]
            values = (each[:, parameter] * scale for each in (mean, std, truth))
            _draw(panel, depth_mm, axis, *values)
            panel.set_xlim(0.0, max(0.05, float(np.nanmax(depth_mm))))
            shade_walls(panel, facts.walls_m, named=row == 0)
        for axis, name in enumerate("xy"):
            grid[0][axis].set_title(f"offset along {name}, tilt about {name}", pad=18)
            grid[1][axis].set_xlabel("depth (mm)")
        grid[0][0].set_ylabel("offset (um)")
        grid[1][0].set_ylabel("tilt (deg)")
        line, true = Line2D([], [], color="#222222"), Line2D([], [], color="#222222", ls="--")
        band = Patch(color="#999999", alpha=0.4)
        legend(grid[0][0], (line, band, true), ("believed", "2 standard deviations", "true"))
        return svg(figure, "belief", "Believed and true offset and tilt of the shaft over depth")


def _draw(axes: Axes, depth_mm: Rows, axis: int, mean: Rows, std: Rows, truth: Rows) -> None:
    axes.axhline(0.0, color="#BBBBBB", linewidth=0.7, zorder=1)
    axes.fill_between(
        depth_mm,
        mean - SIGMAS * std,
        mean + SIGMAS * std,
        color=AXIS_COLOURS[axis],
        alpha=0.3,
        linewidth=0.0,
    )
    axes.plot(depth_mm, mean, color=DARK_COLOURS[axis])
    axes.plot(depth_mm, truth, color="#222222", linestyle="--", linewidth=1.0)
