"""The paper's insertion task as a gymnasium environment."""

from typing import Any

import gymnasium
import numpy as np
import numpy.typing as npt
from gymnasium.error import ResetNeeded

from learning.environments.config import ACTION, PAPER, DualPegConfig, Float32Array
from learning.environments.core import Batch, DualPegCore
from learning.environments.info import draw_key, info_of
from learning.environments.kernels import Outcome
from learning.environments.rendering import FRAMES_PER_SECOND, picture
from learning.environments.spaces import action_space, observation_space
from simulator.checks import finite_array

Frame = npt.NDArray[np.uint8]


class DualPegEnv(gymnasium.Env[Float32Array, Float32Array]):
    """Insert a shaft into the two holes of a part by contact forces (paper sections 4 and 5.1).

    Observation: see `OBSERVATION`; forces on the part by their limits, depth by the stroke, with
    noise where the configuration says so, saturated at `OBSERVATION_BOUND`. Action: see `ACTION`;
    the translation by the step box, cut to [-1, 1]; the shaft does not pass the stroke.

    Reward (eqs. 11 to 13): R = R_p - R_n, with R_p from the forces after the step. The equations
    are printed without magnitudes, though a force of either sign loads the part: magnitudes are
    taken. R_n weighs the axial step asked for, by its longest, against R_p of the step before,
    which is that of the forces the action was chosen on; the paper speaks of an axial force there
    but its equation has none. Forces are the true ones: noise (eq. 16) is on the observation only.

    An episode is terminated by success (stroke reached) or by a force over its limit, which counts
    first, and truncated after `steps_max` steps; `info` says which (`Outcome`), and the rest of
    what `learning.environments.info` lists.

    `stream` selects one of the random streams of a seed: the environment with stream i goes the
    way of environment i of `DualPegVectorEnv` under the same seed.
    """

    metadata = {"render_modes": ["rgb_array"], "render_fps": FRAMES_PER_SECOND}  # noqa: RUF012, gymnasium's type

    def __init__(
        self,
        config: DualPegConfig = PAPER,
        render_mode: str | None = None,
        stream: int = 0,
    ) -> None:
        if render_mode not in (None, "rgb_array"):
            raise ValueError(f"render_mode is {render_mode!r}; it must be None or 'rgb_array'")
        self.config = config
        self.render_mode = render_mode
        self.observation_space = observation_space()
        self.action_space = action_space()
        self._core = DualPegCore(config, 1, stream)

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Float32Array, dict[str, Any]]:
        """Start an episode; `options["pose"]` (5,) is a start pose instead of a random one.

        Raises `ValueError` for a pose that is not finite or has another shape.
        """
        super().reset(seed=seed)
        fresh = seed is not None or self._core.batch is None
        key = draw_key(self.np_random) if fresh else None
        pose = (options or {}).get("pose")
        batch = self._core.reset(key, None if pose is None else np.asarray(pose)[np.newaxis])
        return batch.observation[0], _row(batch)

    def step(self, action: Float32Array) -> tuple[Float32Array, float, bool, bool, dict[str, Any]]:
        """Move the shaft by `action` (3,).

        Raises `ValueError` for an action that is not finite or has another shape, and
        `gymnasium.error.ResetNeeded` without an episode under way.
        """
        batch = self._core.batch
        if batch is None or batch.outcome[0].item() != Outcome.RUNNING:
            raise ResetNeeded("no episode is under way: call reset first")
        wanted = finite_array("action", action, len(ACTION)).clip(-1.0, 1.0).astype(np.float32)
        if wanted.shape != (len(ACTION),):
            raise ValueError(f"action has shape {wanted.shape}; it must be ({len(ACTION)},)")
        batch = self._core.step(wanted[np.newaxis])
        return (
            batch.observation[0],
            batch.reward[0].item(),
            batch.terminated[0].item(),
            batch.truncated[0].item(),
            _row(batch),
        )

    def render(self) -> Frame | None:
        """Side view of shaft and part as an image (height, width, 3); None without a render mode.

        Raises `gymnasium.error.ResetNeeded` before the first reset.
        """
        if self.render_mode is None:
            return None
        if self._core.batch is None:
            raise ResetNeeded("there is nothing to draw: call reset first")
        return picture(self.config, self._core.batch, 0)


def _row(batch: Batch) -> dict[str, Any]:
    """Info of a batch of one: arrays without their first axis, scalars as Python's own."""
    return {
        name: array[0] if array.ndim > 1 else array[0].item()
        for name, array in info_of(batch).items()
    }
