"""The paper's expert (eq. 6) on the paper's simulation."""

import numpy as np

from learning.environments import DualPegVectorEnv, Outcome

GAIN_M_N = 0.2 * 800e-6
AXIAL_STEP_M = 50e-6


def test_expert_inserts_from_300_of_300_start_poses() -> None:
    env = DualPegVectorEnv(300)
    observation, _ = env.reset(seed=1)
    outcomes = np.zeros(300, dtype=int)
    peak_N = np.zeros(3)
    for _ in range(60):
        force = env.config.force_N(observation)
        step = np.column_stack([-GAIN_M_N * force[:, :2], np.full(300, AXIAL_STEP_M)])
        observation, _, _, _, info = env.step(env.config.action(step))
        going = outcomes == Outcome.RUNNING
        outcomes[going] = info["outcome"][going]
        peak_N = np.maximum(peak_N, np.abs(info["force_N"]).max(axis=0))
    assert (outcomes == Outcome.INSERTED).all()
    assert (peak_N < [0.07, 0.1, 1.0]).all()
    assert (peak_N[:2] > 0.02).all()
