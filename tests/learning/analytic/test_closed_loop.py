"""What a loop makes of insertions: their ends, rewards, noise and gradients."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch
from torch import Tensor

from learning.analytic.closed_loop import ClosedLoop, Course
from learning.analytic.plan import AnalyticPlan
from learning.analytic.plant_batch import PlantBatch, drawn_batch
from learning.environments.config import DualPegConfig
from learning.environments.core import DualPegCore
from learning.environments.kernels import Outcome
from learning.networks import Actor
from simulator.checks import FloatArray
from tests.learning.analytic import plans
from tests.learning.analytic.plans import Watched

LIMITS = (0.07, 0.1, 1.0)
STROKE_M = 2.3e-3
"""Of the paper's part: its last mouth is 2 mm deep."""


def plants_of(plan: AnalyticPlan, n: int, seed: int = 5) -> PlantBatch:
    return drawn_batch(plan.plants.distribution(), n, seed)


def nominal(folder: Path, n: int = 12, **others: Any) -> tuple[ClosedLoop, PlantBatch]:
    """The paper's task without noise; x and y of the residual reach the force limits."""
    training = plans.values(plans.PAPER) | {"steps": 100} | others
    training["residual"] = {"range_um": [4, 4, 30]}
    plan = plans.plan(folder, training, plans.quiet(plans.plant_values("nominal")))
    return ClosedLoop(plan.settings, plan.expert), plants_of(plan, n)


def played(
    loop: ClosedLoop,
    plants: PlantBatch,
    actor_of: Callable[[ClosedLoop], Actor] = plans.random_actor,
) -> Course:
    with torch.no_grad():
        return loop.play(actor_of(loop), plants, np.random.default_rng(3))


class Seen:
    """An actor that keeps what it sees and answers with zeros."""

    def __init__(self, n_actions: int) -> None:
        self.frames: list[FloatArray] = []
        self._n_actions = n_actions

    def __call__(self, frames: Tensor) -> Tensor:
        self.frames.append(frames.numpy().copy())
        return torch.zeros(len(frames), self._n_actions)


def look(loop: ClosedLoop, plants: PlantBatch, seed: int = 3) -> list[FloatArray]:
    """What the network sees, step by step: (n, n_states)."""
    seen: Any = Seen(loop.n_actions)
    loop.play(seen, plants, np.random.default_rng(seed))
    frames: list[FloatArray] = seen.frames
    return frames


def ends(watched: Watched) -> FloatArray:
    """Steps of each insertion until a force is over its limit or the stroke is reached."""
    forces = np.abs(np.array(watched.wrenches[1:])[:, :, :3])
    depths = np.array(watched.poses[1:])[:, :, 2]
    is_over = (forces > LIMITS).any(2) | (depths >= STROKE_M - 1e-8)
    return np.where(is_over.any(0), is_over.argmax(0) + 1, len(is_over))


def test_an_insertion_ends_at_a_force_limit_or_the_stroke(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    loop, plants = nominal(tmp_path)
    watched = plans.watch(monkeypatch)
    course = played(loop, plants)
    steps = ends(watched)
    running = course.is_running.numpy()
    assert (running == (np.arange(len(running))[:, np.newaxis] < steps)).all()
    last = [watched.wrenches[step][n] for n, step in enumerate(steps)]
    depths = np.array([watched.poses[step][n, 2] for n, step in enumerate(steps)])
    is_forced = (np.abs(last)[:, :3] > LIMITS).any(1)
    assert 0 < is_forced.sum() < len(plants)
    assert depths[~is_forced] == pytest.approx(STROKE_M, abs=1e-12)
    for n, step in enumerate(steps):
        for part in (course.reward, course.radial_N):
            assert not part[step:, n].any()
            assert part[step - 1, n] != 0.0
        later = np.array(watched.poses[step:])[:, n]
        assert np.ptp(later, axis=0).max() <= 1e-12, "an insertion that is over moves on"


def test_nothing_is_played_after_the_last_end(tmp_path: Path) -> None:
    loop, plants = nominal(tmp_path, steps=1_000)
    course = played(loop, plants)
    assert course.is_running[-1].any()
    assert len(course.is_running) < 200
    assert course.is_running.sum(0).max() == len(course.is_running)


def test_an_insertion_is_broken_off(tmp_path: Path) -> None:
    loop, plants = nominal(tmp_path, steps=5)
    course = played(loop, plants, plans.zero_actor)
    assert course.reward.shape == course.radial_N.shape == (5, 12)
    assert course.is_running.all()


@pytest.mark.parametrize("is_expert", [True, False])
def test_rewards_are_those_of_the_papers_environment(
    is_expert: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    loop, plants = nominal(tmp_path)
    watched = plans.watch(monkeypatch)
    course = played(loop, plants, plans.zero_actor if is_expert else plans.random_actor)
    core = DualPegCore(DualPegConfig(), len(plants))
    core.reset(np.uint64(1), watched.poses[0])
    running = np.vstack((course.is_running.numpy() > 0.0, np.zeros(len(plants), dtype=bool)))
    compared = 0
    for number, steps in enumerate(watched.steps[1:]):
        action = (steps / [20e-6, 20e-6, 60e-6]).astype(np.float32)
        if is_expert:
            action[:, 2] = 50 / 60  # also of the step that is cut to the stroke
        batch = core.step(action)
        runs, goes_on = running[number], running[number + 1]
        rows = runs if is_expert else runs & (batch.pose[:, 2] < STROKE_M - 1e-8)
        compared += rows.sum()
        assert course.reward[number].numpy()[rows] == pytest.approx(batch.reward[rows], abs=2e-5)
        if is_expert:
            assert ((batch.outcome == Outcome.RUNNING)[runs] == goes_on[runs]).all()
    assert compared > 200


def test_the_reward_by_hand(tmp_path: Path) -> None:
    """Free air: R_p is 1 and R_n (1 - 50 um / 60 um) / 2, and no force is there to pay for."""
    loop, plants = nominal(tmp_path, steps=1, force_weight=3)
    course = played(loop, plants, plans.zero_actor)
    free = course.radial_N[0] < 2e-6
    assert 0 < free.sum() < len(free)
    assert course.reward[0][free].numpy() == pytest.approx(1.0 - 1.0 / 12.0, abs=2e-4)


def test_the_force_weight_takes_its_share(tmp_path: Path) -> None:
    paper, plants = nominal(tmp_path)
    weighted, _ = nominal(tmp_path, force_weight=2.5)
    reward, less = played(paper, plants), played(weighted, plants)
    assert torch.equal(reward.radial_N, less.radial_N)
    share = reward.radial_N / 0.044
    expected = 2.5 * (share + share**2)
    assert torch.allclose(reward.reward - less.reward, expected, rtol=1e-9, atol=1e-12)
    assert expected.max() > 1.0


def test_the_mean_is_over_insertions_not_steps() -> None:
    reward = torch.tensor([[1.0, 0.5], [0.0, 0.1]])
    running = torch.tensor([[1.0, 1.0], [0.0, 1.0]])
    assert Course(reward, reward, running).reward_per_step.item() == pytest.approx(0.65)


def test_noise_reaches_the_inputs(tmp_path: Path) -> None:
    """In free air inputs are the noise by their scale: 2 mN, 10 uN m and 0.5 um."""
    training = plans.values() | {"history": 2, "steps": 1}
    training["trial"]["start_depth_um"] = -200
    plan = plans.plan(tmp_path, training, plans.plant_values())
    n = 2000
    (seen,) = look(ClosedLoop(plan.settings, plan.expert), plants_of(plan, n))
    newest, missing = seen[:, :11], seen[:, 11:]
    assert not missing.any()
    expected = [0.2, 0.2, 0.02, 0.025, 0.025, 0.1, 0.05, 0.05, 0.0, 0.0, 0.0005]
    assert newest.std(0) == pytest.approx(expected, rel=0.08)
    mean = np.array([0.0] * 10 + [-0.2])
    assert (np.abs(newest.mean(0) - mean) <= 5.0 * np.array(expected) / np.sqrt(n) + 1e-7).all()
    moving = [*range(8), 10]
    correlation = np.corrcoef(newest[:, moving], rowvar=False)
    assert np.abs(correlation - np.eye(9)).max() < 0.11


def test_the_expert_acts_on_what_is_seen(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """In free air its lateral steps are 2 mN of noise times 80 um/N: it does not know better."""
    training = plans.values() | {"steps": 1}
    plan = plans.plan(tmp_path, training, plans.plant_values())
    loop, watched = ClosedLoop(plan.settings, plan.expert), plans.watch(monkeypatch)
    loop.play(plans.zero_actor(loop), plants_of(plan, 1000), np.random.default_rng(1))
    lateral_m = watched.steps[1][:, :2]
    assert lateral_m.std(0) == pytest.approx([1.6e-7, 1.6e-7], rel=0.08)


def test_noise_is_drawn_anew_and_frames_move_on(tmp_path: Path) -> None:
    training = plans.values() | {"history": 2, "steps": 3}
    plan = plans.plan(tmp_path, training, plans.plant_values())
    loop, plants = ClosedLoop(plan.settings, plan.expert), plants_of(plan, 5)
    first, second, third = look(loop, plants)
    assert (second[:, 11:] == first[:, :11]).all()
    assert (third[:, 11:] == second[:, :11]).all()
    assert (second[:, :3] != first[:, :3]).all()
    again, other = look(loop, plants), look(loop, plants, seed=4)
    assert (again[2] == third).all()
    assert (other[0][:, :8] != first[:, :8]).all()


def test_torque_is_about_the_sensor(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """It sits 40 mm behind the part, so a force along y turns it about x: 40 uN m for each mN."""
    training = plans.values() | {"history": 1, "steps": 20, "input_bound": 100}
    plan = plans.plan(tmp_path, training, plans.quiet(plans.plant_values()))
    watched = plans.watch(monkeypatch)
    frames = look(ClosedLoop(plan.settings, plan.expert), plants_of(plan, 8))
    wrench, seen = np.array(watched.wrenches[:-1]), np.array(frames)
    x, y = wrench[..., 0], wrench[..., 1]
    assert np.abs(wrench[..., :2]).max(axis=(0, 1)).min() > 5e-3
    torques = (wrench[..., 3] + 0.04 * y, wrench[..., 4] - 0.04 * x, wrench[..., 5])
    for axis, (torque, scale) in enumerate(zip(torques, (400e-6, 400e-6, 100e-6), strict=True)):
        assert seen[..., 3 + axis] == pytest.approx(torque / scale, rel=1e-6, abs=1e-6)


@pytest.mark.parametrize("name", ["paper", "extended"])
def test_the_gradient_is_the_slope_of_the_reward(name: str, tmp_path: Path) -> None:
    """Along the gradient by all weights, the reward changes as central differences say."""
    path = {"paper": plans.PAPER, "extended": plans.EXTENDED}[name]
    file = {"paper": "nominal", "extended": "extended"}[name]
    training = plans.values(path) | {"steps": 40}
    plan = plans.plan(tmp_path, training, plans.quiet(plans.plant_values(file)))
    loop, plants = ClosedLoop(plan.settings, plan.expert), plants_of(plan, 6)
    actor = plans.random_actor(loop, 0.05)

    def reward() -> Tensor:
        return loop.play(actor, plants, np.random.default_rng(3)).reward_per_step

    slopes = torch.autograd.grad(reward(), actor.weights)
    length = torch.stack([slope.square().sum() for slope in slopes]).sum().sqrt()
    far, found = 1e-3, []
    with torch.no_grad():
        for side in (1.0, -2.0):
            for weight, slope in zip(actor.weights, slopes, strict=True):
                weight.add_(slope, alpha=side * far / length.item())
            found.append(reward().item())
    assert (found[0] - found[1]) / (2 * far) == pytest.approx(length.item(), rel=0.05)
