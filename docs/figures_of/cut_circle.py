"""The effective penetration around circles that an end cuts."""

import numpy as np
import numpy.typing as npt
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from figures_of.paint import (
    EDGE_COLOUR,
    FAINT_COLOUR,
    NOTE_COLOUR,
    OVERLAP_COLOUR,
    RIM_COLOUR,
    note,
)
from figures_of.paper_part import PART, SHAFT
from learning.drawing import drawing, svg
from simulator.contact import solve
from simulator.geometry import shaft_axis

FloatArray = npt.NDArray[np.float64]

TILT = np.radians(0.3)
RIM_POSE = np.array([4.5e-6, 8.0e-6, 0.9e-6, 0.0, TILT])
"""The leading end has just reached the plane of A1, on one side only."""
EDGE_POSE = np.array([4.5e-6, 8.0e-6, 502.0e-6, 0.0, TILT])
"""The leading edge is leaving the upper wall, on one side."""
RIM_A1, EDGE_AT_UPPER_WALL = 0, 4
ANGLES = np.linspace(-180.0, 180.0, 361)
"""Directions on the circle from +x towards +y [deg]."""


def rim_terms(
    pose: FloatArray, angles_deg: FloatArray = ANGLES
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Overlap f, distance entered g and what is left of the shaft, around A1 [m]."""
    angle = np.radians(angles_deg)
    ring = np.stack([np.cos(angle), np.sin(angle), np.zeros(angle.size)], axis=-1)
    offset = PART.rim_radii_m[0] * ring - pose[:3]
    u = shaft_axis(pose)
    behind = -offset @ u
    distance = np.linalg.norm(np.cross(offset, u), axis=-1)
    return SHAFT.radius_m - distance, behind, SHAFT.length_m - behind


def edge_terms(
    pose: FloatArray, angles_deg: FloatArray = ANGLES
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Overlap f, distance entered g and distance past the upper wall, around B2 [m]."""
    angle = np.radians(angles_deg)
    u = shaft_axis(pose)
    across = np.array([u[2], 0.0, -u[0]])
    ring = np.outer(np.cos(angle), across) + np.outer(np.sin(angle), (0.0, 1.0, 0.0))
    point = pose[:3] + SHAFT.radius_m * ring
    overlap = np.hypot(point[:, 0], point[:, 1]) - PART.wall_radii_m[0]
    entered = point[:, 2] - PART.wall_entries_m[0]
    return overlap, entered, point[:, 2] - PART.wall_exits_m[0]


def draw() -> str:
    """Draw a rim that the end is reaching, and an edge that is leaving a wall."""
    with drawing():
        figure = Figure(figsize=(11.0, 4.1))
        rim, edge = figure.subplots(
            1,
            2,
            sharey=True,
            gridspec_kw={"left": 0.06, "right": 0.99, "bottom": 0.125, "top": 0.91, "wspace": 0.06},
        )
        overlap, entered, left = rim_terms(RIM_POSE)
        effective = np.minimum(np.minimum(overlap, entered), left)
        _draw_terms(rim, overlap, effective, RIM_COLOUR)
        _mark(rim, RIM_POSE, RIM_A1, overlap, effective, RIM_COLOUR, 128.0)
        rim.plot(ANGLES, entered * 1e6, color=NOTE_COLOUR, linewidth=1.1, dashes=(5, 3))
        note(rim, (150.0, 3.6), "entered g", ha="center")
        note(rim, (41.0, 4.5), "overlap f", FAINT_COLOUR)
        note(rim, (32.0, -0.85), "min(f, g)", RIM_COLOUR, weight="bold")
        rim.set_title("Rim A1 at depth 0.9 µm: being entered")
        rim.set_ylabel("length [µm]")

        overlap, entered, past = edge_terms(EDGE_POSE)
        effective = np.minimum(overlap, entered) - np.maximum(past, 0.0)
        _draw_terms(edge, overlap, effective, EDGE_COLOUR)
        _mark(edge, EDGE_POSE, EDGE_AT_UPPER_WALL, overlap, effective, EDGE_COLOUR, -8.0)
        edge.plot(ANGLES, past * 1e6, color=NOTE_COLOUR, linewidth=1.1, dashes=(5, 3))
        note(edge, (128.0, 4.5), "past the wall, g - l", ha="center")
        note(edge, (78.0, 4.55), "f", FAINT_COLOUR)
        note(edge, (54.0, 2.3), "f - max(0, g - l)", EDGE_COLOUR, weight="bold")
        edge.set_title("Edge B2 at 2 µm below the upper wall: leaving")
        return svg(
            figure, "cut-circle", "Effective penetration around two circles that an end cuts"
        )


def _draw_terms(axes: Axes, overlap: FloatArray, effective: FloatArray, colour: str) -> None:
    """Draw overlap and effective penetration, shaded where there is contact."""
    axes.axhline(0.0, color="#BBBBBB", linewidth=0.7)
    axes.fill_between(
        ANGLES, 0.0, np.maximum(effective, 0.0) * 1e6, color=OVERLAP_COLOUR, alpha=0.6, linewidth=0
    )
    axes.plot(ANGLES, overlap * 1e6, color=FAINT_COLOUR, linewidth=1.1)
    axes.plot(ANGLES, effective * 1e6, color=colour, linewidth=2.2)
    axes.set_xlabel("place on the circle, from +x towards +y [deg]")
    axes.set_xticks(np.arange(0.0, 181.0, 30.0))
    axes.set_xlim(-10.0, 180.0)
    axes.set_ylim(-2.5, 5.2)


def _mark(
    axes: Axes,
    pose: FloatArray,
    index: int,
    overlap: FloatArray,
    effective: FloatArray,
    colour: str,
    at_deg: float,
) -> None:
    """Mark e*, and the greatest effective penetration as the model has it."""
    contacts = solve(PART, SHAFT, pose, (0.0, 0.0, 0.0))
    best = int(overlap.argmax())
    axes.plot(ANGLES[best], overlap[best] * 1e6, "o", color=FAINT_COLOUR, zorder=6)
    note(axes, (float(ANGLES[best]), float(overlap[best]) * 1e6 + 0.35), "e*", FAINT_COLOUR)
    penetration_um = float(contacts.penetration[index]) * 1e6
    axes.axhline(penetration_um, color=colour, linewidth=0.8, dashes=(2, 3))
    axes.plot(ANGLES[effective.argmax()], penetration_um, "D", color=colour, zorder=6)
    text = f"penetration {penetration_um:.2f} µm"
    note(axes, (at_deg, penetration_um + 0.25), text, colour, "left")
