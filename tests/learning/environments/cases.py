"""Environments and poses that several tests use. Forces follow by hand from the contact law."""

import numpy as np
import numpy.typing as npt

from learning.environments import DualPegEnv

UM = 1e-6


def upright(x_um: float, y_um: float = 0.0, depth_um: float = 250.0) -> npt.NDArray[np.float64]:
    """A pose without tilt.

    Clearance is 5 um to a side. Inside the upper hole the shaft touches at the rim and at its own
    end: two springs of 4 mN/um, so 1 um of overlap is 8 mN, and 1.6 mN of friction while it slides.
    """
    return np.array([x_um * UM, y_um * UM, depth_um * UM, 0.0, 0.0])


def at(env: DualPegEnv, pose: npt.NDArray[np.float64]) -> DualPegEnv:
    """The environment, started at a pose."""
    env.reset(seed=1, options={"pose": pose})
    return env


def action(x: float = 0.0, y: float = 0.0, z: float = 0.0) -> npt.NDArray[np.float32]:
    return np.array([x, y, z], dtype=np.float32)
