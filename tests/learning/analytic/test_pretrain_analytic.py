"""The command as a user runs it."""

from pathlib import Path
from typing import Any

import onnxruntime
import pytest
import typer
from tensorboard.backend.event_processing.event_accumulator import EventAccumulator
from typer.testing import CliRunner, Result

from drivers.contract.errors import TrainingError
from learning.analytic.plan import load_analytic
from learning.analytic.trainer import AnalyticTrainer
from learning.evaluation.contenders import Skill
from learning.evaluation.metrics import Thresholds, measured
from learning.evaluation.plant import drawn_plants
from learning.evaluation.trials import cases_of, insert_each
from learning.policy.file import read_policy
from learning.pretrain_analytic import pretrain_analytic
from tests.learning.analytic import plans

app = typer.Typer()
app.command()(pretrain_analytic)


def pretrain(config: Path, out: Path, seed: int = 1) -> Result:
    options = ["--config", str(config), "--out", str(out), "--seed", str(seed)]
    return CliRunner().invoke(app, options)


def short(folder: Path) -> Path:
    training = plans.values() | {"history": 2, "steps": 6, "updates": 3}
    return plans.write(folder, training, plans.plant_values())


@pytest.mark.slow
def test_what_it_writes(tmp_path: Path) -> None:
    config, out = short(tmp_path), tmp_path / "run"
    ran = pretrain(config, out, seed=5)
    assert ran.exit_code == 0, ran.output
    stored = read_policy(out / "policy.safetensors")
    about: dict[str, Any] = {**stored.manifest.about}
    policy = stored.policy
    assert about["trainer"] == "learning/pretrain_analytic.py"
    assert (about["seed"], about["updates"], about["insertions"]) == (5, 3, 24)
    assert about["training_steps"] == 3 * 8 * 6
    training, plants = (about["configuration"][name] for name in ("training", "plants"))
    assert "plants" not in training
    assert training["history"] == 2
    assert plants["contact"]["friction"] == {"uniform": [0.1, 0.3]}

    plan = load_analytic(config)
    trainer = AnalyticTrainer(plan, 5)
    while not trainer.is_done:
        trainer.update()
    for layer, other in zip(policy.layers, trainer.policy().layers, strict=True):
        assert (layer.weight == other.weight).all()
        assert (layer.bias == other.bias).all()
    plants_judged = drawn_plants(plan.plants.distribution(), 4, 2001)
    rules = plan.settings.trial.rules()
    records = insert_each(Skill(policy), cases_of(plants_judged, 2001), rules)
    figures = measured(records, Thresholds(0.1, 0.044))
    metrics = about["metrics"]
    assert metrics["insertions"] == 4
    assert metrics["succeeded"] == figures.is_success.sum()
    assert metrics["steps_mean"] == pytest.approx(figures.values["steps"].mean())
    mean_N = figures.values["radial_mean"].mean()
    assert metrics["radial_force_mean_N"] == pytest.approx(mean_N)
    assert f"Inserted {int(figures.is_success.sum())} of 4 plants" in ran.output

    network = onnxruntime.InferenceSession(out / "policy.onnx")
    assert network.get_inputs()[0].shape[-1] == policy.n_values == 22
    scalars = EventAccumulator(str(out / "tensorboard")).Reload()
    events = scalars.Scalars("insertion/reward_per_step")
    assert [event.step for event in events] == [1, 2, 3]
    assert [event.value for event in events] == pytest.approx([u.reward for u in trainer.updates])


@pytest.mark.slow
def test_same_seed_same_files(tmp_path: Path) -> None:
    config = short(tmp_path)
    for name, seed in (("a", 1), ("b", 1), ("c", 2)):
        assert pretrain(config, tmp_path / name, seed).exit_code == 0
    for file in ("policy.safetensors", "policy.onnx"):
        first, again, other = ((tmp_path / name / file).read_bytes() for name in "abc")
        assert first == again
        assert first != other


def test_a_file_that_is_not_there(tmp_path: Path) -> None:
    ran = pretrain(tmp_path / "none.yaml", tmp_path / "run")
    assert ran.exit_code == 2
    missing = tmp_path / "none.yaml"
    assert ran.stderr == f"error: {missing}: cannot be read: No such file or directory\n"
    assert not (tmp_path / "run").exists()


def test_a_file_that_cannot_be_used(tmp_path: Path) -> None:
    training = plans.values() | {"history": 0}
    config = plans.write(tmp_path, training, plans.plant_values())
    ran = pretrain(config, tmp_path / "run")
    assert ran.exit_code == 2
    expected = "history = 0 is not valid: must be at least 1 and at most 64"
    assert ran.stderr == f"error: {config}: {expected}\n"
    assert not (tmp_path / "run").exists()


def test_a_folder_that_cannot_be_made(tmp_path: Path) -> None:
    config = short(tmp_path)
    ran = pretrain(config, config)
    assert ran.exit_code == 2
    assert ran.stderr == f"error: cannot create the folder {config}: File exists\n"


def test_a_folder_that_holds_something(tmp_path: Path) -> None:
    """Nothing of another run is overwritten or mixed with."""
    out = tmp_path / "run"
    out.mkdir()
    (out / "policy.safetensors").write_bytes(b"another")
    ran = pretrain(short(tmp_path), out)
    assert ran.exit_code == 2
    said = f"error: the folder {out} is not empty (policy.safetensors); name another one\n"
    assert ran.stderr == said
    assert (out / "policy.safetensors").read_bytes() == b"another"


def test_a_policy_that_could_not_be_written_is_not_trained(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A scale that no policy takes is told before the first update, with no folder made."""
    training = plans.values()
    training["inputs"]["force_mN"] = [1e-10, 10, 100]
    monkeypatch.setattr(AnalyticTrainer, "update", None)
    config = plans.write(tmp_path, training, plans.plant_values())
    ran = pretrain(config, tmp_path / "run")
    assert ran.exit_code == 2
    assert ran.stderr.startswith(f"error: {config}: scale of input 'force_x' is 1e-13; it must be")
    assert not (tmp_path / "run").exists()


def test_a_training_that_fails(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(self: AnalyticTrainer) -> None:
        raise TrainingError("the gradient is not finite in update 1")

    monkeypatch.setattr(AnalyticTrainer, "update", fail)
    ran = pretrain(short(tmp_path), tmp_path / "run")
    assert ran.exit_code == 2
    assert ran.stderr == "error: the gradient is not finite in update 1\n"
    assert not (tmp_path / "run" / "policy.safetensors").exists()
