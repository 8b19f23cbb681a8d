"""The two kinds of contact, each in section and as seen along the axis of the other solid."""

import numpy as np
import numpy.typing as npt
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from figures_of.paint import (
    EDGE_COLOUR,
    FAINT_COLOUR,
    OVERLAP_COLOUR,
    RIM_COLOUR,
    SHAFT_COLOUR,
    SHAFT_LINE,
    WALL_FILL,
    WALL_LINE,
    arrow,
    bare,
    note,
    pair,
)
from learning.drawing import drawing, svg
from simulator.contact import solve
from simulator.geometry import Hole, Part, Shaft, shaft_axis

FloatArray = npt.NDArray[np.float64]

SHAFT = Shaft(diameter_m=1.0, length_m=4.0)
PART = Part((Hole(diameter_m=1.14, thickness_m=0.5),))
"""A loose fit, in arbitrary lengths, whose tilts and overlaps can be seen without enlargement."""
TILT = np.radians(12.0)
RIM_POSE = np.array([0.065, 0.0, 0.30, 0.0, -TILT])
EDGE_POSE = np.array([0.145, 0.0, 0.30, 0.0, TILT])
ASIDE = np.array([-0.02, 0.09, 0.0, 0.0, 0.0])
"""Added for the views along an axis, where the best point is not in the plane of the tilt."""
RIM, LEADING_EDGE = 0, 2
"""Candidates of a part with one hole: the rim A1, and the leading edge against the wall."""
NORMAL_LENGTH = 0.2
PLANE = [0, 2]
"""Components of a vector in the plane y = 0."""
TURN = np.linspace(0.0, 2.0 * np.pi, 121)
RING = np.stack([np.cos(TURN), np.sin(TURN)])


def draw() -> str:
    """Draw both kinds from the contacts that the model finds."""
    with drawing():
        figure = Figure(figsize=(11.0, 7.6))
        panels = figure.subplots(
            2,
            2,
            gridspec_kw={
                "left": 0.01,
                "right": 0.99,
                "bottom": 0.01,
                "top": 0.955,
                "wspace": 0.04,
                "hspace": 0.10,
                "height_ratios": (0.8, 1.0),
            },
        )
        panels[0, 0].set_title("Shaft-based: a rim against the shaft's surface", color=RIM_COLOUR)
        panels[0, 1].set_title("Hole-based: a shaft edge against a wall", color=EDGE_COLOUR)
        _draw_rim_section(panels[0, 0])
        _draw_edge_section(panels[0, 1])
        _draw_along_shaft(panels[1, 0])
        _draw_along_hole(panels[1, 1])
        return svg(figure, "contact-kinds", "Shaft-based and hole-based contact")


def _contact(pose: FloatArray, index: int) -> tuple[FloatArray, FloatArray, float]:
    """Point (3,), normal (3,) and overlap of a candidate, which must touch."""
    contacts = solve(PART, SHAFT, pose, (0.0, 0.0, 0.0))
    if contacts.penetration[index] <= 0.0:
        raise ValueError(f"candidate {index} does not touch at {pose}")
    return contacts.point[index], contacts.normal[index], float(contacts.overlap[index])


def _draw_section(axes: Axes, pose: FloatArray) -> None:
    """Draw shaft and wall around the contact on the side of +x, in the plane y = 0."""
    u = shaft_axis(pose)[PLANE]
    across = np.array([u[1], -u[0]])
    tip, radius = pose[PLANE], SHAFT.radius_m
    corners = [tip - radius * across, tip + radius * across]
    corners += [corner - 2.0 * u for corner in reversed(corners)]
    bore, thickness = float(PART.wall_radii_m[0]), PART.holes[0].thickness_m
    wall = [(bore, 0.0), (2.0, 0.0), (2.0, thickness), (bore, thickness)]
    axes.fill(*zip(*wall, strict=True), facecolor=WALL_FILL, edgecolor=WALL_LINE, zorder=1)
    axes.fill(*zip(*corners, strict=True), facecolor=SHAFT_COLOUR, edgecolor="none", zorder=2)
    overlap = axes.fill(*zip(*corners, strict=True), facecolor=OVERLAP_COLOUR, zorder=3)[0]
    overlap.set_clip_path(axes.fill(*zip(*wall, strict=True), facecolor="none")[0])
    axes.fill(*zip(*corners, strict=True), facecolor="none", edgecolor=SHAFT_LINE, zorder=4)
    axes.plot(*zip(tip, tip - 2.0 * u, strict=True), color=SHAFT_LINE, linewidth=0.8, dashes=(8, 3))
    axes.plot([0, 0], [-1, 1], color=WALL_LINE, linewidth=0.8, dashes=(8, 3, 2, 3), zorder=5)
    arrow(axes, pair(tip), pair(tip + 0.13 * u), SHAFT_LINE)
    axes.plot(*tip, "o", color=SHAFT_LINE, markersize=4.5, zorder=8)
    note(
        axes, (float(tip[0]) - 0.03, float(tip[1]) + 0.05), "p", SHAFT_LINE, "right", weight="bold"
    )
    note(axes, (bore + 0.33, 0.46), "wall", WALL_LINE)
    note(axes, (0.28, 0.03), "shaft", SHAFT_LINE)
    bare(axes)
    axes.set_xlim(-0.12, 1.15)
    axes.set_ylim(0.52, -0.24)


def _draw_rim_section(axes: Axes) -> None:
    _draw_section(axes, RIM_POSE)
    point, normal, overlap = _contact(RIM_POSE, RIM)
    _draw_contact(axes, point[PLANE], normal[PLANE], RIM_COLOUR, "o", "rim A1, e*")
    _draw_depth(axes, point[PLANE], (point + overlap * normal)[PLANE], "δ")
    text = "n is normal to the shaft:\nit has an axial part"
    note(axes, (1.13, -0.17), text, RIM_COLOUR, "right")


def _draw_edge_section(axes: Axes) -> None:
    _draw_section(axes, EDGE_POSE)
    point, normal, overlap = _contact(EDGE_POSE, LEADING_EDGE)
    _draw_contact(axes, point[PLANE], normal[PLANE], EDGE_COLOUR, "s", "edge B2, e*")
    _draw_depth(axes, point[PLANE], (point - overlap * normal)[PLANE], "δ")
    text = "n is normal to the bore:\nit has no axial part"
    note(axes, (1.13, -0.17), text, EDGE_COLOUR, "right")


def _draw_contact(
    axes: Axes, point: FloatArray, normal: FloatArray, colour: str, marker: str, name: str
) -> None:
    """Mark the point of contact, with its normal and name."""
    end = point + NORMAL_LENGTH * normal
    arrow(axes, pair(point), pair(end), colour, 1.8)
    axes.plot(*point, marker, color=colour, markersize=6.5, zorder=9)
    note(axes, (float(end[0]) + 0.02, float(end[1])), "n", colour, "left", weight="bold")
    below = (float(point[0]) + 0.1, float(point[1]) + 0.11)
    note(axes, below, name, colour, "left", weight="bold")


def _draw_depth(axes: Axes, start: FloatArray, end: FloatArray, text: str) -> None:
    """Draw the penetration, and write its name aside."""
    axes.plot(*zip(start, end, strict=True), color="black", linewidth=2.2, zorder=8)
    middle, way = 0.5 * (start + end), end - start
    aside = 0.055 * np.array([-way[1], way[0]]) / np.hypot(*way)
    note(axes, pair(middle - aside * np.sign(aside[1])), text, "black", size=11.0)


def _draw_along_shaft(axes: Axes) -> None:
    """Draw the plane across the shaft's axis, where a rim is an ellipse."""
    pose = RIM_POSE + ASIDE
    u = shaft_axis(pose)
    basis = np.array([[u[2], 0.0, -u[0]], [0.0, 1.0, 0.0]])
    point, normal, overlap = _contact(pose, RIM)
    rim = basis @ (np.vstack([PART.rim_radii_m[0] * RING, np.zeros(TURN.size)]).T - pose[:3]).T
    shaft = SHAFT.radius_m * RING
    _draw_plane(axes, shaft, rim)
    axes.plot(*rim, color=RIM_COLOUR, linewidth=1.8, zorder=5)
    axes.plot(*shaft, color=SHAFT_LINE, linewidth=1.2, zorder=5)
    centre = basis @ -pose[:3]
    drawn_normal = basis @ normal
    _draw_best(axes, centre, basis @ (point - pose[:3]), RIM_COLOUR, "o")
    _draw_radius(axes, basis @ (point - pose[:3]), drawn_normal, overlap)
    note(axes, (-1.33, 0.60), "seen along u", ha="left", weight="bold")
    note(axes, (-1.33, 0.49), "rim: an ellipse", RIM_COLOUR, ha="left")
    note(axes, (-1.33, 0.40), "shaft: a circle about its axis", SHAFT_LINE, ha="left")
    note(axes, (-1.33, 0.31), "e* is nearest to the axis", ha="left")


def _draw_along_hole(axes: Axes) -> None:
    """Draw the plane across the hole's axis, where an edge circle of the shaft is an ellipse."""
    pose = EDGE_POSE + ASIDE
    u = shaft_axis(pose)
    point, normal, overlap = _contact(pose, LEADING_EDGE)
    edge = pose[:2, np.newaxis] + SHAFT.radius_m * RING * np.array([[u[2]], [1.0]])
    hole = PART.wall_radii_m[0] * RING
    _draw_plane(axes, edge, hole)
    axes.plot(*edge, color=EDGE_COLOUR, linewidth=1.8, zorder=5)
    axes.plot(*hole, color=WALL_LINE, linewidth=1.2, zorder=5)
    _draw_best(axes, pose[:2], point[:2], EDGE_COLOUR, "s")
    _draw_radius(axes, point[:2], normal[:2], -overlap)
    note(axes, (-1.33, 0.60), "seen along z", ha="left", weight="bold")
    note(axes, (-1.33, 0.49), "edge: an ellipse", EDGE_COLOUR, ha="left")
    note(axes, (-1.33, 0.40), "bore: a circle about its axis", WALL_LINE, ha="left")
    note(axes, (-1.33, 0.31), "e* is farthest from the axis", ha="left")


def _draw_plane(axes: Axes, shaft: FloatArray, hole: FloatArray) -> None:
    """Draw the cross sections (2, n) of shaft and hole, and their overlap."""
    axes.axhspan(-0.72, 0.72, color=WALL_FILL, zorder=0)
    opening = axes.fill(*hole, facecolor="white", zorder=1)[0]
    axes.fill(*shaft, facecolor=OVERLAP_COLOUR, zorder=2)
    inside = axes.fill(*shaft, facecolor=SHAFT_COLOUR, zorder=3)[0]
    inside.set_clip_path(opening)
    bare(axes)
    axes.set_xlim(-1.38, 0.82)
    axes.set_ylim(-0.72, 0.72)


def _draw_best(axes: Axes, centre: FloatArray, point: FloatArray, colour: str, marker: str) -> None:
    """Draw e* from the centre of its circle to the point."""
    arrow(axes, pair(centre), pair(point), colour, 1.3)
    axes.plot(*centre, "+", color=colour, markersize=9, zorder=8)
    axes.plot(*point, marker, color=colour, markersize=6.5, zorder=9)
    middle = 0.45 * centre + 0.55 * point
    note(axes, (float(middle[0]), float(middle[1]) + 0.07), "e*", colour, weight="bold")


def _draw_radius(axes: Axes, point: FloatArray, normal: FloatArray, overlap: float) -> None:
    """Draw the line from the other solid's axis through the point, with the penetration on it."""
    surface = point + overlap * normal
    axes.plot([0.0, point[0]], [0.0, point[1]], color=FAINT_COLOUR, linewidth=0.9, zorder=4)
    axes.plot(0.0, 0.0, "x", color=FAINT_COLOUR, markersize=7, zorder=8)
    axes.plot(*zip(point, surface, strict=True), color="black", linewidth=2.2, zorder=8)
    note(axes, (0.03, -0.07), "axis", FAINT_COLOUR, "left")
    note(axes, pair(point + (max(overlap, 0.0) + 0.06) * normal), "δ", "black", size=11.0)
