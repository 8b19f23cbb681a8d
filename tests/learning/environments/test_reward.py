"""Reward terms by hand: eqs. (11) to (13) with 0.7, 0.3, 2, 70 mN and 100 mN."""

import numpy as np
import pytest

from learning.environments import DualPegEnv
from tests.learning.environments.cases import action, at, upright


@pytest.mark.parametrize(
    ("x_um", "y_um", "x_penalty", "y_penalty"),
    [
        (7.0, 0.0, 0.16, 0.0),  # 16 mN along x: 0.7 * 16 / 70
        (-7.0, 0.0, 0.16, 0.0),
        (0.0, 7.0, 0.0, 0.048),  # 16 mN along y: 0.3 * 16 / 100
        (0.0, -7.0, 0.0, 0.048),
        (0.0, 0.0, 0.0, 0.0),
    ],
)
def test_force_reward(x_um: float, y_um: float, x_penalty: float, y_penalty: float) -> None:
    _, info = DualPegEnv().reset(seed=1, options={"pose": upright(x_um, y_um)})
    assert info["force_x_penalty"] == pytest.approx(x_penalty, abs=1e-9)
    assert info["force_y_penalty"] == pytest.approx(y_penalty, abs=1e-9)
    assert info["force_reward"] == pytest.approx(1.0 - x_penalty - y_penalty, abs=1e-9)


@pytest.mark.parametrize(
    ("axial_step", "penalty"),
    [
        (1.0, 0.16),  # 0.16 too long
        (0.5, 0.17),  # 0.34 too short, by half
        (0.0, 0.42),
        (-1.0, 0.92),
        (7.0, 0.16),  # cut to the step box
        (1e300, 0.16),
    ],
)
def test_depth_penalty_against_an_ideal_step_of_084(axial_step: float, penalty: float) -> None:
    env = at(DualPegEnv(), upright(7.0))
    _, reward, _, _, info = env.step(np.array([0.0, 0.0, axial_step]))
    assert info["depth_penalty"] == pytest.approx(penalty, abs=1e-7)
    assert reward == pytest.approx(0.84 - penalty, abs=1e-7)


def test_depth_penalty_takes_the_forces_before_the_step_and_force_reward_those_after() -> None:
    env = at(DualPegEnv(), upright(7.0))
    _, reward, _, _, info = env.step(action(x=-0.25, z=1.0))  # 5 um back: out of contact
    assert info["force_reward"] == pytest.approx(1.0, abs=1e-12)
    assert reward == pytest.approx(1.0 - 0.16, abs=1e-7)
    _, reward, _, _, _ = env.step(action(z=1.0))
    assert reward == pytest.approx(1.0, abs=1e-7)


def test_last_step_is_weighed_as_asked_for_though_it_ends_at_the_stroke() -> None:
    env = at(DualPegEnv(), upright(0.0, depth_um=2290.0))
    _, reward, _, _, info = env.step(action(z=1.0))
    assert info["travel_m"][2] == pytest.approx(10e-6)
    assert reward == pytest.approx(1.0)


def test_observation_is_normalised() -> None:
    observation, info = DualPegEnv().reset(seed=1, options={"pose": upright(7.0, 0.0, 230.0)})
    assert observation == pytest.approx([16.0 / 70.0, 0.0, 0.0, 0.1], abs=1e-6)
    assert info["force_N"] == pytest.approx([16e-3, 0.0, 0.0], abs=1e-9)
    env = at(DualPegEnv(), upright(0.0, 7.0))
    observation, *_ = env.step(action(z=0.5))
    assert observation == pytest.approx([0.0, 0.16, 3.2e-3, 280.0 / 2300.0], abs=1e-6)
