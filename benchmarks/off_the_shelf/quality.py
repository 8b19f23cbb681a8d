"""How good a policy is: insertions from start poses that no training sees, without noise.

A policy is judged as it is stored, so every trainer's policies go the same way here.
"""

import time
from typing import NamedTuple

import numpy as np

from learning.environments.config import ACTION, PAPER
from learning.environments.core import DualPegCore
from learning.environments.kernels import Outcome
from learning.policy.policy import Policy
from simulator.checks import FloatArray

STATES = 100
_HELD_OUT = np.uint64(20_261_126)
"""Key of the start poses: no training draws from it."""
_RUNNING = int(Outcome.RUNNING)


class Quality(NamedTuple):
    """Means over the insertions from the held-out start poses.

    Of two policies the one that inserts more often is better, then the one of the higher score.
    """

    inserted: float
    """Share inserted without a force above its limit."""
    score: float
    """Reward (eq. 11) per step where inserted, 0 where not: 1 is the longest steps at no force."""
    reward: float
    """Sum over an insertion; slow insertions gather more than fast ones."""
    radial_force_N: float
    """Over all steps."""
    peak_force_N: float
    """Largest radial force of an insertion."""
    steps: float

    def reaches(self, other: "Quality") -> bool:
        """Whether this is as good as another, or better."""
        return (self.inserted, self.score) >= (other.inserted, other.score)


class Point(NamedTuple):
    """A policy on the way of a training."""

    training_steps: int
    wall_s: float
    """Since training began, without what judging took."""
    cpu_s: float
    """Of all threads in that time: what else the machine does hardly changes it."""
    quality: Quality


class Recorder:
    """Judges policies while the clocks of the training stand still.

    Make it when all is ready to train: `began` is when its process was started, by
    `time.monotonic()`.
    """

    def __init__(self, began: float) -> None:
        self.points: list[Point] = []
        self.best: Policy | None = None
        core = DualPegCore(PAPER, 1)
        core.reset(np.uint64(0))
        core.step(np.zeros((1, len(ACTION)), dtype=np.float32))
        self.startup_s = time.monotonic() - began
        """To start the process and load libraries and compiled kernels."""
        self._wall_s = self._cpu_s = 0.0
        self._go_on()

    def judge(self, training_steps: int, policy: Policy) -> None:
        """Add a point."""
        self._wall_s += time.perf_counter() - self._wall_since
        self._cpu_s += time.process_time() - self._cpu_since
        quality = quality_of(policy)
        if not any(point.quality.reaches(quality) for point in self.points):
            self.best = policy
        self.points.append(Point(training_steps, self._wall_s, self._cpu_s, quality))
        self._go_on()

    def _go_on(self) -> None:
        self._wall_since, self._cpu_since = time.perf_counter(), time.process_time()


def start_poses(n: int = STATES) -> FloatArray:
    """Return the first `n` held-out start poses (n, 5)."""
    return DualPegCore(PAPER, n).reset(_HELD_OUT).pose


def quality_of(policy: Policy, n: int = STATES) -> Quality:
    """Insert by expert and policy from the first `n` held-out start poses until all have ended."""
    core = DualPegCore(PAPER, n)
    batch = core.reset(_HELD_OUT)
    outcome = np.zeros(n, dtype=np.int8)
    steps, peak_N = np.zeros(n), np.zeros(n)
    rewards, forces_N = np.zeros(n), np.zeros(n)
    while (running := outcome == _RUNNING).any():
        seen_N, depth_m = PAPER.force_N(batch.observation), PAPER.depth_m(batch.observation)
        step_m = policy.residuals(np.column_stack([seen_N, depth_m]))
        step_m += policy.expert.step(seen_N[:, :2], depth_m)
        batch = core.step(PAPER.action(step_m))
        radial_N = np.hypot(batch.force_N[:, 0], batch.force_N[:, 1])
        rewards[running] += batch.reward[running]
        forces_N[running] += radial_N[running]
        peak_N[running] = np.maximum(peak_N, radial_N)[running]
        outcome[running] = batch.outcome[running]
        steps[running] = batch.steps[running]
    inserted = outcome == int(Outcome.INSERTED)
    return Quality(
        inserted=float(inserted.mean()),
        score=float((inserted * rewards / steps).mean()),
        reward=float(rewards.mean()),
        radial_force_N=float(forces_N.sum() / steps.sum()),
        peak_force_N=float(peak_N.mean()),
        steps=float(steps.mean()),
    )
