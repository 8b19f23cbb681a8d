"""Training sees and does what a trial with the policy sees and does, step by step."""

from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest
import torch

from learning.analytic.closed_loop import ClosedLoop
from learning.analytic.plant_batch import drawn_batch
from learning.analytic.trainer import policy_of
from learning.evaluation.plant import drawn_plants
from learning.evaluation.trial import Trial, insert
from learning.networks import Actor
from learning.skill_controller import SkillController
from simulator.checks import FloatArray
from tests.learning.analytic import plans
from tests.learning.analytic.plans import Values

PLANTS, SEED = 6, 5


class Way(NamedTuple):
    """One insertion in the trial and in the loop."""

    trial: FloatArray
    """(T, 6): wrenches after each step, up to the end by the loop's rules."""
    loop: FloatArray
    """(T', 6): wrenches while the insertion runs."""
    steps: FloatArray
    """(T', n_actions): steps of the loop."""
    ending: str


def ways(
    folder: Path,
    monkeypatch: pytest.MonkeyPatch,
    training: Values,
    actor_of: Callable[[ClosedLoop], Actor] = plans.random_actor,
    plants: str = "extended",
) -> list[Way]:
    chosen = plans.plan(folder, training, plans.quiet(plans.plant_values(plants)))
    loop = ClosedLoop(chosen.settings, chosen.expert)
    actor = actor_of(loop)
    distribution = chosen.plants.distribution()
    watched = plans.watch(monkeypatch)
    batch = drawn_batch(distribution, PLANTS, SEED)
    with torch.no_grad():
        course = loop.play(actor, batch, np.random.default_rng(0))
    seen, steps = np.array(watched.wrenches[1:]), np.array(watched.steps[1:])
    lengths = course.is_running.numpy().sum(0).astype(int)
    controller = SkillController(policy_of(actor, chosen))
    found = []
    rules = chosen.settings.trial.rules()
    for number, plant in enumerate(drawn_plants(distribution, PLANTS, SEED)):
        record = insert(Trial(plant, rules, np.random.default_rng(1)), controller)
        over = (np.abs(record.wrenches[:, :3]) > rules.force_limit_N).any(1)
        end = int(np.argmax(over)) + 1 if over.any() else len(record.wrenches)
        ending = "force" if over.any() else "inserted" if record.is_inserted else "steps"
        rows = slice(lengths[number])
        found.append(Way(record.wrenches[:end], seen[rows, number], steps[rows, number], ending))
    return found


def check(way: Way, tolerance_N: float) -> None:
    assert way.loop.shape == way.trial.shape
    assert np.abs(way.loop[:, :3] - way.trial[:, :3]).max() <= tolerance_N
    assert np.abs(way.loop[:, 3:] - way.trial[:, 3:]).max() <= 4e-3 * tolerance_N


def small_residual(**others: object) -> Values:
    """A training whose residual is small enough that insertions go on to their end."""
    return plans.values() | {"steps": 200} | others | {"residual": RESIDUAL}


RESIDUAL = {"range_um": [3, 3, 2.4], "turn_deg": 0.01}


def test_the_expert_alone(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """No network rounds here: the wrenches are the same to 1e-9 N."""
    found = ways(tmp_path, monkeypatch, small_residual(), plans.zero_actor)
    for way in found:
        check(way, 1e-9)
    assert "inserted" in {way.ending for way in found}
    assert np.mean([np.abs(way.trial[:, :2]).max() > 0.01 for way in found]) > 0.5


def test_history_turns_and_approach(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Networks answer to single precision: some 1e-12 m in a step, on walls of 12 mN/um."""
    found = ways(tmp_path, monkeypatch, small_residual(history=3))
    for way in found:
        check(way, 5e-8)
        assert len(way.trial) > 40
        assert np.ptp(way.trial[:, :3], axis=0).min() > 1e-3
    assert {way.ending for way in found} == {"inserted", "force"}


def test_steps_that_are_cut(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The sum of expert and residual is cut to the box, and each input to its bound."""
    training = plans.values() | {"history": 2, "steps": 200, "input_bound": 0.3}
    training["trial"]["step_box_um"] = [2.5, 2.5, 57.7]
    training["residual"] = {"range_um": [2, 2, 30], "turn_deg": 0.01}
    found = ways(tmp_path, monkeypatch, training)
    for way in found:
        check(way, 5e-8)
    assert max(len(way.trial) for way in found) > 40
    longest_m = np.max([np.abs(way.steps[:, :3]).max(0) for way in found], axis=0)
    assert longest_m == pytest.approx([2.5e-6, 2.5e-6, 57.7e-6])


def test_the_papers_inputs_and_outputs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    training = plans.values(plans.PAPER) | {"steps": 200}
    found = ways(tmp_path, monkeypatch, training, plants="nominal")
    for way in found:
        check(way, 5e-8)
    assert "inserted" in {way.ending for way in found}


def test_broken_off_after_the_steps_that_are_allowed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    training = small_residual(steps=7)
    training["trial"]["steps_max"] = 7
    for way in ways(tmp_path, monkeypatch, training):
        check(way, 5e-8)
        assert len(way.trial) == 7
