"""The paper's insertion task as a vector environment: many at once."""

from typing import Any

import numpy as np
import numpy.typing as npt
from gymnasium.error import ResetNeeded
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space

from learning.environments.config import PAPER, DualPegConfig, Float32Array
from learning.environments.core import Batch, DualPegCore
from learning.environments.info import draw_key, info_of
from learning.environments.rendering import FRAMES_PER_SECOND, picture
from learning.environments.spaces import action_space, observation_space
from simulator.checks import FloatArray

BoolArray = npt.NDArray[np.bool_]
Frame = npt.NDArray[np.uint8]


class DualPegVectorEnv(VectorEnv[Float32Array, Float32Array, npt.NDArray[Any]]):
    """`num_envs` environments of `DualPegEnv`, on all cores.

    Environment i under a seed goes the same way whatever `num_envs` is. Where an episode is over,
    the next step starts a new one and takes no action (gymnasium's next-step autoreset); its reward
    is 0. An action that is not finite ends that episode alone: terminated, `Outcome.NOT_FINITE`,
    reward and observation NaN.

    `info` has the names of `DualPegEnv` with arrays (num_envs, ...), which are handed out, not
    copied: they are read-only and never written again.
    """

    metadata = {  # noqa: RUF012, gymnasium's type
        "render_modes": ["rgb_array"],
        "render_fps": FRAMES_PER_SECOND,
        "autoreset_mode": AutoresetMode.NEXT_STEP,
    }

    def __init__(
        self,
        num_envs: int = 1,
        config: DualPegConfig = PAPER,
        render_mode: str | None = None,
    ) -> None:
        if render_mode not in (None, "rgb_array"):
            raise ValueError(f"render_mode is {render_mode!r}; it must be None or 'rgb_array'")
        self._core = DualPegCore(config, num_envs)
        self.config = config
        self.num_envs = num_envs
        self.render_mode = render_mode
        self.single_observation_space = observation_space()
        self.single_action_space = action_space()
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self.action_space = batch_space(self.single_action_space, num_envs)
        everywhere = np.ones(num_envs, dtype=np.bool_)
        everywhere.setflags(write=False)
        self._masks = {f"_{name}": everywhere for name in info_of(Batch.empty(1))}

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Float32Array, dict[str, Any]]:
        """Start an episode everywhere; `options["pose"]` (num_envs, 5) are given start poses.

        Raises `ValueError` for poses that are not finite or have another shape.
        """
        super().reset(seed=seed)
        fresh = seed is not None or self._core.batch is None
        key = draw_key(self.np_random) if fresh else None
        batch = self._core.reset(key, (options or {}).get("pose"))
        return batch.observation, self._info(batch)

    def step(
        self, actions: Float32Array
    ) -> tuple[Float32Array, FloatArray, BoolArray, BoolArray, dict[str, Any]]:
        """Move the shafts by `actions` (num_envs, 3).

        Raises `ValueError` for actions of another shape and `gymnasium.error.ResetNeeded` before
        the first reset.
        """
        if self._core.batch is None:
            raise ResetNeeded("no episode is under way: call reset first")
        wanted = np.ascontiguousarray(actions, dtype=np.float32)
        if wanted.shape != self.action_space.shape:
            raise ValueError(
                f"actions have shape {wanted.shape}; it must be {self.action_space.shape}"
            )
        batch = self._core.step(wanted)
        return (
            batch.observation,
            batch.reward,
            batch.terminated,
            batch.truncated,
            self._info(batch),
        )

    def render(self) -> tuple[Frame, ...] | None:
        """One image (height, width, 3) for each environment; None without a render mode.

        Raises `gymnasium.error.ResetNeeded` before the first reset.
        """
        if self.render_mode is None:
            return None
        batch = self._core.batch
        if batch is None:
            raise ResetNeeded("there is nothing to draw: call reset first")
        return tuple(picture(self.config, batch, row) for row in range(self.num_envs))

    def _info(self, batch: Batch) -> dict[str, Any]:
        """Info as gymnasium has it for vectors: each array with a mask of where it is valid."""
        return {**info_of(batch), **self._masks}
