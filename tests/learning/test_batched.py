"""Training on many insertions at once."""

from pathlib import Path

import numpy as np
import pytest
import yaml

from drivers.contract.errors import ConfigurationError
from learning.batched import BatchedPlan, BatchedTrainer, load_batched
from tests.learning.training.plans import short_file

SHIPPED = Path("config/training/batched.yaml")


def plan(folder: Path, **changes: object) -> BatchedPlan:
    """Small networks, 8 insertions for 60 steps, the batches as `changes` want them."""
    short_file(folder)
    values = yaml.safe_load(SHIPPED.read_text())
    values |= {"training": "short.yaml", "insertions": 8, "steps": 60} | changes
    values["ddpg"] |= {"batch_size": 8}
    for network in ("actor", "critic"):
        values["ddpg"][network] = {"hidden": [8], "learning_rate": 1e-3}
    path = folder / "batched.yaml"
    path.write_text(yaml.safe_dump(values))
    return load_batched(path)


def trained(batched: BatchedPlan, seed: int) -> BatchedTrainer:
    trainer = BatchedTrainer(batched, seed)
    while not trainer.is_done:
        trainer.play()
    return trainer


def test_same_seed_same_weights(tmp_path: Path) -> None:
    batched = plan(tmp_path)
    weights = [trained(batched, seed).ddpg.actor.weights[0].detach().numpy() for seed in (1, 1, 2)]
    assert (weights[0] == weights[1]).all()
    assert not (weights[0] == weights[2]).all()


def test_what_is_kept_follows_on(tmp_path: Path) -> None:
    trainer = trained(plan(tmp_path), 1)
    rows = [tensor.numpy()[: trainer.replay.added] for tensor in trainer.replay.rows]
    state, action, reward, after, terminal = rows[:5]
    # 60 steps of 8 insertions, less the step that starts another after each of the ends.
    ends = int(terminal.sum())
    assert 8 <= ends <= 16
    assert trainer.replay.added == 60 * 8 - ends
    # The first insertion is every eighth row until one of them ends.
    noise = 0.2 * 2.0
    assert np.abs(after[0:160:8, 3] - state[8:168:8, 3]).max() < 1e-6
    assert np.abs(state[:8, 3] + 20 / 2300).max() < noise * 2
    assert np.abs(action).max() <= 10.0 * 1.5
    assert (reward <= 1.0).all()
    assert trainer.ddpg.updates == 60 * 4


def test_learning_rates_fall_to_zero(tmp_path: Path) -> None:
    trainer = BatchedTrainer(plan(tmp_path), 1)
    rates = []
    while not trainer.is_done:
        trainer.play()
        rates.append(trainer.ddpg.actor_optimiser.param_groups[0]["lr"])
    assert rates[0] == 1e-3
    assert rates[30] == pytest.approx(0.5e-3)
    assert rates[-1] == pytest.approx(1e-3 / 60)


def test_too_few_insertions(tmp_path: Path) -> None:
    with pytest.raises(ConfigurationError, match=r"insertions = 7 is not valid: must be at least"):
        plan(tmp_path, insertions=7)


def test_returns_of_several_steps(tmp_path: Path) -> None:
    """Insertions side by side keep single steps, and must not pretend otherwise."""
    additions = {
        "twin_critics": False,
        "critic_norm": "none",
        "return_steps": 3,
        "target_noise": 0.0,
        "actor_period": 1,
    }
    ddpg = {**yaml.safe_load(SHIPPED.read_text())["ddpg"], "additions": additions}
    with pytest.raises(ConfigurationError, match=r"return_steps = 3 is not valid: must be 1"):
        plan(tmp_path, ddpg=ddpg)


def test_the_shipped_file_has_the_papers_problem() -> None:
    settings = load_batched(SHIPPED).plan.settings
    assert settings.residual.range_m == (1e-6, 1e-6, 30e-6)
    assert settings.task.state_sigma == 0.2
    assert settings.ddpg.batch_size == 256
