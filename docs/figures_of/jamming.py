"""The jamming diagram of a peg in one hole: contacts of the simulator over the closed form.

D. E. Whitney, "Quasi-static assembly of compliantly supported rigid parts", Journal of Dynamic
Systems, Measurement, and Control 104 (1982). A peg of radius r, its tip a depth l inside the hole,
slides in with one or two points of contact. What drives it has then a force (F_x, F_z) and a moment
M about the tip on the border of a parallelogram in the plane of mu F_x/F_z and M/(r F_z):

    |mu F_x/F_z| = 1            one point or a line of contact at one side,
    |M/(r F_z) + (1 + lambda) mu F_x/F_z| = lambda,  lambda = l/(2 r mu)    two points.

Inside it the peg slides, outside it jams. The peg does not accelerate, so what drives it is what it
exerts on the part, and the signs are those of the wrench on the part in M: F_z > 0 inserts, M turns
about +y.
"""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from matplotlib.figure import Figure

from learning.drawing import AXIS_COLOURS, RADIAL_COLOUR, drawing, svg
from simulator.contact import ContactLaw, solve
from simulator.geometry import Hole, Part, Shaft, shaft_axis
from simulator.wrench import move_torque

Array = npt.NDArray[np.float64]

PEG = Shaft(1e-3, 4e-3)
CLEARANCE_M = 1e-7
"""Small, because the closed form leaves out the tilt: it is up to 3 clearances over depth."""


@dataclass(frozen=True)
class Combinations:
    """What drives the peg, for n poses that touch: arrays (n,)."""

    lateral: Array
    """mu F_x/F_z"""
    moment: Array
    """M/(r F_z)"""
    points: npt.NDArray[np.int64]
    """Points of contact."""
    sides: npt.NDArray[np.int64]
    """Sides of the hole that touch."""


def slope_and_reach(depth_m: float, friction: float) -> tuple[float, float]:
    """1 + lambda and lambda of the closed form."""
    reach = depth_m / (PEG.diameter_m * friction)
    return 1.0 + reach, reach


def combinations(depth_m: float, friction: float, poses: int, seed: int) -> Combinations:
    """Forces and moments of the simulator for random poses in the plane y = 0, sliding in."""
    generator = np.random.default_rng(seed)
    part = Part((Hole(PEG.diameter_m + CLEARANCE_M, 2.0 * depth_m),))
    pose = np.zeros((poses, 5))
    pose[:, 0] = 2.0 * CLEARANCE_M * generator.uniform(-1.0, 1.0, poses)
    pose[:, 2] = depth_m
    pose[:, 4] = 3.0 * CLEARANCE_M / depth_m * generator.uniform(-1.0, 1.0, poses)
    contacts = solve(part, PEG, pose, shaft_axis(pose), ContactLaw(friction=friction))
    touching = contacts.penetration > 0.0
    right = touching & (contacts.normal[..., 0] > 0.0)
    sides = right.any(axis=-1).astype(np.int64) + (touching & ~right).any(axis=-1)
    at_tip, some = move_torque(contacts.wrench, pose[:, :3]), sides > 0
    force_x, force_z, moment = at_tip[some][:, [0, 2, 4]].T
    return Combinations(
        friction * force_x / force_z,
        moment / (PEG.radius_m * force_z),
        touching[some].sum(axis=-1),
        sides[some],
    )


def draw(depth_m: float = 6e-4, friction: float = 0.2) -> str:
    """Draw the recovered combinations over the parallelogram, as an SVG element."""
    found = combinations(depth_m, friction, 500, seed=1)
    _, reach = slope_and_reach(depth_m, friction)
    top = 2.0 * reach + 1.0
    corners = np.array([[1.0, -1.0], [1.0, -top], [-1.0, 1.0], [-1.0, top], [1.0, -1.0]])
    groups = (
        ("one point", "o", found.points == 1),
        ("two points at one side", "^", (found.points > 1) & (found.sides == 1)),
        ("two points at both sides", "x", found.sides == 2),
    )
    with drawing():
        figure = Figure(figsize=(6.0, 4.2), layout="constrained")
        axes = figure.add_subplot()
        axes.plot(*corners.T, color=RADIAL_COLOUR, label="closed form")
        for (name, marker, chosen), colour in zip(groups, AXIS_COLOURS, strict=True):
            rows = found.lateral[chosen], found.moment[chosen]
            axes.plot(*rows, marker, color=colour, fillstyle="none", label=f"simulator: {name}")
        axes.text(0.0, 0.0, "slides", ha="center", va="center")
        axes.text(0.6, 0.5 * top, "jams", ha="center")
        axes.set_xlabel("µ F_x / F_z")
        axes.set_ylabel("M / (r F_z)")
        axes.legend(loc="lower left")
        return svg(figure, "jamming", "Forces and moments that drive a peg into a hole")
