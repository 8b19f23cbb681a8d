"""What the drawings of the contact model share: colours, arrows, notes."""

import numpy as np
import numpy.typing as npt
from matplotlib.axes import Axes

from learning.drawing import WALL_COLOUR

SHAFT_COLOUR = "#C9D6E2"
SHAFT_LINE = "#2F4A61"
WALL_FILL = WALL_COLOUR
WALL_LINE = "#6B6455"
OVERLAP_COLOUR = "#E8827A"
RIM_COLOUR = "#7B3294"
"""Shaft-based: a rim of the part against the shaft's surface."""
EDGE_COLOUR = "#00796B"
"""Hole-based: an edge circle of the shaft against a wall."""
NOTE_COLOUR = "#333333"
FAINT_COLOUR = "#8A8A8A"

Point = tuple[float, float]


def pair(drawn: npt.NDArray[np.float64]) -> Point:
    """Return a drawn point (2,) as a tuple."""
    return float(drawn[0]), float(drawn[1])


def arrow(
    axes: Axes, start: Point, end: Point, colour: str = NOTE_COLOUR, width: float = 1.4
) -> None:
    """Draw an arrow from `start` to `end` in data units."""
    axes.annotate(
        "",
        end,
        start,
        arrowprops={
            "arrowstyle": "-|>,head_width=0.22,head_length=0.42",
            "color": colour,
            "linewidth": width,
            "shrinkA": 0.0,
            "shrinkB": 0.0,
        },
        zorder=6,
    )


def measure(axes: Axes, start: Point, end: Point, text: str, at: Point, ha: str = "center") -> None:
    """Draw a dimension line between two points, with its text at another."""
    axes.annotate(
        "",
        end,
        start,
        arrowprops={
            "arrowstyle": "<|-|>,head_width=0.13,head_length=0.28",
            "color": FAINT_COLOUR,
            "linewidth": 0.8,
            "shrinkA": 0.0,
            "shrinkB": 0.0,
        },
    )
    note(axes, at, text, ha=ha)


def note(
    axes: Axes,
    at: Point,
    text: str,
    colour: str = NOTE_COLOUR,
    ha: str = "center",
    va: str = "center",
    size: float = 9.0,
    weight: str = "normal",
) -> None:
    """Write `text` at a point in data units."""
    axes.text(*at, text, color=colour, ha=ha, va=va, fontsize=size, fontweight=weight, zorder=7)


def bare(axes: Axes) -> None:
    """Leave nothing of the axes but what is drawn in them, with equal scales."""
    axes.set_aspect("equal")
    axes.set_axis_off()
