"""Radial force over depth and offset, with the contact states bordered."""

import numpy as np
import numpy.typing as npt
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.image import AxesImage
from scipy import ndimage

from figures_of.paint import WALL_LINE
from figures_of.paper_part import PART, SHAFT
from learning.drawing import drawing, svg
from simulator.contact import solve
from simulator.geometry import Part, Shaft
from simulator.states import ContactState, contact_states, phase_codes

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.int64]

DEPTHS_MM = (-0.05, 2.5)
OFFSETS_UM = (-20.0, 20.0)
TILTS_DEG = (0.0, 0.1, 0.3)
LARGEST_MN = 200.0
GRID = (560, 360)
"""Points along depth and offset."""
SMALLEST_REGION = 500
"""A region of so few points of the grid carries no letter."""


def radial_forces(part: Part, shaft: Shaft, tilt_rad: float) -> tuple[FloatArray, IntArray]:
    """Radial force [N] and contact state, both (offset, depth), without friction, at y = 0."""
    depth, offset = np.meshgrid(
        np.linspace(*DEPTHS_MM, GRID[0]) * 1e-3, np.linspace(*OFFSETS_UM, GRID[1]) * 1e-6
    )
    poses = np.zeros((*depth.shape, 5))
    poses[..., 0], poses[..., 2], poses[..., 4] = offset, depth, tilt_rad
    contacts = solve(part, shaft, poses, (0.0, 0.0, 0.0))
    states = contact_states(contacts, phase_codes(part, depth))
    return np.hypot(contacts.wrench[..., 0], contacts.wrench[..., 1]), states


def draw() -> str:
    """Draw the map for the tilts of TILTS_DEG."""
    with drawing():
        figure = Figure(figsize=(11.0, 9.6))
        panels = figure.subplots(
            len(TILTS_DEG),
            1,
            sharex=True,
            gridspec_kw={
                "left": 0.065,
                "right": 0.90,
                "bottom": 0.055,
                "top": 0.965,
                "hspace": 0.16,
            },
        )
        for axes, tilt_deg in zip(panels, TILTS_DEG, strict=True):
            force, states = radial_forces(PART, SHAFT, np.radians(tilt_deg))
            image = draw_map(axes, force, states)
            axes.set_title(f"Tilt {tilt_deg:g}°", pad=4.0)
            axes.set_ylabel("offset x [µm]")
        for name, depth_mm in (("upper wall", 0.25), ("gap", 1.25), ("lower wall", 2.25)):
            panels[0].text(depth_mm, 20.8, name, ha="center", va="bottom", color=WALL_LINE)
        panels[-1].set_xlabel("depth of the leading end [mm]")
        scale = figure.add_axes((0.92, 0.3, 0.015, 0.4))
        figure.colorbar(image, cax=scale, extend="max", label="radial force on the part [mN]")
        return svg(figure, "force-map", "Radial force and contact state over depth and offset")


def draw_map(axes: Axes, force: FloatArray, states: IntArray) -> AxesImage:
    """Draw force as colour, the borders of states as lines, and their letters."""
    extent = (*DEPTHS_MM, *OFFSETS_UM)
    image = axes.imshow(
        np.where(states == ContactState.FREE, np.nan, force * 1e3),
        origin="lower",
        extent=extent,
        aspect="auto",
        cmap="YlGnBu",
        vmin=0.0,
        vmax=LARGEST_MN,
        interpolation="nearest",
    )
    across, along = np.linspace(*OFFSETS_UM, GRID[1]), np.linspace(*DEPTHS_MM, GRID[0])
    for state in ContactState:
        inside = states == state
        if inside.any() and not inside.all():
            lines = axes.contour(
                along, across, inside, levels=[0.5], colors="#333333", linewidths=0.7
            )
            lines.set_rasterized(True)
        regions, count = ndimage.label(inside)
        for number in range(1, count + 1):
            region = regions == number
            if region.sum() >= SMALLEST_REGION:
                _write_letter(axes, region, state)
    for depth in PART.rim_depths_m * 1e3:
        axes.axvline(depth, color=WALL_LINE, linewidth=0.8, dashes=(4, 3))
    return image


def _write_letter(axes: Axes, region: npt.NDArray[np.bool_], state: ContactState) -> None:
    """Write the state's letter where its region is widest."""
    padded = np.pad(region, 1)
    room = ndimage.distance_transform_edt(padded)[1:-1, 1:-1]
    row, column = np.unravel_index(int(room.argmax()), room.shape)
    depth = np.linspace(*DEPTHS_MM, GRID[0])[column]
    offset = np.linspace(*OFFSETS_UM, GRID[1])[row]
    name = "free" if state is ContactState.FREE else state.name.lower()
    axes.text(
        depth,
        offset,
        name,
        ha="center",
        va="center",
        fontweight="bold",
        bbox={"facecolor": "white", "edgecolor": "none", "alpha": 0.75, "pad": 1.2},
    )
