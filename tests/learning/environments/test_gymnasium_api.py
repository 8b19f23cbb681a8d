"""What gymnasium and Stable-Baselines3 ask of an environment."""

import subprocess
import sys
from pathlib import Path

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env
from gymnasium.vector import AutoresetMode
from stable_baselines3.common.env_checker import check_env as check_for_sb3

from learning.environments import (
    ACTION,
    OBSERVATION,
    DualPegConfig,
    DualPegEnv,
    DualPegVectorEnv,
)

ROOT = Path(__file__).parents[3]


def test_gymnasium_finds_no_fault() -> None:
    check_env(gymnasium.make("tenon/DualPeg-v0").unwrapped)


def test_stable_baselines_finds_no_fault() -> None:
    check_for_sb3(DualPegEnv())


def test_spaces_have_a_component_for_each_name() -> None:
    env = DualPegEnv()
    assert env.observation_space.shape == (len(OBSERVATION),) == (4,)
    assert env.action_space.shape == (len(ACTION),) == (3,)


def test_make_passes_settings_on() -> None:
    env = gymnasium.make("tenon/DualPeg-v0", config=DualPegConfig(start_depth_m=1e-4))
    _, info = env.reset(seed=1)
    assert info["depth_m"] == 1e-4


def test_make_vec_makes_the_vector_environment() -> None:
    env = gymnasium.make_vec(
        "tenon/DualPeg-v0", num_envs=3, vectorization_mode="vector_entry_point"
    )
    assert isinstance(env.unwrapped, DualPegVectorEnv)
    assert env.metadata["autoreset_mode"] is AutoresetMode.NEXT_STEP
    observation, _ = env.reset(seed=1)
    assert observation in env.observation_space
    assert observation.shape == (3, 4)


def test_sync_vector_environment_takes_the_single_one() -> None:
    env = gymnasium.make_vec("tenon/DualPeg-v0", num_envs=2, vectorization_mode="sync")
    env.reset(seed=1)
    _, reward, _, _, info = env.step(np.zeros((2, 3), dtype=np.float32))
    np.testing.assert_allclose(reward, info["force_reward"] - info["depth_penalty"])


@pytest.mark.slow
def test_gymnasium_imports_the_environment_by_its_name() -> None:
    """In a process that imports nothing of ours itself."""
    program = (
        "import gymnasium; env = gymnasium.make('learning.environments:tenon/DualPeg-v0');"
        "print(env.reset(seed=1)[0].shape)"
    )
    done = subprocess.run(
        [sys.executable, "-W", "error", "-c", program],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stdout.strip() == "(4,)"


def test_data_of_a_step_stay_as_they_are() -> None:
    env = DualPegVectorEnv(2)
    first, info = env.reset(seed=1)
    pose, seen = info["pose"].copy(), first.copy()
    env.step(np.ones((2, 3), dtype=np.float32))
    np.testing.assert_array_equal(info["pose"], pose)
    np.testing.assert_array_equal(first, seen)
    with pytest.raises(ValueError, match="read-only"):
        info["pose"][0, 0] = 1.0
