"""How a skill (expert and policy) inserts from given start poses."""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from learning.environments.config import DualPegConfig
from learning.environments.core import DualPegCore
from learning.environments.kernels import Outcome
from learning.policy.policy import Policy
from simulator.checks import FloatArray


@dataclass(frozen=True, slots=True)
class Insertions:
    """What n insertions were like."""

    outcome: npt.NDArray[np.int8]
    """(n,): codes of `Outcome`."""
    steps: npt.NDArray[np.int64]
    """(n,)."""
    force_N: FloatArray
    """(m, 3): force on the part after each step of all of them."""
    peak_N: FloatArray
    """(n, 3): largest force along each axis."""
    lower_peak_N: FloatArray
    """(n,): largest radial force from the last hole's rim on."""

    @property
    def succeeded(self) -> int:
        """How many parts were inserted."""
        return int(np.count_nonzero(self.outcome == Outcome.INSERTED))

    def metrics(self) -> dict[str, float]:
        """Return the figures that a policy's file states, forces in N."""
        radial = np.hypot(self.force_N[:, 0], self.force_N[:, 1])
        x, y, z = self.peak_N.max(axis=0)
        return {
            "insertions": len(self.outcome),
            "succeeded": self.succeeded,
            "steps_mean": float(self.steps.mean()),
            "steps_max": int(self.steps.max()),
            "radial_force_mean_N": float(radial.mean()),
            "share_of_radial_forces_to_44_mN": float((radial <= 0.044).mean()),
            "peak_x_N": float(x),
            "peak_y_N": float(y),
            "peak_z_N": float(z),
            "lower_hole_peak_p95_N": float(np.percentile(self.lower_peak_N, 95)),
            "lower_hole_peak_max_N": float(self.lower_peak_N.max()),
        }


def insert_all(
    policy: Policy, config: DualPegConfig, poses: FloatArray, key: int = 0
) -> Insertions:
    """Insert from each of the start poses (n, 5) until all have ended.

    `key` is that of the noise on what is observed, if the environment has any.
    """
    n = len(poses)
    core = DualPegCore(config, n)
    batch = core.reset(np.uint64(key), poses)
    outcome, steps = np.zeros(n, dtype=np.int8), np.zeros(n, dtype=np.int64)
    peak_N, lower_peak_N = np.zeros((n, 3)), np.zeros(n)
    forces = []
    holes = config.part.holes
    rim_m = sum(h.gap_m for h in holes) + sum(h.thickness_m for h in holes[:-1])
    while (running := outcome == Outcome.RUNNING).any():
        force_N, depth_m = config.force_N(batch.observation), config.depth_m(batch.observation)
        step_m = policy.residuals(np.column_stack([force_N, depth_m]))
        step_m += policy.expert.step(force_N[:, :2], depth_m)
        batch = core.step(config.action(step_m))
        outcome[running] = batch.outcome[running]
        steps[running] = batch.steps[running]
        now_N = np.abs(batch.force_N)
        forces.append(batch.force_N[running])
        peak_N[running] = np.maximum(peak_N, now_N)[running]
        lower = running & (batch.pose[:, 2] >= rim_m)
        radial_N = np.hypot(now_N[:, 0], now_N[:, 1])
        lower_peak_N[lower] = np.maximum(lower_peak_N, radial_N)[lower]
    return Insertions(outcome, steps, np.concatenate(forces), peak_N, lower_peak_N)
