"""Landing beside the hole: radial and axial force with and without chamfer, rounding, blocking."""

import numpy as np
import numpy.typing as npt
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from figures_of.paint import FAINT_COLOUR
from figures_of.paper_part import PART, SHAFT
from learning.drawing import drawing, svg
from simulator.blocking import update_entered
from simulator.contact import solve
from simulator.geometry import Hole, Part, Shaft
from simulator.profile import Chamfer, Rounding
from simulator.states import ContactState, contact_states, phase_codes

FloatArray = npt.NDArray[np.float64]
BoolArray = npt.NDArray[np.bool_]

CHAMFER = Chamfer(width_m=30e-6, height_m=60e-6)
WORKED_PART = Part(tuple(Hole(h.diameter_m, h.thickness_m, h.gap_m, CHAMFER) for h in PART.holes))
WORKED_SHAFT = Shaft(SHAFT.diameter_m, SHAFT.length_m, leading=Rounding(40e-6))
CASES = (
    ("Sharp", PART, SHAFT, "#2F4A61"),
    ("Mouth chamfered 30 µm x 60 µm", WORKED_PART, SHAFT, "#B36B00"),
    ("Shaft end rounded 40 µm", PART, WORKED_SHAFT, "#C2498B"),
)
DEPTHS_UM = (-10.0, 120.0)
OFFSETS_UM = (-40.0, 40.0)
GRID = (221, 241)
LARGEST_MN = 200.0
TILT = np.radians(0.1)
OFFSET_M = 15e-6
"""Offset of the path straight down."""
DOWN = (0.0, 0.0, 1.0)
HIGHEST_MN = 130.0


def draw() -> str:
    """Draw maps of the three cases, and the forces on the way down beside the hole."""
    with drawing():
        figure = Figure(figsize=(11.0, 7.6))
        grid = figure.add_gridspec(
            2,
            6,
            left=0.065,
            right=0.91,
            bottom=0.065,
            top=0.955,
            hspace=0.33,
            wspace=0.55,
            height_ratios=(1.0, 0.85),
        )
        first = None
        for column, (name, part, shaft, colour) in enumerate(CASES):
            place = grid[0, 2 * column : 2 * column + 2]
            axes = figure.add_subplot(place, sharey=first)
            first = first or axes
            _draw_map(axes, part, shaft)
            axes.set_title(name, color=colour, fontsize=9.5)
            axes.set_xlabel("depth [µm]")
            axes.tick_params(labelleft=axes is first)
        if first is not None:
            first.set_ylabel("offset x [µm]")
            scale = figure.add_axes((0.925, 0.58, 0.013, 0.33))
            label = "radial force on the part [mN]"
            figure.colorbar(first.images[0], cax=scale, extend="max", label=label)
        radial = figure.add_subplot(grid[1, :3])
        axial = figure.add_subplot(grid[1, 3:])
        _draw_path(radial, axial)
        return svg(figure, "chamfer-map", "Forces while an end comes down beside its hole")


def _draw_map(axes: Axes, part: Part, shaft: Shaft) -> None:
    """Draw the radial force without friction over depth and offset, with contact bordered."""
    along, across = np.linspace(*DEPTHS_UM, GRID[0]), np.linspace(*OFFSETS_UM, GRID[1])
    depth, offset = np.meshgrid(along, across)
    poses = np.zeros((*depth.shape, 5))
    poses[..., 0], poses[..., 2], poses[..., 4] = offset * 1e-6, depth * 1e-6, TILT
    contacts = solve(part, shaft, poses, (0.0, 0.0, 0.0))
    free = contact_states(contacts, phase_codes(part, poses[..., 2])) == ContactState.FREE
    radial_mN = np.hypot(contacts.wrench[..., 0], contacts.wrench[..., 1]) * 1e3
    axes.imshow(
        np.where(free, np.nan, radial_mN),
        origin="lower",
        extent=(*DEPTHS_UM, *OFFSETS_UM),
        aspect="auto",
        cmap="YlGnBu",
        vmin=0.0,
        vmax=LARGEST_MN,
        interpolation="nearest",
    )
    axes.contour(along, across, free, levels=[0.5], colors="#333333", linewidths=0.7)
    axes.axhline(OFFSET_M * 1e6, color=FAINT_COLOUR, linewidth=0.9, dashes=(4, 3))


def path(part: Part, shaft: Shaft, blocking: bool) -> tuple[FloatArray, FloatArray]:
    """Depths (n,) [m], and forces (n, 3) [N] on the way straight down at OFFSET_M."""
    poses = np.zeros((521, 5))
    poses[:, 0], poses[:, 4] = OFFSET_M, TILT
    poses[:, 2] = np.linspace(*DEPTHS_UM, len(poses)) * 1e-6
    if not blocking:
        return poses[:, 2], solve(part, shaft, poses, DOWN).wrench[:, :3]
    state: BoolArray = np.zeros(len(part.holes), dtype=bool)
    states = []
    for pose in poses:
        state = update_entered(part, shaft, pose, state)
        states.append(state)
    return poses[:, 2], solve(part, shaft, poses, DOWN, entered=states).wrench[:, :3]


def _draw_path(radial: Axes, axial: Axes) -> None:
    """Draw radial and axial force on the way down for all cases, with blocking dashed."""
    for name, part, shaft, colour in CASES:
        depth, force = path(part, shaft, blocking=False)
        radial.plot(depth * 1e6, np.hypot(force[:, 0], force[:, 1]) * 1e3, color=colour, label=name)
        axial.plot(depth * 1e6, force[:, 2] * 1e3, color=colour)
        depth, blocked = path(part, shaft, blocking=True)
        if not np.array_equal(force, blocked):
            radial.plot(
                depth * 1e6,
                np.hypot(blocked[:, 0], blocked[:, 1]) * 1e3,
                color=colour,
                dashes=(4, 2),
            )
            axial.plot(depth * 1e6, blocked[:, 2] * 1e3, color=colour, dashes=(4, 2))
    radial.plot([], [], color=FAINT_COLOUR, dashes=(4, 2), label="the same with blocking")
    for axes, what in ((radial, "radial"), (axial, "axial")):
        axes.axhline(0.0, color="#BBBBBB", linewidth=0.7, zorder=0)
        axes.set_title(f"Straight down at {OFFSET_M * 1e6:g} µm: {what} force")
        axes.set_xlabel("depth [µm]")
        axes.set_ylabel(f"{what} force [mN]", labelpad=2.0)
        axes.set_xlim(*DEPTHS_UM)
        axes.set_ylim(-3.0, HIGHEST_MN)
    radial.legend(loc="upper left")
