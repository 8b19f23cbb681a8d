"""Shafts and parts of all kinds, and poses that press them against each other."""

import numpy as np

from simulator.checks import FloatArray
from simulator.geometry import Hole, Part, Shaft
from simulator.profile import Chamfer, Rounding

CHAMFER = Chamfer(3e-5, 5e-5)
SHAFTS = {
    "plain": Shaft(1e-3, 4e-3),
    "chamfered": Shaft(1e-3, 4e-3, CHAMFER, Chamfer(4e-5, 3e-5)),
    "rounded": Shaft(1e-3, 4e-3, Rounding(8e-5)),
    "hardly rounded": Shaft(1e-3, 4e-3, Rounding(3e-6)),
    "barrel": Shaft.of_profile(
        ((0.0, 4.8e-4), (1e-4, 4.95e-4), (6e-4, 5e-4), (3e-3, 5e-4), (4e-3, 4.8e-4))
    ),
    "interference": Shaft(1.014e-3, 4e-3, Rounding(5e-5)),
}
PARTS = {
    "one hole": Part((Hole(1.01e-3, 5e-4),)),
    "two chamfered": Part(
        (
            Hole(1.01e-3, 5e-4, entry=Chamfer(4e-5, 6e-5)),
            Hole(1.006e-3, 3e-4, 1.5e-3, Chamfer(2e-5, 2e-5)),
        )
    ),
    "three": Part(
        (
            Hole(1.01e-3, 5e-4),
            Hole(1.008e-3, 2e-4, 5e-4, Chamfer(3e-5, 4e-5)),
            Hole(1.012e-3, 3e-4, 8e-4),
        )
    ),
}


def pressing_poses(part: Part, n: int, seed: int, tilt: float, away: float = 3e-5) -> FloatArray:
    """Random poses around and inside the part, many of them with an end about a mouth."""
    rng = np.random.default_rng(seed)
    poses = rng.uniform(-1.0, 1.0, (n, 5)) * [away, away, 1.0, tilt, tilt]
    poses[:, 2] = rng.uniform(-5e-5, part.wall_exits_m[-1] + 2e-4, n)
    at_mouth = rng.random(n) < 0.6
    planes = rng.choice(part.wall_entries_m, n) + rng.uniform(-2e-5, 1.6e-4, n)
    poses[:, 2] = np.where(at_mouth, planes, poses[:, 2])
    return poses
