"""Trajectories follow from seed, stream and actions alone."""

import numpy as np
import pytest

from learning.environments import DualPegConfig, DualPegEnv, DualPegVectorEnv
from learning.environments.blocks import BLOCK

NOISY = DualPegConfig(force_noise_N=(1e-3, 2e-3, 5e-3), depth_noise_m=1e-6)
STEPS = 70
"""Long enough for some episodes to end and new ones to start."""


def actions(n: int) -> np.ndarray:
    """Rough pushes into the hole; row i is the same for any n."""
    table = np.random.default_rng(5).uniform(-1.0, 1.0, (1000, STEPS, 3)).astype(np.float32)
    table[..., :2] *= 0.3
    table[..., 2] = np.abs(table[..., 2])
    return table[np.arange(n) % 1000].swapaxes(0, 1)


def run(env: DualPegVectorEnv, seed: int) -> list[np.ndarray]:
    """Everything that an episode shows, for all steps."""
    observation, info = env.reset(seed=seed)
    seen = [[observation], [info["pose"]], [info["force_N"]]]
    rewards, ended = [], []
    for action in actions(env.num_envs):
        observation, reward, terminated, truncated, info = env.step(action)
        for column, value in zip(seen, (observation, info["pose"], info["force_N"]), strict=True):
            column.append(value)
        rewards.append(reward)
        ended.append(terminated | 2 * truncated)
    return [*(np.array(column) for column in seen), np.array(rewards), np.array(ended)]


def test_vector_environment_goes_the_way_of_single_ones_exactly() -> None:
    n = 6
    observations, poses, forces, rewards, ended = run(DualPegVectorEnv(n, NOISY), seed=3)
    assert ended.any()
    for i in range(n):
        env = DualPegEnv(NOISY, stream=i)
        observation, info = env.reset(seed=3)
        over = False
        for t, action in enumerate(actions(n)[:, i]):
            np.testing.assert_array_equal(observation, observations[t, i])
            np.testing.assert_array_equal(info["pose"], poses[t, i])
            np.testing.assert_array_equal(info["force_N"], forces[t, i])
            if over:
                observation, info = env.reset()
                reward, over = 0.0, False
            else:
                observation, reward, terminated, truncated, info = env.step(action)
                over = terminated or truncated
            assert reward == rewards[t, i]
            assert over == bool(ended[t, i])


def test_number_of_environments_does_not_matter() -> None:
    few, many = (run(DualPegVectorEnv(n, NOISY), seed=3) for n in (3, 50))
    for left, right in zip(few, many, strict=True):
        np.testing.assert_array_equal(left, right[:, :3])


def test_blocks_on_several_threads_do_not_matter() -> None:
    # In contact from the start, so that forces tell the start poses apart.
    config = DualPegConfig(start_depth_m=1e-4, force_noise_N=(1e-3, 1e-3, 1e-3))
    n = 2 * BLOCK + 5
    rows = np.array([0, 7, BLOCK - 1, BLOCK, 2 * BLOCK, n - 1])
    env = DualPegVectorEnv(n, config)
    first, _ = env.reset(seed=3)
    action = np.full((n, 3), 0.2, dtype=np.float32)
    second, reward, *_ = env.step(action)
    env.step(np.full((n, 3), np.nan, dtype=np.float32))
    third, *_ = env.step(action)
    for i in rows:
        single = DualPegEnv(config, stream=int(i))
        observation, _ = single.reset(seed=3)
        np.testing.assert_array_equal(observation, first[i])
        observation, value, *_ = single.step(action[i])
        np.testing.assert_array_equal(observation, second[i])
        assert value == reward[i]
        observation, _ = single.reset()
        np.testing.assert_array_equal(observation, third[i])


def test_same_seed_same_way_other_seed_other_way() -> None:
    one, same, other = (run(DualPegVectorEnv(4, NOISY), seed) for seed in (3, 3, 4))
    for left, right in zip(one, same, strict=True):
        np.testing.assert_array_equal(left, right)
    assert not np.isin(one[1][:, :, 0], other[1][:, :, 0]).any()


def test_environments_and_episodes_start_apart() -> None:
    env = DualPegVectorEnv(100)
    starts = [env.reset(seed=3 if n == 0 else None)[1]["pose"] for n in range(5)]
    assert len(np.unique(np.array(starts)[..., 0])) == 500


def test_reset_without_a_seed_goes_on_and_with_the_seed_begins_again() -> None:
    env = DualPegEnv()
    first = [env.reset(seed=3)[1]["pose"], env.reset()[1]["pose"]]
    again = [env.reset(seed=3)[1]["pose"], env.reset()[1]["pose"]]
    np.testing.assert_array_equal(first, again)
    assert not np.array_equal(first[0], first[1])


def test_environments_without_a_seed_differ() -> None:
    left, right = (DualPegEnv().reset()[1]["pose"] for _ in range(2))
    assert not np.array_equal(left, right)


def test_start_poses_fill_their_discs_evenly() -> None:
    _, info = DualPegVectorEnv(20_000).reset(seed=2)
    offset, tilt = info["pose"][:, :2] / 10e-6, info["pose"][:, 3:] / np.radians(0.3)
    assert (info["pose"][:, 2] == -20e-6).all()
    for disc in (offset, tilt):
        square = (disc**2).sum(axis=1)
        assert square.max() < 1.0
        # Uniform in a disc: the square of the radius is uniform. Five standard errors are 0.01.
        assert square.mean() == pytest.approx(0.5, abs=0.01)
        assert square.var() == pytest.approx(1.0 / 12.0, abs=0.003)
        assert np.abs(disc.mean(axis=0)).max() < 0.02
    assert np.abs(np.corrcoef(np.hstack([offset, tilt]).T) - np.eye(4)).max() < 0.036


def test_noise_is_on_the_observation_alone() -> None:
    n = 5_000
    config = DualPegConfig(force_noise_N=(1e-3, 2e-3, 5e-3), depth_noise_m=4e-6)
    noisy, clean = DualPegVectorEnv(n, config), DualPegVectorEnv(n)
    noisy.reset(seed=1)
    clean.reset(seed=1)
    action = np.full((n, 3), 0.3, dtype=np.float32)
    observation, reward, *_, info = noisy.step(action)
    _, expected_reward, *_ = clean.step(action)
    np.testing.assert_array_equal(reward, expected_reward)
    noise = np.column_stack(
        [
            config.force_N(observation) - info["force_N"],
            config.depth_m(observation) - info["depth_m"],
        ]
    )
    scale = np.array([1e-3, 2e-3, 5e-3, 4e-6])
    assert np.abs(noise.mean(axis=0) / scale).max() < 0.07
    assert noise.std(axis=0) / scale == pytest.approx(np.ones(4), abs=0.05)
    later, *_ = noisy.step(np.zeros((n, 3), dtype=np.float32))
    assert (
        abs(np.corrcoef(noise[:, 0], config.force_N(later)[:, 0] - info["force_N"][:, 0])[0, 1])
        < 0.07
    )


def test_observation_saturates() -> None:
    config = DualPegConfig(force_noise_N=(10.0, 10.0, 10.0))
    observation, _ = DualPegVectorEnv(100, config).reset(seed=1)
    assert np.abs(observation[:, :3]).max() == 2.0
    assert observation in DualPegVectorEnv(100).observation_space
