"""Frame M, pose and edge circles: the solids in oblique view, and the pose in section."""

import numpy as np
import numpy.typing as npt
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from figures_of.paint import (
    EDGE_COLOUR,
    FAINT_COLOUR,
    NOTE_COLOUR,
    RIM_COLOUR,
    SHAFT_COLOUR,
    SHAFT_LINE,
    WALL_FILL,
    WALL_LINE,
    arrow,
    bare,
    measure,
    note,
    pair,
)
from figures_of.paper_part import PART, SHAFT
from figures_of.section import HALF_WIDTH, Section
from learning.drawing import drawing, svg
from simulator.geometry import shaft_axis

FloatArray = npt.NDArray[np.float64]

POSE = np.array([4e-6, 0.0, 1.45e-3, 0.0, np.radians(0.3)])
GAIN = 25.0
OBLIQUE = np.array([[1.0, -0.14, 0.0], [0.0, -0.26, 1.0]])
"""Drawn right and down, of x, y and z."""
TILTED = np.array([0.10, 0.0, 1.35, 0.0, np.radians(5.0)])
"""A pose [mm, rad] whose tilt can be seen without enlargement."""
SHAFT_RADIUS, SHAFT_LENGTH, BORE_RADIUS, WALL_RADIUS = 0.40, 3.0, 0.56, 1.0
RIMS = (0.0, 0.5, 1.6, 2.1)
"""Sizes of the oblique view [mm]: a thinner shaft than the paper's in wider holes."""


def draw() -> str:
    """Draw both views."""
    with drawing():
        figure = Figure(figsize=(11.0, 6.3))
        left, right = figure.subplots(
            1,
            2,
            gridspec_kw={
                "left": 0.01,
                "right": 0.99,
                "bottom": 0.01,
                "top": 0.94,
                "wspace": 0.03,
                "width_ratios": (1.0, 1.1),
            },
        )
        left.set_title("Edge circles of part and shaft (not to scale)")
        right.set_title(f"Pose in the plane y = 0 (clearance and tilt enlarged {GAIN:g} times)")
        _draw_circles(left)
        _draw_pose(right)
        return svg(figure, "frames", "Frame M, pose of the shaft, and edge circles")


def _circle(centre: FloatArray, radius: float, u: FloatArray) -> FloatArray:
    """Drawn points (2, 181) of a circle about `u`, which lies in the plane y = 0."""
    angle = np.linspace(0.0, 2.0 * np.pi, 181)
    across = np.array([u[2], 0.0, -u[0]])
    ring = np.outer(across, np.cos(angle)) + np.outer((0.0, 1.0, 0.0), np.sin(angle))
    drawn: FloatArray = OBLIQUE @ (centre[:, np.newaxis] + radius * ring)
    return drawn


def _hull(*circles: FloatArray) -> FloatArray:
    """Outline (2, n) around two drawn circles of one direction."""
    first, second = circles
    way = (second - first)[:, 0]
    side = first[0] * way[1] - first[1] * way[0]
    low, high = sorted((int(side.argmin()), int(side.argmax())))
    inner, outer = first[:, low : high + 1], np.hstack([first[:, high:], first[:, : low + 1]])
    forward = inner if way @ inner.mean(axis=1) < way @ outer.mean(axis=1) else outer
    other = outer if forward is inner else inner
    return np.hstack([forward, other + way[:, np.newaxis]])


def _draw_circles(axes: Axes) -> None:
    """Draw the walls as discs around the shaft, with the names of circles and lengths."""
    z = np.array([0.0, 0.0, 1.0])
    u = shaft_axis(TILTED)
    tip = TILTED[:3]
    rims = [_circle(z * depth, BORE_RADIUS, z) for depth in RIMS]
    ends = [_circle(tip - s * u, SHAFT_RADIUS, u) for s in (0.0, SHAFT_LENGTH)]
    for upper, lower in (RIMS[:2], RIMS[2:]):
        disc = _hull(_circle(z * upper, WALL_RADIUS, z), _circle(z * lower, WALL_RADIUS, z))
        axes.fill(*disc, facecolor=WALL_FILL, edgecolor=WALL_LINE, alpha=0.75, zorder=1)
    for bore in (_hull(*rims[:2]), _hull(*rims[2:])):
        axes.fill(*bore, facecolor="white", alpha=0.6, edgecolor="none", zorder=1.5)
    axes.fill(*_hull(*ends), facecolor=SHAFT_COLOUR, alpha=0.8, edgecolor=SHAFT_LINE, zorder=2)
    for index, rim in enumerate(rims):
        axes.plot(*rim, color=RIM_COLOUR, linewidth=1.6, zorder=3)
        at = (1.13, RIMS[index])
        note(axes, at, f"A{index + 1}", RIM_COLOUR, ha="left", weight="bold")
    for name, ring, shift in (("B2", ends[0], -0.62), ("B1", ends[1], 0.62)):
        axes.plot(*ring, color=EDGE_COLOUR, linewidth=1.8, zorder=4)
        centre = ring[:, :-1].mean(axis=1)
        note(axes, (centre[0] + shift, centre[1]), name, EDGE_COLOUR, weight="bold")
    _draw_axis(axes, tip, u)
    x = 1.42
    measure(axes, (x, RIMS[0]), (x, RIMS[1]), "wall", (x + 0.08, 0.25), ha="left")
    measure(axes, (x, RIMS[1]), (x, RIMS[2]), "gap", (x + 0.08, 1.05), ha="left")
    measure(axes, (x, RIMS[2]), (x, RIMS[3]), "wall", (x + 0.08, 1.85), ha="left")
    bare(axes)
    axes.set_xlim(-1.45, 1.85)
    axes.set_ylim(2.75, -2.05)


def _draw_axis(axes: Axes, tip: FloatArray, u: FloatArray) -> None:
    """Draw frame M at A1 and the shaft's axis with p, s and u."""
    origin = np.zeros(3)
    for end, name, shift in (
        (np.array([0.62, 0.0, 0.0]), "x", (0.08, 0.0)),
        (np.array([0.0, 0.95, 0.0]), "y", (-0.07, -0.04)),
        (np.array([0.0, 0.0, 0.75]), "z", (-0.08, 0.0)),
    ):
        at = OBLIQUE @ end
        arrow(axes, pair(OBLIQUE @ origin), pair(at), NOTE_COLOUR, 1.2)
        note(axes, (at[0] + shift[0], at[1] + shift[1]), name, weight="bold")
    top = OBLIQUE @ (tip - (SHAFT_LENGTH + 0.25) * u)
    axes.plot(*zip(top, OBLIQUE @ tip, strict=True), color=SHAFT_LINE, linewidth=0.8, dashes=(8, 3))
    arrow(axes, pair(OBLIQUE @ tip), pair(OBLIQUE @ (tip + 0.6 * u)), SHAFT_LINE, 1.8)
    at = OBLIQUE @ (tip + 0.6 * u)
    note(axes, (at[0] + 0.1, at[1] + 0.03), "u", SHAFT_LINE, ha="left", weight="bold")
    axes.plot(*(OBLIQUE @ tip), "o", color=SHAFT_LINE, markersize=4.5, zorder=8)
    note(axes, (tip[0] - 0.1, tip[2] + 0.02), "p", SHAFT_LINE, ha="right", weight="bold")


def _draw_pose(axes: Axes) -> None:
    """Draw the section with depth, offset, tilt and the distance s behind the leading plane."""
    section = Section(PART, SHAFT, POSE, GAIN, top_mm=-0.85)
    section.draw_solids(axes)
    z = np.array([-1.05, POSE[2] * 1e3])
    middle = 0.5 * (section.flank(z, 1.0) + section.flank(z, -1.0))
    tip = (float(middle[1]), float(z[1]))
    axes.plot(middle, z, color=SHAFT_LINE, linewidth=0.8, dashes=(8, 3), zorder=5)
    axes.plot(
        [0.0, 0.0], [-1.05, 2.75], color=WALL_LINE, linewidth=0.8, dashes=(8, 3, 2, 3), zorder=5
    )
    along = np.array([np.diff(middle)[0], np.diff(z)[0]])
    along *= 0.5 / np.hypot(*along)
    arrow(axes, tip, (tip[0] + along[0], tip[1] + along[1]), SHAFT_LINE, 1.8)
    note(
        axes,
        (tip[0] + along[0] + 0.06, tip[1] + along[1]),
        "u",
        SHAFT_LINE,
        ha="left",
        weight="bold",
    )
    axes.plot(*tip, "o", color=SHAFT_LINE, markersize=4.5, zorder=8)
    note(axes, (tip[0] + 0.07, tip[1] - 0.09), "p", SHAFT_LINE, ha="left", weight="bold")
    arrow(axes, (0.0, 0.0), (0.36, 0.0), NOTE_COLOUR, 1.2)
    note(axes, (0.41, -0.01), "x", weight="bold")
    arrow(axes, (0.0, 0.0), (0.0, 0.36), NOTE_COLOUR, 1.2)
    note(axes, (-0.06, 0.36), "z", weight="bold")
    note(axes, (-0.1, -0.09), "M", weight="bold")
    for index, depth in enumerate(PART.rim_depths_m * 1e3):
        note(
            axes,
            (HALF_WIDTH + 0.64, float(depth)),
            f"A{index + 1}",
            RIM_COLOUR,
            ha="left",
            weight="bold",
        )
    note(axes, (-0.17, -1.1), "tilt ry", ha="center")
    _draw_distance_behind(axes, section)
    x = -1.18
    axes.plot([x - 0.05, tip[0]], [tip[1]] * 2, color=FAINT_COLOUR, linewidth=0.6)
    axes.plot([x - 0.05, -HALF_WIDTH - 0.55], [0.0, 0.0], color=FAINT_COLOUR, linewidth=0.6)
    measure(axes, (x, 0.0), (x, tip[1]), "depth p₃", (x - 0.06, 0.95), ha="right")
    bare(axes)
    axes.set_xlim(-1.75, 1.6)
    axes.set_ylim(2.75, -1.2)


def _draw_distance_behind(axes: Axes, section: Section) -> None:
    """Draw s, from the leading plane to a point of the shaft, beside the shaft."""
    z = np.array([section.tip_mm(1.0), 0.75])
    low, high = zip(section.flank(z, 1.0) + 0.12, z, strict=True)
    measure(axes, pair(np.array(low)), pair(np.array(high)), "s", (high[0] + 0.16, 1.1), ha="left")
