"""The picture of the learning environment, with three contacts in two holes."""

import numpy as np
import numpy.typing as npt

from learning.environments import DualPegEnv

POSE = (6.5e-6, -2e-6, 2.05e-3, 3e-3, 4.5e-3)
ACTION = (0.05, 0.05, 0.8)


def draw() -> npt.NDArray[np.uint8]:
    """Return the image (height, width, 3)."""
    env = DualPegEnv(render_mode="rgb_array")
    env.reset(seed=1, options={"pose": POSE})
    env.step(np.array(ACTION, dtype=np.float32))
    return np.asarray(env.render())
