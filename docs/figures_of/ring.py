"""Four points that stand for a ring of contact, against an even elastic foundation."""

import numpy as np
import numpy.typing as npt
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from figures_of.paint import (
    FAINT_COLOUR,
    OVERLAP_COLOUR,
    RIM_COLOUR,
    SHAFT_LINE,
    WALL_LINE,
    arrow,
    note,
    pair,
)
from learning.drawing import drawing, svg

FloatArray = npt.NDArray[np.float64]

QUARTERS = 0.5 * np.pi * np.arange(4)
FOUNDATION = 2.0 / np.pi
"""Stiffness per radian of the foundation, in units of that of a point."""
DOTS = 4000


def four_points(
    delta: FloatArray, e: FloatArray, turn: float = 0.0
) -> tuple[FloatArray, FloatArray]:
    """Lateral force and energy [k = 1] of four points, the first at `turn` [rad] from that of e.

    Each has the penetration delta + e cos(phi), and counts where that is above zero.
    """
    angle = (turn + QUARTERS)[:, np.newaxis]
    penetration = np.maximum(delta + e * np.cos(angle), 0.0)
    return (penetration * np.cos(angle)).sum(axis=0), 0.5 * (penetration**2).sum(axis=0)


def foundation(delta: FloatArray, e: FloatArray) -> tuple[FloatArray, FloatArray]:
    """The same of a foundation of FOUNDATION per radian, summed over DOTS of it."""
    angle = (2.0 * np.pi / DOTS * np.arange(DOTS))[:, np.newaxis]
    penetration = np.maximum(delta + e * np.cos(angle), 0.0)
    share = FOUNDATION * 2.0 * np.pi / DOTS
    force = share * (penetration * np.cos(angle)).sum(axis=0)
    return force, 0.5 * share * (penetration**2).sum(axis=0)


def draw() -> str:
    """Draw the ring, the force of an interference fit, and that of a fit with clearance."""
    with drawing():
        figure = Figure(figsize=(11.0, 4.0))
        view, tight, loose = figure.subplots(
            1,
            3,
            gridspec_kw={"left": 0.01, "right": 0.985, "bottom": 0.13, "top": 0.90, "wspace": 0.24},
        )
        _draw_view(view)
        _draw_tight(tight)
        _draw_loose(loose)
        return svg(figure, "ring", "Four points against an even elastic foundation")


def _draw_view(axes: Axes) -> None:
    """Draw bore and shaft seen along z, with the four points."""
    delta, e, bore = 0.10, 0.06, 1.0
    angle = np.linspace(0.0, 2.0 * np.pi, 181)
    ring = np.stack([np.cos(angle), np.sin(angle)])
    shaft = np.array([[e], [0.0]]) + (bore + delta) * ring
    axes.fill(*shaft, facecolor=OVERLAP_COLOUR, edgecolor=SHAFT_LINE)
    axes.fill(*(bore * ring), facecolor="white", edgecolor=WALL_LINE)
    for index, phi in enumerate(QUARTERS):
        way = np.array([np.cos(phi), np.sin(phi)])
        penetration = delta + e * np.cos(phi)
        arrow(axes, pair(bore * way), pair((bore + 3.0 * penetration) * way), RIM_COLOUR, 1.6)
        axes.plot(*(bore * way), "o", color=RIM_COLOUR, markersize=5.5)
        text = ("δ + ε", "δ", "δ - ε", "δ")[index]
        note(axes, (float(0.76 * way[0]), float(0.82 * way[1])), text, RIM_COLOUR)
    axes.plot(0.0, 0.0, "+", color=WALL_LINE, markersize=9)
    note(axes, (0.0, -0.2), "penetration\nδ + ε cos φ", FAINT_COLOUR)
    axes.set_title("A shaft thicker than its hole")
    axes.set_aspect("equal", anchor="N")
    axes.set_axis_off()
    axes.set_xlim(-1.6, 1.6)
    axes.set_ylim(-1.45, 1.45)


def _draw_tight(axes: Axes) -> None:
    e = np.linspace(0.0, 4.0, 161)
    delta = np.ones_like(e)
    axes.plot(e, foundation(delta, e)[0], color=FAINT_COLOUR, linewidth=4.0, alpha=0.6)
    axes.plot(e, four_points(delta, e)[0], color=RIM_COLOUR)
    axes.axvline(1.0, color=FAINT_COLOUR, linewidth=0.8, dashes=(4, 3))
    note(axes, (1.07, 0.5), "all around\nup to here", FAINT_COLOUR, "left")
    note(axes, (2.3, 4.3), "foundation", FAINT_COLOUR, "right")
    note(axes, (2.4, 2.9), "four points", RIM_COLOUR, "left")
    axes.set_title("Interference δ > 0")
    axes.set_xlabel("offset ε / δ")
    axes.set_ylabel("lateral force / (k δ)")
    axes.set_xlim(0.0, 4.0)
    axes.set_ylim(0.0, 5.2)


def _draw_loose(axes: Axes) -> None:
    e = np.linspace(0.8, 4.0, 161)
    delta = -np.ones_like(e)
    axes.plot(e, foundation(delta, e)[0], color=FAINT_COLOUR, linewidth=4.0, alpha=0.6)
    axes.plot(e, four_points(delta, e)[0], color=RIM_COLOUR)
    note(axes, (2.75, 0.7), "foundation", FAINT_COLOUR, "left")
    note(axes, (1.9, 1.4), "one point", RIM_COLOUR, "right")
    axes.set_title("Clearance δ < 0: one point")
    axes.set_xlabel("offset ε / |δ|")
    axes.set_ylabel("lateral force / (k |δ|)")
    axes.set_xlim(0.8, 4.0)
    axes.set_ylim(0.0, 3.2)
