from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
import torch

from drivers.contract.errors import TrainingError
from learning.analytic.closed_loop import ClosedLoop, Course
from learning.analytic.plan import AnalyticPlan
from learning.analytic.plant_batch import PlantBatch
from learning.analytic.trainer import AnalyticTrainer
from learning.networks import Actor
from tests.learning.analytic import plans

UNSTABLE = (
    "the gradient is not finite in update 2: the insertions are unstable; a smaller expert gain, "
    "residual or learning rate may help"
)


def short(folder: Path, **others: Any) -> AnalyticPlan:
    """A few steps of the paper's task, without noise."""
    training = plans.values(plans.PAPER) | {"steps": 15} | others
    return plans.plan(folder, training, plans.quiet(plans.plant_values("nominal")))


def trained(plan: AnalyticPlan, seed: int, updates: int | None = None) -> AnalyticTrainer:
    trainer = AnalyticTrainer(plan, seed)
    while not trainer.is_done and len(trainer.updates) != updates:
        trainer.update()
    return trainer


def same(one: AnalyticTrainer, other: AnalyticTrainer) -> bool:
    pairs = zip(one.actor.weights, other.actor.weights, strict=True)
    return one.updates == other.updates and all(torch.equal(a, b) for a, b in pairs)


def spoil(monkeypatch: pytest.MonkeyPatch, by: float, update: int) -> None:
    """Multiply the reward of one update, the first being 1."""
    play, calls = ClosedLoop.play, []

    def spoiled(
        self: ClosedLoop, actor: Actor, plants: PlantBatch, generator: np.random.Generator
    ) -> Course:
        calls.append(len(plants))
        course = play(self, actor, plants, generator)
        return course._replace(reward=course.reward * (by if len(calls) == update else 1.0))

    monkeypatch.setattr(ClosedLoop, "play", spoiled)


def test_same_seed_same_training(tmp_path: Path) -> None:
    plan = short(tmp_path)
    first = trained(plan, seed=3)
    torch.manual_seed(9)
    assert same(first, trained(plan, seed=3))
    other = trained(plan, seed=4)
    assert not same(first, other)
    assert (first.pool.misalignment != other.pool.misalignment).any()


def test_seeds_differ_in_the_weights_that_they_begin_with(tmp_path: Path) -> None:
    plan = short(tmp_path)
    first, other = AnalyticTrainer(plan, 3), AnalyticTrainer(plan, 4)
    assert not torch.equal(first.actor.weights[0], other.actor.weights[0])
    for weight in first.actor.weights[-2:]:
        assert 0.0 < weight.abs().max() <= 0.003


def test_each_update_has_plants_and_noise_of_its_own(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    plan = plans.plan(tmp_path, plans.values() | {"steps": 2}, plans.plant_values())
    plants_of: list[bytes] = []
    chance: list[float] = []
    play, taken = ClosedLoop.play, PlantBatch.taken

    def watched(
        self: ClosedLoop, actor: Actor, plants: PlantBatch, generator: np.random.Generator
    ) -> Course:
        chance.append(generator.random())
        return play(self, actor, plants, generator)

    def watched_taken(self: PlantBatch, rows: npt.NDArray[np.int64]) -> PlantBatch:
        plants_of.append(rows.tobytes())
        return taken(self, rows)

    monkeypatch.setattr(ClosedLoop, "play", watched)
    monkeypatch.setattr(PlantBatch, "taken", watched_taken)
    for seed in (1, 2):
        trained(plan, seed, updates=3)
    assert len(set(chance)) == len(set(plants_of)) == 6


def test_a_short_training_improves_the_reward(tmp_path: Path) -> None:
    """Without chance from update to update, as all plants are the same."""
    plants = plans.quiet(plans.plant_values("nominal"))
    plants["alignment"]["position_error_um"]["constant"] = 0
    plants["alignment"]["tilt_error_deg"]["constant"] = 0
    training = plans.values(plans.PAPER) | {"steps": 15, "updates": 20, "insertions": 1}
    rewards = [u.reward for u in trained(plans.plan(tmp_path, training, plants), 1).updates]
    # At first each step of 50 um costs (1 - 5/6) / 2; there is no force, 60 um cost nothing.
    assert rewards[0] == pytest.approx(1.0 - 1.0 / 12.0, abs=1e-3)
    assert all(later > sooner for sooner, later in pairwise(rewards[:10]))
    assert rewards[-1] > 0.97


def test_a_short_training_improves_insertions_with_contact(tmp_path: Path) -> None:
    trainer = trained(short(tmp_path, updates=16, insertions=8, steps=20), 2)
    rewards, forces = ([u[i] for u in trainer.updates] for i in (0, 1))
    assert np.mean(rewards[-3:]) > np.mean(rewards[:3]) + 0.01
    assert min(forces) > 5e-4


def test_what_an_update_tells(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    trial = plans.values(plans.PAPER)["trial"] | {"force_limit_mN": [5, 100, 1000]}
    trainer = AnalyticTrainer(short(tmp_path, trial=trial), 2)
    courses: list[Course] = []
    play = ClosedLoop.play

    def watched(
        self: ClosedLoop, actor: Actor, plants: PlantBatch, generator: np.random.Generator
    ) -> Course:
        courses.append(play(self, actor, plants, generator))
        return courses[-1]

    monkeypatch.setattr(ClosedLoop, "play", watched)
    made = trainer.update()
    reward, radial, running = (part.detach().numpy() for part in courses[0])
    assert 0.2 < running.mean() < 0.9
    assert made.reward == pytest.approx((reward.sum(0) / running.sum(0)).mean())
    assert made.radial_N == pytest.approx(radial.sum() / running.sum())
    assert made.steps == pytest.approx(running.sum() / 8)
    assert made.gradient_norm > 0.0
    assert trainer.steps == running.sum()
    assert trainer.updates == [made]
    trainer.update()
    assert trainer.steps == sum(int(course.is_running.sum()) for course in courses)


def test_a_gradient_that_is_not_finite_ends_the_training(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    trainer = AnalyticTrainer(short(tmp_path), 1)
    spoil(monkeypatch, float("nan"), update=2)
    trainer.update()
    before = [weight.clone() for weight in trainer.actor.weights]
    with pytest.raises(TrainingError) as caught:
        trainer.update()
    assert str(caught.value) == UNSTABLE
    pairs = zip(before, trainer.actor.weights, strict=True)
    assert all(torch.equal(a, b) for a, b in pairs)
    assert len(trainer.updates) == 1


def test_the_learning_rate_falls_evenly(tmp_path: Path) -> None:
    """4 updates at 1, 3/4, 1/2 and 1/4 of 1e-2; Adam's first step is as long as its rate."""
    trainer = AnalyticTrainer(short(tmp_path), 1)
    rates, before = [], [weight.detach().clone() for weight in trainer.actor.weights]
    for number in range(4):
        trainer.update()
        rates.append(trainer._optimiser.param_groups[0]["lr"])
        if number == 0:
            pairs = zip(trainer.actor.weights, before, strict=True)
            assert max((a - b).abs().max().item() for a, b in pairs) == pytest.approx(
                1e-2, rel=1e-3
            )
    assert rates == pytest.approx([1e-2, 7.5e-3, 5e-3, 2.5e-3])
    assert trainer.is_done


def test_a_long_gradient_is_shortened(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    trainer = AnalyticTrainer(short(tmp_path, gradient_norm_max=0.5), 1)
    spoil(monkeypatch, 1e4, update=1)
    made = trainer.update()
    assert made.gradient_norm > 50.0
    gradients = [weight.grad for weight in trainer.actor.weights]
    length = torch.stack([g.square().sum() for g in gradients if g is not None]).sum().sqrt()
    assert length.item() == pytest.approx(0.5, rel=1e-4)


def test_the_policy_is_the_actor_with_its_processing(tmp_path: Path) -> None:
    plan = plans.plan(tmp_path, plans.values() | {"steps": 3}, plans.plant_values())
    trainer = trained(plan, 1, updates=2)
    policy = trainer.policy()
    seen = np.random.default_rng(1).uniform(-4.9, 4.9, (50, 88)).astype(np.float32)
    with torch.no_grad():
        answer = trainer.actor(torch.from_numpy(seen)).numpy()
    scales = np.array([0.01, 0.01, 0.1, 400e-6, 400e-6, 100e-6, 10e-6, 10e-6])
    turn = np.radians(0.3)
    residuals = policy.residuals(seen * np.tile([*scales, turn, turn, 1e-3], 8))
    turned = np.radians(0.05)
    assert residuals == pytest.approx(
        answer * [10e-6, 10e-6, 2.4e-6, turned, turned], rel=1e-3, abs=1e-12
    )
    names = [name for name, _ in policy.inputs]
    assert names[:6] == ["force_x", "force_y", "force_z", "torque_x", "torque_y", "torque_z"]
    assert names[6:] == ["displacement_x", "displacement_y", "turn_x", "turn_y", "depth"]
    assert policy.history == 8
    assert policy.bound == 5.0
    assert policy.expert == plan.expert
    assert policy.expert.gain_m_N == pytest.approx(80e-6)
    assert policy.expert.axial_step_m == pytest.approx(57.6e-6)
    assert policy.expert.approach == pytest.approx((2.5e-6, 10e-6))
    kept = policy.layers[0].weight.copy()
    trainer.update()
    assert (policy.layers[0].weight == kept).all()
