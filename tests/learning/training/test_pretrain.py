"""The command in a process of its own: killed, started again, interrupted, misused."""

import os
import signal
import subprocess
import sys
import time
from functools import partial
from pathlib import Path

import pytest
from safetensors.numpy import load_file
from tensorboard.backend.event_processing.event_accumulator import EventAccumulator

from learning.policy.file import read_policy
from tests.learning.training.plans import short_file

COMMAND = "learning/pretrain.py"
PATIENCE_S = 120.0


def start(config: Path, out: Path, seed: int = 1) -> "subprocess.Popen[str]":
    options = ["--config", str(config), "--out", str(out), "--seed", str(seed)]
    return subprocess.Popen(
        [sys.executable, COMMAND, *options],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env=os.environ | {"PYTHONPATH": ".", "COLUMNS": "200"},
        # A test run in the background of a shell has Ctrl-C ignored, and so would this one.
        preexec_fn=partial(signal.signal, signal.SIGINT, signal.SIG_DFL),
    )


def run(config: Path, out: Path, seed: int = 1) -> tuple[int, str, str]:
    with start(config, out, seed) as process:
        output, errors = process.communicate(timeout=PATIENCE_S)
    return process.returncode, output, errors


def wait_for(pattern: str, out: Path) -> None:
    deadline = time.monotonic() + PATIENCE_S
    while not [*out.glob(pattern)]:
        if time.monotonic() > deadline:
            raise TimeoutError(f"{pattern} did not appear in {out}")
        time.sleep(0.01)


@pytest.mark.slow
def test_killed_and_started_again_it_ends_at_the_same_policy(tmp_path: Path) -> None:
    config = short_file(tmp_path, rounds=30, checkpoint_rounds=3)
    code, output, errors = run(config, tmp_path / "whole")
    assert code == 0, errors
    assert "Inserted 10 of 10" in output

    out = tmp_path / "killed"
    with start(config, out) as process:
        wait_for("checkpoints/round-00000006.safetensors", out)
        process.send_signal(signal.SIGKILL)
        process.communicate(timeout=PATIENCE_S)
    assert process.returncode == -signal.SIGKILL
    assert not (out / "policy.safetensors").exists()

    code, output, errors = run(config, out)
    assert code == 0, errors
    assert "Goes on after round " in output
    for name in ("policy.safetensors", "policy.onnx"):
        assert (out / name).read_bytes() == (tmp_path / "whole" / name).read_bytes()
    for folder in ("whole", "killed"):
        scalars = EventAccumulator(str(tmp_path / folder / "tensorboard")).Reload()
        steps = [event.step for event in scalars.Scalars("round/steps")]
        assert steps == [*range(1, 31)]
    last = "checkpoints/round-00000030.safetensors"
    assert (out / last).read_bytes() == (tmp_path / "whole" / last).read_bytes()


@pytest.mark.slow
def test_what_it_writes(tmp_path: Path) -> None:
    config = short_file(tmp_path, rounds=3)
    out = tmp_path / "run"
    code, _, errors = run(config, out, seed=5)
    assert code == 0, errors
    stored = read_policy(out / "policy.safetensors")
    about = stored.manifest.about
    assert about["seed"] == 5
    assert about["rounds"] == 3
    metrics = about["metrics"]
    assert isinstance(metrics, dict)
    assert metrics["insertions"] == 10
    checkpoint = load_file(out / "checkpoints/round-00000003.safetensors")
    for number, layer in enumerate(stored.policy.layers):
        assert (layer.weight == checkpoint[f"actor.layers.{number}.weight"]).all()
        assert (layer.bias == checkpoint[f"actor.layers.{number}.bias"]).all()
    assert [*(out / "tensorboard").glob("events.out.tfevents.*")]

    code, _, errors = run(config, out, seed=6)
    assert code == 2
    assert "is of seed 5, not of 6" in errors
    assert "Traceback" not in errors


@pytest.mark.slow
def test_ctrl_c_leaves_a_training_that_goes_on(tmp_path: Path) -> None:
    config = short_file(tmp_path, rounds=60, checkpoint_rounds=2)
    out = tmp_path / "run"
    with start(config, out) as process:
        wait_for("checkpoints/round-00000002.safetensors", out)
        process.send_signal(signal.SIGINT)
        _, errors = process.communicate(timeout=PATIENCE_S)
    assert process.returncode == 130
    assert "Traceback" not in errors
    code, output, errors = run(config, out)
    assert code == 0, errors
    assert "Goes on after round " in output


@pytest.mark.slow
def test_a_file_that_cannot_be_used(tmp_path: Path) -> None:
    code, _, errors = run(tmp_path / "none.yaml", tmp_path / "run")
    assert code == 2
    assert errors == f"error: {tmp_path / 'none.yaml'}: cannot be read: No such file or directory\n"
    assert not (tmp_path / "run").exists()
