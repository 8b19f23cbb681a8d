"""What the figures of a comparison share: a colour for each controller, and an axis of forces."""

from collections.abc import Sequence
from typing import NamedTuple

from matplotlib.axes import Axes
from matplotlib.ticker import NullLocator

from learning.drawing import WALL_COLOUR

WIDTH_IN = 11.0
_SOLID, _DASHED, _DOTTED = (0, ()), (0, (5, 1.5)), (0, (1.2, 1.2))
_DASH_DOT = (0, (5, 1.5, 1.2, 1.5))
_LINEAR_MN = 10.0
"""Up to here an axis of forces is linear, beyond it is logarithmic."""
_MARGIN_MN = 0.3
"""Room below zero, so that a line at zero is seen."""
_TICKS_MN = (0, 5, 10, 20, 50, 100, 200, 500, 1000, 2000, 5000)
_LABELS_MN = (0, 5, 10, 50, 200, 1000, 5000)


class Look(NamedTuple):
    """How a controller is drawn: colours that the colour-blind tell apart, and dashes as well."""

    colour: str
    dashes: tuple[int, tuple[float, ...]]


_LOOKS = (
    Look("#0072B2", _SOLID),
    Look("#D55E00", _DASHED),
    Look("#009E73", _DOTTED),
    Look("#CC79A7", _DASH_DOT),
    Look("#000000", _SOLID),
    Look("#56B4E9", _DASHED),
    Look("#E69F00", _DOTTED),
    Look("#7A5C00", _DASH_DOT),
)


def looks(names: Sequence[str]) -> dict[str, Look]:
    """Return a look for each controller, in their order; from the ninth on they come again."""
    return {name: _LOOKS[number % len(_LOOKS)] for number, name in enumerate(names)}


def force_axis_y(axes: Axes, least_mN: float, largest_mN: float) -> None:
    """Make y an axis of forces: linear to 10 mN, logarithmic beyond, as forces span decades."""
    top, bottom = 1.15 * max(largest_mN, _LINEAR_MN), 1.15 * least_mN - _MARGIN_MN
    steps = [v for v in _TICKS_MN if v <= top]
    ticks = [-v for v in reversed(steps) if v and -v >= bottom] + steps
    axes.set_yscale("symlog", linthresh=_LINEAR_MN, linscale=1.0)
    axes.set_ylim(bottom, top)
    axes.set_yticks(ticks, [f"{v:g}" for v in ticks])
    axes.yaxis.set_minor_locator(NullLocator())


def force_axis_x(axes: Axes, largest_mN: float) -> None:
    """Make x an axis of magnitudes of forces, as `force_axis_y`, with room for few labels."""
    top = max(largest_mN, _LINEAR_MN)
    axes.set_xscale("symlog", linthresh=_LINEAR_MN, linscale=1.0)
    axes.set_xlim(0.0, top)
    ticks = [v for v in _TICKS_MN if v <= top]
    axes.set_xticks(ticks, [f"{v:g}" if v in _LABELS_MN else "" for v in ticks])
    axes.xaxis.set_minor_locator(NullLocator())


def shade_wall(axes: Axes, start_mm: float, end_mm: float, name: str) -> None:
    """Shade the wall of a hole on an axis of depths; write its name above, if it has one."""
    low, high = axes.get_xlim()
    start_mm, end_mm = max(start_mm, low), min(end_mm, high)
    if start_mm >= end_mm:
        return
    axes.axvspan(start_mm, end_mm, color=WALL_COLOUR, zorder=0, linewidth=0)
    axes.set_xlim(low, high)
    axes.text(
        0.5 * (start_mm + end_mm),
        1.02,
        name,
        transform=axes.get_xaxis_transform(),
        ha="center",
        va="bottom",
        color="#6B6455",
        fontsize=8.5,
    )
