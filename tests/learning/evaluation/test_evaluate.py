"""The command as a user runs it."""

import csv
import os
import subprocess
import sys
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
from tensorboard.compat.proto.event_pb2 import Event
from tensorboard.compat.proto.summary_pb2 import Summary
from tensorboard.summary.writer.event_file_writer import EventFileWriter

from drivers.contract.errors import TrainingError
from learning.evaluation.training_log import read_training_log
from tests.learning.evaluation.records import FILE, ROOT

TAGS = (
    "round/success",
    "round/steps",
    "round/reward_per_step",
    "round/peak_radial_force_mN",
)


def evaluate(*arguments: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "learning/evaluate.py", *arguments],
        cwd=ROOT,
        env={**os.environ, "PYTHONPATH": str(ROOT), "COLUMNS": "80"},
        capture_output=True,
        text=True,
        check=False,
    )


def write_training(folder: Path, tags: tuple[str, ...] = TAGS, rounds: int = 30) -> None:
    writer = EventFileWriter(str(folder / "tensorboard"))
    for number in range(1, rounds + 1):
        for tag in tags:
            value = Summary.Value(tag=tag, simple_value=float(number % 2))
            writer.add_event(Event(step=number, summary=Summary(value=[value])))
    writer.close()


@pytest.mark.slow
def test_end_to_end(tmp_path: Path) -> None:
    path, training = tmp_path / "small.yaml", tmp_path / "training"
    path.write_text(FILE, encoding="utf-8")
    write_training(training)
    common = ("--config", str(path), "--training", str(training), "--out")
    first = evaluate(*common, str(tmp_path / "a"), "--processes", "1")
    assert first.returncode == 0, first.stderr
    second = evaluate(*common, str(tmp_path / "b"), "--processes", "2")
    assert second.returncode == 0, second.stderr
    written = sorted(file.name for file in (tmp_path / "a").iterdir())
    assert written == [
        "by-depth.svg",
        "distribution.svg",
        "index.html",
        "insertion.svg",
        "insertions.csv",
        "learning-curve.svg",
        "results.csv",
    ]
    for name in written:
        one, other = ((tmp_path / run / name).read_bytes() for run in "ab")
        assert one == other, f"{name} depends on the number of processes"
        if not name.endswith(".csv"):
            ElementTree.fromstring(one.decode())  # noqa: S314, our own file

    with (tmp_path / "a/results.csv").open(encoding="utf-8", newline="") as file:
        rows = {row["controller"]: row for row in csv.DictReader(file)}
    assert rows["tuned"]["parameters"].startswith("gain ")
    assert float(rows["bound"]["radial_mean_mN"]) < float(rows["tuned"]["radial_mean_mN"])
    assert rows["tuned"]["gap_closed_radial_mean_percent"] == ""
    assert float(rows["privileged"]["gap_closed_radial_mean_percent"]) > 50.0
    with (tmp_path / "a/insertions.csv").open(encoding="utf-8", newline="") as file:
        insertions = [row for row in csv.DictReader(file) if row["controller"] == "mild"]
    mean = np.mean([float(row["radial_mean_mN"]) for row in insertions])
    assert float(rows["mild"]["radial_mean_mN"]) == pytest.approx(mean, rel=1e-4)
    assert len(insertions) == 4
    shown = {line.split()[0]: line.split() for line in first.stdout.splitlines() if line.split()}
    assert len(shown["look_ahead"]) == len(shown["skill"]) == 10
    assert shown["look_ahead"][1] == f"{rows['look_ahead']['successes']}/4"
    assert shown["skill"][8] == f"{float(rows['skill']['gap_closed_radial_mean_percent']):.0f}"


@pytest.mark.slow
def test_a_bad_file_ends_with_one_line(tmp_path: Path) -> None:
    result = evaluate("--config", str(tmp_path / "none.yaml"), "--out", str(tmp_path / "out"))
    assert result.returncode == 2
    expected = f"error: {tmp_path}/none.yaml: cannot be read: No such file or directory\n"
    assert result.stderr == expected
    assert not (tmp_path / "out").exists()


def test_the_last_value_of_a_round_counts(tmp_path: Path) -> None:
    write_training(tmp_path, rounds=4)
    again = EventFileWriter(str(tmp_path / "tensorboard"), filename_suffix=".again")
    for step in (4, 5):
        for tag in TAGS:
            value = Summary.Value(tag=tag, simple_value=7.0)
            again.add_event(Event(step=step, summary=Summary(value=[value])))
    again.close()
    assert read_training_log(tmp_path).steps.tolist() == [1.0, 0.0, 1.0, 7.0, 7.0]


def test_folders_that_are_no_training(tmp_path: Path) -> None:
    with pytest.raises(TrainingError, match="holds no folder tensorboard"):
        read_training_log(tmp_path)
    write_training(tmp_path, TAGS[:2])
    with pytest.raises(TrainingError, match=r"holds no round/reward_per_step, round/peak"):
        read_training_log(tmp_path)
