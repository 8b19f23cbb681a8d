"""What an insertion environment is made of; the defaults are the simulation of the paper."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from simulator.checks import FloatArray, non_negative, positive
from simulator.contact import ContactLaw
from simulator.geometry import Hole, Part, Shaft

Vector3 = tuple[float, float, float]
Float32Array = npt.NDArray[np.float32]

OBSERVATION = ("force_x", "force_y", "force_z", "depth")
"""Components of an observation: forces by their limits, depth by the stroke."""
ACTION = ("step_x", "step_y", "step_z")
"""Components of an action: the translation of the shaft by the step box, frame M."""
OBSERVATION_BOUND = 2.0
"""An observed component saturates at this magnitude: twice a force limit, twice the stroke."""

PAPER_PART = Part((Hole(1.01e-3, 5e-4), Hole(1.01e-3, 5e-4, gap_m=1.5e-3)))
"""Two walls of 0.5 mm with holes of 1.01 mm, 1.5 mm apart (paper section 5.1)."""
PAPER_SHAFT = Shaft(1e-3, 4e-3)
PAPER_LAW = ContactLaw(stiffness_N_m=4e3, friction=0.2)


@dataclass(frozen=True, slots=True)
class RewardWeights:
    """Weights of eqs. (12) and (13), by the paper's Table 1."""

    alpha_x: float = 0.7
    """alpha_1, of the force along x."""
    alpha_y: float = 0.3
    """alpha_2, of the force along y."""
    omega: float = 2.0
    """A step too short costs this many times less than one as much too long."""

    def __post_init__(self) -> None:
        non_negative("RewardWeights.alpha_x", self.alpha_x)
        non_negative("RewardWeights.alpha_y", self.alpha_y)
        total = self.alpha_x + self.alpha_y
        if abs(total - 1.0) > 1e-9:
            raise ValueError(f"RewardWeights.alpha_x and alpha_y add up to {total}; it must be 1")
        if positive("RewardWeights.omega", self.omega) <= 1.0:
            raise ValueError(f"RewardWeights.omega is {self.omega!r}; it must be above 1")


@dataclass(frozen=True, slots=True)
class DualPegConfig:
    """Settings of `DualPegEnv` and `DualPegVectorEnv`; vectors are x, y, z in frame M.

    Raises `ValueError`, naming the setting, for what is not finite or out of range.
    """

    part: Part = PAPER_PART
    shaft: Shaft = PAPER_SHAFT
    law: ContactLaw = PAPER_LAW
    step_box_m: Vector3 = (20e-6, 20e-6, 60e-6)
    """Longest step along each axis, to either side."""
    force_limit_N: Vector3 = (0.07, 0.1, 1.0)
    """A larger force along an axis ends the episode as a failure."""
    stroke_m: float = 2.3e-3
    """Depth at which the part is inserted."""
    start_depth_m: float = -20e-6
    """Depth at which an episode starts; a tilted shaft is still clear of the part there."""
    position_error_m: float = 10e-6
    tilt_error_rad: float = np.pi / 600.0
    """0.3 degrees."""
    steps_max: int = 1000
    reward: RewardWeights = RewardWeights()
    force_noise_N: Vector3 = (0.0, 0.0, 0.0)
    """Standard deviation of the noise on observed forces."""
    depth_noise_m: float = 0.0
    """Standard deviation of the noise on the observed depth."""

    def __post_init__(self) -> None:
        for axis, name in enumerate("xyz"):
            positive(f"DualPegConfig.step_box_m ({name})", self.step_box_m[axis])
            positive(f"DualPegConfig.force_limit_N ({name})", self.force_limit_N[axis])
            non_negative(f"DualPegConfig.force_noise_N ({name})", self.force_noise_N[axis])
        positive("DualPegConfig.stroke_m", self.stroke_m)
        non_negative("DualPegConfig.position_error_m", self.position_error_m)
        non_negative("DualPegConfig.depth_noise_m", self.depth_noise_m)
        if not -self.stroke_m <= self.start_depth_m < self.stroke_m:
            raise ValueError(
                f"DualPegConfig.start_depth_m is {self.start_depth_m!r}; it must be at least "
                f"-stroke_m and below stroke_m, {self.stroke_m!r}"
            )
        if non_negative("DualPegConfig.tilt_error_rad", self.tilt_error_rad) >= 0.5 * np.pi:
            raise ValueError(
                f"DualPegConfig.tilt_error_rad is {self.tilt_error_rad!r}; it must be below pi/2"
            )
        if self.steps_max < 1:
            raise ValueError(f"DualPegConfig.steps_max is {self.steps_max}; it must be at least 1")

    def action(self, step_m: npt.ArrayLike) -> Float32Array:
        """Action (..., 3) that asks for a translation (..., 3) [m], cut to the step box."""
        parts = np.asarray(step_m, dtype=np.float64) / np.array(self.step_box_m)
        cut: Float32Array = np.clip(parts, -1.0, 1.0).astype(np.float32)
        return cut

    def force_N(self, observation: npt.ArrayLike) -> FloatArray:
        """Observed force (..., 3) [N] in an observation (..., 4)."""
        force: FloatArray = np.asarray(observation)[..., :3] * np.array(self.force_limit_N)
        return force

    def depth_m(self, observation: npt.ArrayLike) -> FloatArray:
        """Observed depth (...) [m] in an observation (..., 4)."""
        depth: FloatArray = np.asarray(observation, dtype=np.float64)[..., 3] * self.stroke_m
        return depth


PAPER = DualPegConfig()
"""The simulation of the paper (section 5.1)."""


class Rules(NamedTuple):
    """A configuration as the compiled kernels take it."""

    step_box_m: Vector3
    force_limit_N: Vector3
    stroke_m: float
    start_depth_m: float
    position_error_m: float
    tilt_error_rad: float
    steps_max: int
    alpha_x: float
    alpha_y: float
    omega: float
    noise: tuple[float, float, float, float]
    """Standard deviation of the noise on each component of the observation."""
    is_noisy: bool
    observation_bound: float

    @classmethod
    def of(cls, config: DualPegConfig) -> "Rules":
        """The rules of `config`."""
        x, y, z = (
            noise / limit
            for noise, limit in zip(config.force_noise_N, config.force_limit_N, strict=True)
        )
        noise = (x, y, z, config.depth_noise_m / config.stroke_m)
        return cls(
            step_box_m=config.step_box_m,
            force_limit_N=config.force_limit_N,
            stroke_m=config.stroke_m,
            start_depth_m=config.start_depth_m,
            position_error_m=config.position_error_m,
            tilt_error_rad=config.tilt_error_rad,
            steps_max=config.steps_max,
            alpha_x=config.reward.alpha_x,
            alpha_y=config.reward.alpha_y,
            omega=config.reward.omega,
            noise=noise,
            is_noisy=any(noise),
            observation_bound=OBSERVATION_BOUND,
        )
