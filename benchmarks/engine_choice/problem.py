"""The problem that every library solves: the lateral contact of a shaft with the rims of a part.

Poses are columns (5, n) of x, y, z [m], rx, ry [rad]; the answer is the normal force (3, n) [N]
that the shaft exerts on the part through its four rims, each counted with its radial overlap. A
kernel has the sine and cosine, roots, divisions and selections of a contact solve, no branches.

The search is that of `simulator.extremum`, but the start of Newton's method has the power 5/16,
which is four square roots, in place of the cube root. It lies left of the root, too, and five steps
are as exact. So all libraries compute the same: not each has a cube root on every device.
"""

from typing import Any, Protocol, TypeAlias

import numpy as np

from simulator.checks import FloatArray

SHAFT_RADIUS_M = 5e-4
RIM_RADIUS_M = 5.05e-4
RIM_DEPTHS_M = (0.0, 5e-4, 2e-3, 2.5e-3)
STIFFNESS_N_m = 4e3
NEWTON_STEPS = 5
TINY = 1e-300
FLOOR = 1e-20
UPRIGHT = 1e-150

Held: TypeAlias = Any
"""An array as a library holds it."""


class Kernel(Protocol):
    """One library's solution; poses and forces stay where the library computes."""

    def place(self, poses: FloatArray) -> Held:
        """Return poses (5, n) as the library holds them."""

    def solve(self, placed: Held) -> Held:
        """Return the forces as the library holds them, complete."""

    def fetch(self, forces: Held) -> FloatArray:
        """Return forces (3, n) as a numpy array."""


def insertion_poses(n: int) -> FloatArray:
    """Poses (5, n) of an insertion: 10 um and 0.3 degrees of error, at any depth."""
    spread = np.array([1e-5, 1e-5, 1.5e-3, 5e-3, 5e-3])
    centre = np.array([0.0, 0.0, 1.5e-3, 0.0, 0.0])
    poses = centre + spread * np.random.default_rng(1).uniform(-1.0, 1.0, (n, 5))
    return np.ascontiguousarray(poses.T)
