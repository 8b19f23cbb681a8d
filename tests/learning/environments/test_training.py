"""Algorithms from a library learn on the environment without an adapter."""

from collections.abc import Iterator

import gymnasium
import numpy as np
import pytest
import torch
from stable_baselines3 import DDPG, TD3


@pytest.fixture(autouse=True)
def one_thread() -> Iterator[None]:
    """Threads only slow networks of this size down."""
    before = torch.get_num_threads()
    torch.set_num_threads(1)
    yield
    torch.set_num_threads(before)


@pytest.mark.slow
@pytest.mark.parametrize("algorithm", [TD3, DDPG])
def test_stable_baselines_trains(algorithm: type[TD3]) -> None:
    env = gymnasium.make("learning.environments:tenon/DualPeg-v0")
    model = algorithm(
        "MlpPolicy",
        env,
        seed=1,
        learning_starts=50,
        batch_size=32,
        policy_kwargs={"net_arch": [32, 32]},
        device="cpu",
    )
    before = [weight.detach().clone() for weight in model.actor.parameters()]
    model.learn(300)
    after = list(model.actor.parameters())
    assert any((old != new).any() for old, new in zip(before, after, strict=True))
    assert all(bool(weight.isfinite().all()) for weight in after)
    observation, _ = env.reset(seed=2)
    action, _ = model.predict(observation, deterministic=True)
    assert action in env.action_space
    assert model.replay_buffer is not None
    assert model.replay_buffer.size() == 300
    assert np.isfinite(model.replay_buffer.rewards[:300]).all()
