"""A training that stops and goes on is the same as one that does not."""

import json
from collections.abc import Callable
from pathlib import Path

import pytest
import torch
import yaml
from safetensors.torch import load_file, save_file

from drivers.contract.errors import TrainingError
from learning.training import checkpoint
from learning.training.checkpoint import read_checkpoint, write_checkpoint
from learning.training.plan import load_plan
from learning.training.run_folder import RunFolder
from learning.training.trainer import Trainer
from tests.learning.training.plans import played, short_file, short_plan


def everything(trainer: Trainer, folder: Path) -> bytes:
    """All of a training, as its checkpoint holds it."""
    path = folder / "everything.safetensors"
    write_checkpoint(trainer, path)
    return path.read_bytes()


@pytest.mark.parametrize("rounds", [0, 1, 3])
def test_goes_on_as_if_it_had_never_stopped(tmp_path: Path, rounds: int) -> None:
    plan = short_plan(tmp_path)
    path = tmp_path / "checkpoint.safetensors"
    trainer = played(plan, seed=2, rounds=rounds)
    trainer.exploration.sigma = 0.25
    write_checkpoint(trainer, path)
    trainer.play()
    resumed = Trainer(plan, 2)
    read_checkpoint(resumed, path)
    resumed.play()
    assert everything(resumed, tmp_path) == everything(trainer, tmp_path)


def test_the_folder_takes_up_the_latest_and_keeps_two(tmp_path: Path) -> None:
    plan = short_plan(tmp_path)
    folder = RunFolder(tmp_path / "run")
    trainer = Trainer(plan, 1)
    assert folder.take_up(trainer) == 0
    for _ in range(3):
        trainer.play()
        folder.keep(trainer)
    assert [p.name for p in sorted(folder.checkpoints.iterdir())] == [
        "round-00000002.safetensors",
        "round-00000003.safetensors",
    ]
    resumed = Trainer(plan, 1)
    assert folder.take_up(resumed) == 3
    assert everything(resumed, tmp_path) == everything(trainer, tmp_path)


def test_it_holds_no_pickle(tmp_path: Path) -> None:
    content = everything(played(short_plan(tmp_path), 1, 1), tmp_path)
    length = int.from_bytes(content[:8], "little")
    manifest = json.loads(json.loads(content[8 : 8 + length])["__metadata__"]["manifest"])
    assert manifest["seed"] == 1
    assert manifest["configuration"]["training"]["ddpg"]["replay_size"] == 200
    assert len(manifest["rounds"]) == 1
    assert {"torch", "numpy", "tenon", "python"} <= manifest["versions"].keys()
    assert len(manifest["sha256"]) == 64


Spoil = Callable[[Path], None]


def _cut(path: Path) -> None:
    path.write_bytes(path.read_bytes()[:-100])


def _flip(path: Path) -> None:
    content = bytearray(path.read_bytes())
    content[-1] ^= 1
    path.write_bytes(content)


def _no_manifest(path: Path) -> None:
    save_file(load_file(path), path)


def _another_file(path: Path) -> None:
    path.write_text("not a checkpoint")


def _remove(path: Path) -> None:
    path.unlink()


def _other_number(path: Path) -> None:
    content = path.read_bytes()
    path.write_bytes(content.replace(b'\\"sigma\\":0.', b'\\"sigma\\":1.', 1))


@pytest.mark.parametrize(
    ("spoil", "message"),
    [
        (_cut, "is damaged or no safetensors file"),
        (_flip, "has been altered"),
        (_other_number, "has been altered"),
        (_no_manifest, "has no manifest in its metadata"),
        (_another_file, "is damaged or no safetensors file"),
        (_remove, "cannot be read: No such file"),
    ],
)
def test_a_damaged_file_is_refused(tmp_path: Path, spoil: Spoil, message: str) -> None:
    plan = short_plan(tmp_path)
    path = tmp_path / "checkpoint.safetensors"
    write_checkpoint(played(plan, 1, 1), path)
    spoil(path)
    with pytest.raises(TrainingError, match=message) as refused:
        read_checkpoint(Trainer(plan, 1), path)
    assert str(refused.value).startswith(f"{path}: ")


def test_another_seed_is_refused(tmp_path: Path) -> None:
    plan = short_plan(tmp_path)
    path = tmp_path / "checkpoint.safetensors"
    write_checkpoint(Trainer(plan, 1), path)
    with pytest.raises(TrainingError, match=r"is of seed 1, not of 2$"):
        read_checkpoint(Trainer(plan, 2), path)


def test_another_configuration_is_refused(tmp_path: Path) -> None:
    file = short_file(tmp_path)
    path = tmp_path / "checkpoint.safetensors"
    write_checkpoint(Trainer(load_plan(file), 1), path)
    changed = yaml.safe_load(file.read_text())
    changed["ddpg"]["discount"] = 0.9
    file.write_text(yaml.safe_dump(changed))
    with pytest.raises(
        TrainingError,
        match=r"another training: ddpg\.discount is 0\.99 in the checkpoint and 0\.9 now$",
    ):
        read_checkpoint(Trainer(load_plan(file), 1), path)


def test_other_libraries_are_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    plan = short_plan(tmp_path)
    path = tmp_path / "checkpoint.safetensors"
    write_checkpoint(Trainer(plan, 1), path)
    present = checkpoint.versions()
    monkeypatch.setattr(checkpoint, "versions", lambda: present | {"torch": "9.0"})
    with pytest.raises(TrainingError, match=r"with other versions: torch is .* and '9\.0' now$"):
        read_checkpoint(Trainer(plan, 1), path)


def test_tensors_that_do_not_fit_are_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    plan = short_plan(tmp_path)
    path = tmp_path / "checkpoint.safetensors"
    trainer = Trainer(plan, 1)
    trainer.replay.rows = trainer.replay.rows._replace(reward=torch.zeros(7))
    write_checkpoint(trainer, path)
    with pytest.raises(TrainingError, match=r"replay\.reward is torch\.float32 \(7,\)"):
        read_checkpoint(Trainer(plan, 1), path)


def test_a_folder_that_cannot_be_made(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(TrainingError, match="cannot create the folder"):
        RunFolder(tmp_path / "file" / "run")
