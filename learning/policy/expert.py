"""The expert that a policy corrects (eq. 6)."""

from typing import NamedTuple, overload

import numpy as np

from drivers.contract.messages import Vector3
from simulator.checks import FloatArray, non_negative, positive


class Approach(NamedTuple):
    """Short axial steps where the shaft meets the first rim.

    From above the expert goes to the rim at depth 0, in one step if it can, and on in steps of
    `step_m` until `depth_m` is reached.
    """

    step_m: float
    depth_m: float


class Expert(NamedTuple):
    """Moves sideways against the radial force and forward; its box is for the sum with a residual.

    With gain and axial step 0 there is none: the policy's answer is the whole step.
    """

    gain_m_N: float
    """Lateral step per radial force, against it."""
    axial_step_m: float
    step_box_m: Vector3
    """Longest step along each axis, to either side."""
    approach: Approach | None = None
    """None: `axial_step_m` at every depth."""

    @overload
    def step(self, force_xy_N: tuple[float, float], depth_m: float) -> Vector3: ...

    @overload
    def step(self, force_xy_N: FloatArray, depth_m: FloatArray) -> FloatArray: ...

    def step(
        self, force_xy_N: tuple[float, float] | FloatArray, depth_m: float | FloatArray
    ) -> Vector3 | FloatArray:
        """Return the translation (..., 3) [m] for observed forces (..., 2) and depths (...).

        Tuple and number are answered with a tuple. It is not cut to the step box. What is NaN and
        looked at makes its part of the step NaN.
        """
        if isinstance(force_xy_N, np.ndarray):
            step_m = np.empty((*force_xy_N.shape[:-1], 3))
            step_m[..., :2] = -self.gain_m_N * force_xy_N
            step_m[..., 2] = self._axial_steps(np.asarray(depth_m))
            return step_m
        x, y = force_xy_N
        return (-self.gain_m_N * x, -self.gain_m_N * y, self._axial_step(float(depth_m)))

    def _axial_step(self, depth_m: float) -> float:
        approach = self.approach
        if approach is None or depth_m >= approach.depth_m:
            return self.axial_step_m
        to_rim_m = -depth_m
        if to_rim_m <= approach.step_m:
            return approach.step_m
        return self.axial_step_m if to_rim_m >= self.axial_step_m else to_rim_m

    def _axial_steps(self, depth_m: FloatArray) -> float | FloatArray:
        approach = self.approach
        if approach is None:
            return self.axial_step_m
        short_m = np.clip(-depth_m, approach.step_m, self.axial_step_m)
        return np.where(depth_m >= approach.depth_m, self.axial_step_m, short_m)


def check_expert(expert: Expert) -> None:
    """Raise `ValueError`, naming what is wrong, for an expert that nothing can be led by."""
    for axis, length in zip("xyz", expert.step_box_m, strict=True):
        positive(f"step_box_m ({axis}) of the expert", length)
    non_negative("gain_m_N of the expert", expert.gain_m_N)
    longest = expert.step_box_m[2]
    if not 0.0 <= expert.axial_step_m <= longest:
        raise ValueError(
            f"axial_step_m of the expert is {expert.axial_step_m!r}; "
            f"it must be at least 0 and at most {longest!r}, the step box along z"
        )
    if expert.approach is None:
        return
    if not 0.0 < expert.approach.step_m <= expert.axial_step_m:
        raise ValueError(
            f"step_m of the expert's approach is {expert.approach.step_m!r}; it must be greater "
            f"than 0 and at most {expert.axial_step_m!r}, the expert's axial_step_m"
        )
    positive("depth_m of the expert's approach", expert.approach.depth_m)
