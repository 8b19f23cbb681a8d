"""Worked ends and mouths: faces and edge circles of the meridians, and the least depth around."""

import numpy as np
import numpy.typing as npt
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Arc

from figures_of.paint import (
    EDGE_COLOUR,
    FAINT_COLOUR,
    NOTE_COLOUR,
    OVERLAP_COLOUR,
    RIM_COLOUR,
    SHAFT_COLOUR,
    SHAFT_LINE,
    WALL_FILL,
    WALL_LINE,
    Point,
    arrow,
    bare,
    note,
)
from figures_of.paper_part import PART, SHAFT
from learning.drawing import drawing, svg
from simulator.contact import solve
from simulator.geometry import Shaft, shaft_axis
from simulator.profile import Chamfer

FloatArray = npt.NDArray[np.float64]

CHAMFERED = Shaft(SHAFT.diameter_m, SHAFT.length_m, leading=Chamfer(20e-6, 20e-6))
POSE = np.array([4.5e-6, 8.0e-6, 22e-6, 0.0, np.radians(0.3)])
"""Rim A1 is where the chamfer ends, so that its best point lies between the two faces."""
RIM_A1 = 0
ANGLES = np.linspace(-10.0, 160.0, 341)
NORMAL = 0.16


def depths(angles_deg: FloatArray) -> FloatArray:
    """Depth [m] of points of A1 below the faces of the shaft: shape (2, n), chamfer and side."""
    angle = np.radians(angles_deg)
    ring = np.stack([np.cos(angle), np.sin(angle), np.zeros(angle.size)], axis=-1)
    offset = PART.rim_radii_m[RIM_A1] * ring - POSE[:3]
    u = shaft_axis(POSE)
    radial = np.linalg.norm(np.cross(offset, u), axis=-1)
    faces = CHAMFERED.faces
    result: FloatArray = faces.offsets_m[:, np.newaxis] - faces.normals @ [radial, -offset @ u]
    return result


def draw() -> str:
    """Draw three meridians, and the depths around a rim."""
    with drawing():
        figure = Figure(figsize=(11.0, 3.7))
        *meridians, around = figure.subplots(
            1,
            4,
            gridspec_kw={
                "left": 0.005,
                "right": 0.99,
                "bottom": 0.14,
                "top": 0.90,
                "wspace": 0.10,
                "width_ratios": (1.0, 1.0, 1.0, 1.75),
            },
        )
        _draw_chamfered(meridians[0])
        _draw_rounded(meridians[1])
        _draw_mouth(meridians[2])
        _draw_depths(around)
        box = around.get_position()
        around.set_position((box.x0 + 0.045, box.y0, box.width - 0.045, box.height))
        return svg(figure, "faces", "Faces and edge circles of worked ends and mouths")


def _circle_at(axes: Axes, at: Point, name: str, colour: str, text_at: Point, ha: str) -> None:
    axes.plot(*at, "o" if colour == RIM_COLOUR else "s", color=colour, markersize=6.0, zorder=6)
    note(axes, text_at, name, colour, ha)


def _normal_at(axes: Axes, at: Point, normal: Point, colour: str) -> None:
    arrow(axes, at, (at[0] + NORMAL * normal[0], at[1] + NORMAL * normal[1]), colour, 1.3)


def _frame(axes: Axes, title: str) -> None:
    bare(axes)
    axes.set_anchor("N")
    axes.set_xlim(0.0, 1.02)
    axes.set_ylim(1.14, 0.0)
    axes.set_title(title)


def _draw_chamfered(axes: Axes) -> None:
    shape = [(0.0, 0.0), (0.62, 0.0), (0.62, 0.62), (0.37, 1.0), (0.0, 1.0)]
    axes.fill(*zip(*shape, strict=True), facecolor=SHAFT_COLOUR, zorder=1)
    axes.plot(*zip(*shape[1:], strict=True), color=SHAFT_LINE, zorder=2)
    slant = np.array([0.38, 0.25]) / np.hypot(0.38, 0.25)
    _normal_at(axes, (0.62, 0.3), (1.0, 0.0), SHAFT_LINE)
    _normal_at(axes, (0.495, 0.81), (float(slant[0]), float(slant[1])), SHAFT_LINE)
    _circle_at(axes, (0.62, 0.62), "shoulder", EDGE_COLOUR, (0.66, 0.62), "left")
    _circle_at(axes, (0.37, 1.0), "nose", EDGE_COLOUR, (0.37, 1.08), "center")
    note(axes, (0.28, 0.45), "shaft", SHAFT_LINE)
    _frame(axes, "Chamfered end")


def _draw_rounded(axes: Axes) -> None:
    t = 0.3
    turn = np.linspace(0.0, 0.5 * np.pi, 46)
    x = np.concatenate([[0.0, 0.62], 0.32 + t * np.cos(turn), [0.0]])
    y = np.concatenate([[0.0, 0.0], 0.70 + t * np.sin(turn), [1.0]])
    axes.fill(x, y, facecolor=SHAFT_COLOUR, zorder=1)
    axes.plot(x[1:], y[1:], color=SHAFT_LINE, zorder=2)
    axes.add_patch(Arc((0.32, 0.70), 2 * t, 2 * t, color=FAINT_COLOUR, linestyle=":"))
    for turned in np.radians([20.0, 55.0]):
        way = (float(np.cos(turned)), float(np.sin(turned)))
        _normal_at(axes, (0.32 + t * way[0], 0.70 + t * way[1]), way, SHAFT_LINE)
    axes.plot([0.32, 0.32 - t * 0.8], [0.70, 0.70 - t * 0.6], color=FAINT_COLOUR, linewidth=0.8)
    note(axes, (0.20, 0.55), "t", FAINT_COLOUR)
    _circle_at(axes, (0.32, 0.70), "edge circle", EDGE_COLOUR, (0.30, 0.79), "center")
    note(axes, (0.28, 0.25), "shaft", SHAFT_LINE)
    _frame(axes, "Rounded end")


def _draw_mouth(axes: Axes) -> None:
    shape = [(1.0, 0.25), (0.52, 0.25), (0.34, 0.52), (0.34, 1.0), (1.0, 1.0)]
    axes.fill(*zip(*shape, strict=True), facecolor=WALL_FILL, zorder=1)
    axes.plot(*zip(*shape, strict=True), color=WALL_LINE, zorder=2)
    slant = np.array([0.27, 0.18]) / np.hypot(0.27, 0.18)
    _normal_at(axes, (0.43, 0.385), (float(slant[0]), float(slant[1])), WALL_LINE)
    _normal_at(axes, (0.34, 0.78), (1.0, 0.0), WALL_LINE)
    _circle_at(axes, (0.52, 0.25), "mouth", RIM_COLOUR, (0.52, 0.16), "center")
    _circle_at(axes, (0.34, 0.52), "throat", RIM_COLOUR, (0.30, 0.52), "right")
    _circle_at(axes, (0.34, 1.0), "lower rim", RIM_COLOUR, (0.40, 1.08), "center")
    note(axes, (0.72, 0.62), "wall", WALL_LINE)
    _frame(axes, "Chamfered mouth")


def _draw_depths(axes: Axes) -> None:
    chamfer, side = depths(ANGLES) * 1e6
    least = np.minimum(chamfer, side)
    contacts = solve(PART, CHAMFERED, POSE, (0.0, 0.0, 0.0))
    point = contacts.point[RIM_A1]
    best_deg = float(np.degrees(np.arctan2(point[1], point[0])))
    best_um = float(contacts.overlap[RIM_A1]) * 1e6
    axes.axhline(0.0, color="#BBBBBB", linewidth=0.7)
    axes.fill_between(ANGLES, 0.0, np.maximum(least, 0.0), color=OVERLAP_COLOUR, alpha=0.6, lw=0)
    axes.plot(ANGLES, side, color=FAINT_COLOUR, linewidth=1.1)
    axes.plot(ANGLES, chamfer, color=NOTE_COLOUR, linewidth=1.1, dashes=(5, 3))
    axes.plot(ANGLES, least, color=RIM_COLOUR, linewidth=2.2)
    axes.plot(best_deg, best_um, "o", color=RIM_COLOUR, markersize=6.5, zorder=6)
    note(axes, (best_deg + 4.0, best_um + 0.25), f"e*, {best_um:.2f} µm", RIM_COLOUR, "left")
    note(axes, (20.0, 3.75), "below\nthe side", FAINT_COLOUR)
    note(axes, (138.0, 2.7), "below\nthe chamfer", NOTE_COLOUR)
    note(axes, (57.0, 1.3), "rising", RIM_COLOUR)
    note(axes, (93.0, 1.3), "falling", RIM_COLOUR)
    axes.axvline(best_deg, color=RIM_COLOUR, linewidth=0.8, dashes=(2, 3))
    axes.set_title("A sharp rim on a chamfered end")
    axes.set_xlabel("place on the rim, from +x towards +y [deg]")
    axes.set_ylabel("depth f [µm]", labelpad=1.0)
    axes.set_xlim(-10.0, 160.0)
    axes.set_ylim(-2.0, 4.9)
