"""What the figures of a report share: sizes, line thinning, hole walls and limits."""

from collections.abc import Mapping, Sequence
from types import MappingProxyType

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from controllers.messages import Severity
from hil.log_reader import Rows
from learning.drawing import LIMIT_COLOUR, WALL_COLOUR

_WIDTH_IN = 11.0
_LEFT_IN, _RIGHT_IN, _BOTTOM_IN = 0.72, 0.2, 0.5
Sheet = tuple[Figure, list[list[Axes]]]
"""A figure and its panels by row and column."""

BINS = 700
"""So many bins across a figure are finer than what can be seen."""

DARK_COLOURS = ("#00395A", "#7A2E00", "#00503A")

SEVERITY_MARKS: Mapping[Severity, tuple[str, str]] = MappingProxyType(
    {
        Severity.PASS: ("o", "#56B4E9"),
        Severity.REDUCE: ("v", "#E69F00"),
        Severity.HOLD: ("s", "#CC79A7"),
        Severity.RETREAT: ("^", "#7B3294"),
        Severity.STOP: ("X", "#A00000"),
    }
)
"""Marker and colour."""


def sheet(height_in: float, top_in: float, ratios: Sequence[float], columns: int = 1) -> Sheet:
    """Return a figure as wide as the page, with panels in rows of heights `ratios` and in columns.

    Panels of a column share their x axis, panels of a row their y axis. The margins are the same in
    all figures, so that their axes stand below one another; `top_in` is for titles and legend.
    """
    figure = Figure(figsize=(_WIDTH_IN, height_in))
    panels = figure.subplots(
        len(ratios),
        columns,
        squeeze=False,
        sharex="col",
        sharey="row",
        gridspec_kw={
            "height_ratios": ratios,
            "left": _LEFT_IN / _WIDTH_IN,
            "right": 1.0 - _RIGHT_IN / _WIDTH_IN,
            "bottom": _BOTTOM_IN / height_in,
            "top": 1.0 - top_in / height_in,
            "wspace": 0.07,
            "hspace": 0.12,
        },
    )
    return figure, [list(row) for row in panels]


def legend(axes: Axes, handles: Sequence[Artist], labels: Sequence[str]) -> None:
    """Put a legend in one row into the upper right corner of the figure that holds `axes`."""
    axes.figure.legend(
        handles,
        labels,
        loc="upper right",
        bbox_to_anchor=(1.0 - _RIGHT_IN / _WIDTH_IN, 1.0),
        ncols=len(handles),
        borderpad=0.0,
        borderaxespad=0.2,
    )


def show_at_least(axes: Axes, least: float) -> None:
    """Widen the y axis, so that it reaches from -`least` to `least` or further."""
    low, high = axes.get_ylim()
    axes.set_ylim(min(low, -least), max(high, least))


def thinned(x: Rows, y: Rows, bins: int = BINS) -> tuple[Rows, Rows]:
    """Return the line through the smallest and largest `y` of each of `bins` bins along `x`.

    No peak gets lost. Values that are not finite are left out.
    """
    finite = np.isfinite(x) & np.isfinite(y)
    x, y = x[finite], y[finite]
    if x.size <= 2 * bins:
        return x, y
    edges = np.linspace(x.min(), x.max(), bins + 1)
    bin_of = np.clip(np.searchsorted(edges, x, side="right") - 1, 0, bins - 1)
    order = np.argsort(bin_of, kind="stable")
    starts = np.flatnonzero(np.diff(bin_of[order], prepend=-1))
    lows = np.minimum.reduceat(y[order], starts)
    highs = np.maximum.reduceat(y[order], starts)
    centres = 0.5 * (edges[:-1] + edges[1:])[bin_of[order][starts]]
    return np.repeat(centres, 2), np.column_stack([lows, highs]).ravel()


def shade_walls(axes: Axes, walls_m: Sequence[tuple[float, float]], named: bool = False) -> None:
    """Shade the depths of the hole walls [mm on the axis]; write their names above them."""
    names = ("upper hole", "lower hole") if len(walls_m) == 2 else ()
    low_mm, high_mm = axes.get_xlim()
    for index, (upper_m, lower_m) in enumerate(walls_m):
        start_mm, end_mm = max(upper_m * 1e3, low_mm), min(lower_m * 1e3, high_mm)
        if start_mm >= end_mm:
            continue
        axes.axvspan(start_mm, end_mm, color=WALL_COLOUR, zorder=0, linewidth=0)
        if named:
            axes.text(
                0.5 * (start_mm + end_mm),
                1.02,
                names[index] if names else f"hole {index + 1}",
                transform=axes.get_xaxis_transform(),
                ha="center",
                va="bottom",
                color="#6B6455",
                fontsize=8.5,
            )


def draw_limits(axes: Axes, limit_N: float) -> None:
    """Draw a force limit on both sides of zero [mN on the axis], where it lies within the view."""
    limit_mN = limit_N * 1e3
    draw_level(axes, limit_mN, f"limit {limit_mN:g} mN")
    draw_level(axes, -limit_mN, f"limit -{limit_mN:g} mN")


def draw_level(axes: Axes, value: float, label: str) -> None:
    """Draw a limit across the axes, if it lies within the view."""
    low, high = axes.get_ylim()
    if not low <= value <= high:
        return
    axes.axhline(value, color=LIMIT_COLOUR, linestyle=(0, (6, 3)), linewidth=1.0, zorder=1)
    axes.annotate(
        label,
        (0.0, value),
        xycoords=axes.get_yaxis_transform(),
        xytext=(4, -2 if value > 0.0 else 2),
        textcoords="offset points",
        va="top" if value > 0.0 else "bottom",
        color=LIMIT_COLOUR,
        fontsize=8.0,
    )
