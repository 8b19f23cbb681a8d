"""How episodes end, and what is refused."""

import math
from typing import Any

import numpy as np
import pytest
from gymnasium.error import ResetNeeded

from learning.environments import DualPegConfig, DualPegEnv, DualPegVectorEnv, Outcome
from tests.learning.environments.cases import action, at, upright


def end(env: DualPegEnv, **step: float) -> tuple[bool, bool, Outcome]:
    _, _, terminated, truncated, info = env.step(action(**step))
    return terminated, truncated, Outcome(info["outcome"])


def test_inserted_at_the_stroke() -> None:
    env = at(DualPegEnv(), upright(0.0, depth_um=2200.0))
    assert end(env, z=1.0) == (False, False, Outcome.RUNNING)
    _, _, terminated, truncated, info = env.step(action(z=1.0))
    assert (terminated, truncated, info["is_success"]) == (True, False, True)
    assert info["outcome"] == Outcome.INSERTED
    assert info["depth_m"] == 2.3e-3


@pytest.mark.parametrize(
    ("pose", "step", "config", "outcome"),
    [
        # One micrometre is 8 mN: 64 mN grow to 72 mN, 96 mN to 104 mN.
        (upright(13.0), {"x": 0.05}, DualPegConfig(), Outcome.FORCE_X),
        (upright(-13.0), {"x": -0.05}, DualPegConfig(), Outcome.FORCE_X),
        (upright(0.0, 17.0), {"y": 0.05}, DualPegConfig(), Outcome.FORCE_Y),
        # Friction is a fifth of 16 mN.
        (
            upright(7.0),
            {"z": 0.1},
            DualPegConfig(force_limit_N=(0.07, 0.1, 0.003)),
            Outcome.FORCE_Z,
        ),
    ],
)
def test_force_over_a_limit_is_a_failure(
    pose: Any, step: dict[str, float], config: DualPegConfig, outcome: Outcome
) -> None:
    assert end(at(DualPegEnv(config), pose), **step) == (True, False, outcome)


@pytest.mark.parametrize(
    ("pose", "step"),
    [
        (upright(13.0), {"x": 0.03}),  # 68.8 mN
        (upright(0.0, 17.0), {"y": 0.02}),  # 99.2 mN
    ],
)
def test_force_below_its_limit_is_none(pose: Any, step: dict[str, float]) -> None:
    assert end(at(DualPegEnv(), pose), **step) == (False, False, Outcome.RUNNING)


def test_force_over_the_limit_at_the_stroke_is_a_failure() -> None:
    env = at(DualPegEnv(), upright(13.0, depth_um=2290.0))
    assert end(env, x=0.2, z=1.0) == (True, False, Outcome.FORCE_X)


def test_steps_run_out() -> None:
    env = at(DualPegEnv(DualPegConfig(steps_max=2)), upright(0.0))
    assert end(env) == (False, False, Outcome.RUNNING)
    assert end(env) == (False, True, Outcome.OUT_OF_STEPS)


def test_what_happens_in_the_last_step_counts_before_running_out() -> None:
    env = at(DualPegEnv(DualPegConfig(steps_max=1)), upright(0.0, depth_um=2290.0))
    assert end(env, z=1.0) == (True, False, Outcome.INSERTED)


def test_a_thousand_steps_at_most() -> None:
    assert DualPegConfig().steps_max == 1000


def test_no_step_without_an_episode() -> None:
    env = DualPegEnv()
    with pytest.raises(ResetNeeded):
        env.step(action())
    at(env, upright(0.0, depth_um=2290.0)).step(action(z=1.0))
    with pytest.raises(ResetNeeded):
        env.step(action())
    with pytest.raises(ResetNeeded):
        DualPegVectorEnv(2).step(np.zeros((2, 3), dtype=np.float32))


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_single_environment_refuses_an_action_that_is_not_finite(value: float) -> None:
    env = at(DualPegEnv(), upright(0.0))
    with pytest.raises(ValueError, match=r"action is -?(nan|inf) at index \(1,\)"):
        env.step(action(y=value))
    assert end(env, z=0.5) == (False, False, Outcome.RUNNING)


@pytest.mark.parametrize("shape", [(2,), (4,), (1, 3)])
def test_action_of_another_shape_is_refused(shape: tuple[int, ...]) -> None:
    env = at(DualPegEnv(), upright(0.0))
    with pytest.raises(ValueError, match="action has shape"):
        env.step(np.zeros(shape, dtype=np.float32))


def test_vector_refuses_actions_of_another_shape() -> None:
    env = DualPegVectorEnv(2)
    env.reset(seed=1)
    with pytest.raises(ValueError, match=r"must be \(2, 3\)"):
        env.step(np.zeros((3, 3), dtype=np.float32))


@pytest.mark.parametrize("value", [math.nan, math.inf])
def test_an_action_that_is_not_finite_ends_its_own_episode_alone(value: float) -> None:
    actions = np.full((3, 3), 0.1, dtype=np.float32)
    twin, env = DualPegVectorEnv(3), DualPegVectorEnv(3)
    twin.reset(seed=1)
    env.reset(seed=1)
    bad = actions.copy()
    bad[1, 2] = value
    observation, reward, terminated, truncated, info = env.step(bad)
    expected, expected_reward, *_ = twin.step(actions)
    assert terminated.tolist() == [False, True, False]
    assert not truncated.any()
    assert info["outcome"].tolist() == [Outcome.RUNNING, Outcome.NOT_FINITE, Outcome.RUNNING]
    assert np.isnan(observation[1]).all()
    assert np.isnan(reward[1])
    np.testing.assert_array_equal(observation[[0, 2]], expected[[0, 2]])
    np.testing.assert_array_equal(reward[[0, 2]], expected_reward[[0, 2]])

    observation, reward, terminated, _, info = env.step(actions)
    assert observation in env.observation_space
    assert reward[1] == 0.0
    assert not terminated.any()
    assert info["depth_m"][1] == -20e-6


def test_next_step_starts_a_new_episode_and_takes_no_action() -> None:
    env = DualPegVectorEnv(2)
    poses = np.stack([upright(0.0, depth_um=2290.0), upright(0.0)])
    env.reset(seed=1, options={"pose": poses})
    _, _, terminated, _, info = env.step(np.ones((2, 3), dtype=np.float32) * action(z=1.0))
    assert terminated.tolist() == [True, False]
    assert info["is_success"].tolist() == [True, False]
    _, reward, terminated, _, info = env.step(np.full((2, 3), np.nan, dtype=np.float32))
    assert info["outcome"].tolist() == [Outcome.RUNNING, Outcome.NOT_FINITE]
    assert info["depth_m"][0] == -20e-6
    assert reward[0] == 0.0


@pytest.mark.parametrize(
    "pose", [np.full(5, np.nan), np.zeros(4), np.array([0.0, 0.0, 0.0, 2.0, 0.0])]
)
def test_start_pose_that_is_no_pose_is_refused(pose: Any) -> None:
    with pytest.raises(ValueError, match=r"poses? (is|has|hold)"):
        DualPegEnv().reset(seed=1, options={"pose": pose})
