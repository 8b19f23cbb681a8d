"""One pose for each contact state, found among random ones, in side view."""

import numpy as np
import numpy.typing as npt
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from figures_of.paint import EDGE_COLOUR, OVERLAP_COLOUR, RIM_COLOUR, bare, note
from figures_of.paper_part import PART, SHAFT
from figures_of.section import Section
from hil.figures import STATE_COLOURS
from learning.drawing import drawing, svg
from simulator.contact import solve
from simulator.states import ContactState, contact_state, contact_states, phase_codes

FloatArray = npt.NDArray[np.float64]

SEED = 1
TRIALS = 40_000
LARGEST_TILT_DEG = 0.35
LARGEST_OFFSET_M = 12e-6
DEPTHS_MM = ((0.2, 0.42), (0.9, 1.6), (2.12, 2.42))
"""Where to look: in the upper hole, between the holes, in the lower hole."""
CLEAR_M = 2e-6
GAIN = 25.0
MM_PER_N = 12.0
TOP_MM, BOTTOM_MM = -0.75, 2.75
NO_SLIDING = (0.0, 0.0, 0.0)
TITLES = {
    ContactState.FREE: "no contact",
    ContactState.A: "upper rim alone",
    ContactState.B: "leading edge alone",
    ContactState.C: "both",
    ContactState.D: "one station of it",
    ContactState.E: "both stations of it",
    ContactState.F: "one point",
    ContactState.G: "two, same hole",
    ContactState.H: "two, different holes",
    ContactState.I: "three or more",
}


def found_poses() -> dict[ContactState, FloatArray]:
    """For each state the clearest one, shape (5,), of random poses in the plane y = 0.

    A pose is clear if it is tilted, its smallest penetration can be seen, and its largest is not
    much larger.
    """
    generator = np.random.default_rng(SEED)
    shape = (len(DEPTHS_MM), TRIALS)
    grid = np.zeros((*shape, 5))
    grid[..., 0] = generator.uniform(-LARGEST_OFFSET_M, LARGEST_OFFSET_M, shape)
    low, high = 1e-3 * np.array(DEPTHS_MM)[..., np.newaxis].swapaxes(0, 1)
    grid[..., 2] = generator.uniform(low, high, shape)
    grid[..., 4] = np.radians(generator.uniform(-LARGEST_TILT_DEG, LARGEST_TILT_DEG, shape))
    poses = grid.reshape(-1, 5)
    contacts = solve(PART, SHAFT, poses, NO_SLIDING)
    states = contact_states(contacts, phase_codes(PART, poses[:, 2]))
    penetration = contacts.penetration
    smallest = np.where(penetration > 0.0, penetration, np.inf).min(axis=-1)
    clear = np.minimum(smallest, CLEAR_M) - 0.4 * penetration.max(axis=-1)
    clear += CLEAR_M * np.abs(poses[:, 4]) / np.radians(LARGEST_TILT_DEG)
    return {
        state: poses[states == state][clear[states == state].argmax()] for state in ContactState
    }


def draw() -> str:
    """Draw FREE and the states a to i."""
    poses = found_poses()
    with drawing():
        figure = Figure(figsize=(11.0, 8.6))
        panels = figure.subplots(
            2,
            5,
            gridspec_kw={
                "left": 0.005,
                "right": 0.995,
                "bottom": 0.055,
                "top": 0.895,
                "wspace": 0.06,
                "hspace": 0.27,
            },
        ).ravel()
        for axes, (state, pose) in zip(panels, poses.items(), strict=True):
            _draw_state(axes, state, pose)
        figure.legend(
            handles=[
                Line2D([], [], color=RIM_COLOUR, marker="o", label="shaft-based contact"),
                Line2D([], [], color=EDGE_COLOUR, marker="s", label="hole-based contact"),
                Patch(color=OVERLAP_COLOUR, label="overlap of the undeformed solids"),
            ],
            loc="upper left",
            ncols=3,
            borderaxespad=0.3,
        )
        return svg(figure, "contact-states", "Side views of the contact states FREE and a to i")


def _draw_state(axes: Axes, state: ContactState, pose: FloatArray) -> None:
    """Draw one pose with its contacts, its state as title and its numbers below."""
    contacts = solve(PART, SHAFT, pose, NO_SLIDING)
    if contact_state(contacts, int(phase_codes(PART, pose[2]))) is not state:
        raise ValueError(f"the pose found for {state.name} has another state")
    section = Section(PART, SHAFT, pose, GAIN, TOP_MM)
    section.draw_solids(axes)
    section.draw_contacts(axes, contacts, MM_PER_N)
    bare(axes)
    axes.set_xlim(-1.15, 1.15)
    axes.set_ylim(BOTTOM_MM, TOP_MM)
    name = "free" if state is ContactState.FREE else state.name.lower()
    axes.text(
        0.04,
        1.045,
        name,
        transform=axes.transAxes,
        fontsize=11.0,
        fontweight="bold",
        va="center",
        bbox={"facecolor": STATE_COLOURS[name], "edgecolor": "#777777", "pad": 3.0},
    )
    axes.text(
        0.97, 1.045, TITLES[state], transform=axes.transAxes, ha="right", va="center", fontsize=10.0
    )
    largest_um = float(contacts.penetration.max()) * 1e6
    deepest = f", deepest {largest_um:.1f} µm" if largest_um > 0.0 else ""
    note(
        axes,
        (0.0, BOTTOM_MM + 0.2),
        f"x {pose[0] * 1e6:.1f} µm, depth {pose[2] * 1e3:.2f} mm\n"
        f"tilt {np.degrees(pose[4]):.2f}°{deepest}",
        size=9.5,
    )
