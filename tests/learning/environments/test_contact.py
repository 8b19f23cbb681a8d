"""Forces and contact states of the environments are those of the reference contact model."""

import numpy as np

from learning.environments import DualPegConfig, DualPegVectorEnv
from simulator.contact import ContactLaw, solve
from simulator.geometry import Hole, Part, Shaft
from simulator.states import contact_states, phase_codes

NARROW = Part((Hole(1.004e-3, 3e-4), Hole(1.008e-3, 4e-4, gap_m=1e-3)))
"""A part with little clearance, so that the shaft touches most of the time."""


def test_forces_and_states_follow_from_pose_and_travel() -> None:
    config = DualPegConfig(
        part=NARROW,
        shaft=Shaft(1e-3, 3e-3),
        law=ContactLaw(stiffness_N_m=3e3, friction=0.3),
        force_limit_N=(1.0, 1.0, 1.0),
        stroke_m=1.6e-3,
    )
    env = DualPegVectorEnv(200, config)
    env.reset(seed=1)
    generator = np.random.default_rng(2)
    seen = set()
    for _ in range(40):
        action = generator.uniform(-0.5, 0.5, (200, 3)) * [0.2, 0.2, 1.0] + [0.0, 0.0, 0.5]
        *_, info = env.step(action.astype(np.float32))
        pose = info["pose"]
        expected = solve(config.part, config.shaft, pose, info["travel_m"], config.law)
        np.testing.assert_allclose(info["force_N"], expected.wrench[:, :3], rtol=1e-9, atol=1e-12)
        states = contact_states(expected, phase_codes(config.part, pose[:, 2]))
        np.testing.assert_array_equal(info["contact_state"], states)
        seen |= set(states.tolist())
    assert len(seen) >= 8
