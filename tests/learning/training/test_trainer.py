from pathlib import Path

import numpy as np
import pytest
import torch

from learning.environments.kernels import Outcome
from learning.training.plan import load_plan
from learning.training.policy_of import policy_of
from learning.training.trainer import Trainer
from tests.learning.training.plans import PAPER, played, short_plan


def weights(trainer: Trainer) -> list[torch.Tensor]:
    ddpg = trainer.ddpg
    networks = (ddpg.actor, ddpg.critic, ddpg.target_actor, ddpg.target_critic)
    return [weight for network in networks for weight in network.weights]


def same(one: Trainer, other: Trainer) -> bool:
    pairs = zip(weights(one), weights(other), strict=True)
    return one.rounds == other.rounds and all(torch.equal(a, b) for a, b in pairs)


def test_same_seed_same_training(tmp_path: Path) -> None:
    plan = short_plan(tmp_path)
    first = played(plan, seed=3, rounds=2)
    assert same(first, played(plan, seed=3, rounds=2))
    assert not same(first, played(plan, seed=4, rounds=2))


def test_a_training_depends_on_nobody_elses_random_numbers(tmp_path: Path) -> None:
    plan = short_plan(tmp_path)
    first = played(plan, seed=3, rounds=1)
    torch.manual_seed(9)
    np.random.default_rng(9).random(5)
    assert same(first, played(plan, seed=3, rounds=1))


def test_learning_begins_with_a_full_batch(tmp_path: Path) -> None:
    trainer = played(short_plan(tmp_path), seed=1, rounds=2)
    steps = sum(r.steps for r in trainer.rounds)
    assert trainer.replay.added == steps
    assert trainer.ddpg.updates == steps - 31
    start = Trainer(trainer.plan, 1)
    assert all((a != b).any() for a, b in zip(weights(trainer), weights(start), strict=True))


def test_keeps_the_residual_that_was_made(tmp_path: Path) -> None:
    trainer = Trainer(short_plan(tmp_path), seed=1)
    trainer.exploration.sigma = 0.0
    trainer.play()
    kept = trainer.replay.rows
    # Before the first update, without noise on it: what the untrained actor answers.
    untrained = Trainer(trainer.plan, 1).ddpg
    for row in range(30):
        answer = untrained.act(kept.state[row].numpy())
        assert kept.action[row].numpy() == pytest.approx(answer, abs=1e-6)
        assert np.abs(answer).max() > 1e-4


def test_the_next_noise_follows_from_the_outcome(tmp_path: Path) -> None:
    trainer = Trainer(short_plan(tmp_path), 2)
    before = 0.1
    for _ in range(4):
        round_ = trainer.play()
        assert round_.sigma == before
        before = 0.1 if round_.outcome == Outcome.INSERTED else 0.4
        assert trainer.exploration.sigma == before


def test_trains_and_judges_on_different_states() -> None:
    plan = load_plan(PAPER)
    trained, judged = plan.training_poses(1), plan.evaluation_poses(1)
    assert trained.shape == judged.shape == (300, 5)
    assert not np.isin(trained[:, :2], judged[:, :2]).any()
    for poses in (trained, judged):
        assert np.hypot(poses[:, 0], poses[:, 1]).max() <= 10e-6
        assert np.degrees(np.hypot(poses[:, 3], poses[:, 4])).max() <= 0.3
        assert (poses[:, 2] == -20e-6).all()


def test_training_sees_noise_and_judging_does_not() -> None:
    plan = load_plan(PAPER)
    assert plan.environment.force_noise_N == (0.0, 0.0, 0.0)
    assert plan.noisy_environment.force_noise_N == pytest.approx((0.014, 0.02, 0.2))
    assert plan.noisy_environment.depth_noise_m == pytest.approx(0.46e-3)


def test_the_policy_answers_as_the_actor(tmp_path: Path) -> None:
    trainer = played(short_plan(tmp_path), seed=1, rounds=2)
    policy = policy_of(trainer.ddpg.actor, trainer.plan)
    state = np.random.default_rng(1).uniform(-1.9, 1.9, (50, 4)).astype(np.float32)
    with torch.no_grad():
        answer = trainer.ddpg.actor(torch.from_numpy(state)).numpy()
    residual_m = policy.residuals(state * [0.07, 0.1, 1.0, 2.3e-3])
    assert residual_m == pytest.approx(answer * [1e-6, 1e-6, 30e-6], rel=1e-4, abs=1e-12)
    assert policy.expert.gain_m_N == pytest.approx(160e-6)
    assert policy.expert.axial_step_m == pytest.approx(50e-6)
