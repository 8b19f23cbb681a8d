"""The command, as its users call it."""

import re
import shutil
import time
from pathlib import Path

import pytest

from controllers.messages import SkillPhase
from hil.log_reader import read_log
from tests.hil.command import MOCK, ROOT, run

pytestmark = pytest.mark.slow


@pytest.mark.parametrize("controller", ["expert", "skill"])
def test_thirty_parts_are_inserted_within_the_papers_figures(
    tmp_path: Path, controller: str
) -> None:
    log = tmp_path / "run.mcap"
    code, out, err = run(
        *("--config", MOCK, "--insertions", "30", "--controller", controller),
        *("--seed", "1", "--log", str(log)),
    )
    assert (code, err) == (0, "")
    assert "30 of 30 inserted (100.0 %" in out
    assert log.with_suffix(".html").read_text().startswith("<!DOCTYPE html>")
    recorded = read_log(log)
    assert recorded.complete
    assert len(recorded.insertions) == 30
    last = {change.insertion: change for change in recorded.phases}
    assert all(c.phase is SkillPhase.DONE and c.steps <= 60 for c in last.values())
    within = []
    for insertion in recorded.insertions:
        force = recorded.trace(insertion).wrench[:, :3]
        assert (abs(force[:, :2]) <= 0.100).all()
        assert (force[:, 2] <= 0.090).all()
        within.append((abs(force) <= 0.044).mean())
    assert min(within) > 0.95


def test_a_stop_by_the_supervisor_ends_the_run_and_is_explained(tmp_path: Path) -> None:
    log = tmp_path / "run.mcap"
    code, out, _ = run(
        *("--config", MOCK, "--insertions", "30", "--controller", "p", "--seed", "2"),
        *("--part", "config/parts/paper_simulation.yaml", "--log", str(log)),
    )
    assert code == 1
    assert "which left the shaft in the part: force limit: f_" in " ".join(out.split())
    assert "force limit: f_" in log.with_suffix(".html").read_text()
    assert read_log(log).complete


def test_the_same_seed_writes_the_same_bytes(tmp_path: Path) -> None:
    logs = [tmp_path / "runs" / "monday" / f"{name}.mcap" for name in "abc"]
    for log, seed in zip(logs, ("3", "3", "4"), strict=True):
        code, _, err = run("--config", MOCK, "--seed", seed, "--log", str(log))
        assert (code, err) == (0, "")
    a, b, c = (log.read_bytes() for log in logs)
    assert a == b
    assert a != c


def patient_cell(folder: Path) -> Path:
    """The mock cell with limits on age that a busy machine can keep."""
    shutil.copytree(ROOT / "config", folder / "config")
    shutil.copytree(ROOT / "policies", folder / "policies")
    limits = folder / "config" / "limits.yaml"
    text = limits.read_text()
    for key in ("sample_age", "device_age", "proposal_age", "heartbeat"):
        text = re.sub(rf"^{key}_limit_ms: [0-9.]+", f"{key}_limit_ms: 1000", text, flags=re.M)
    limits.write_text(text)
    return folder / "config" / "mock_cell.yaml"


@pytest.mark.parametrize("controller", ["expert", "look_ahead"])
def test_in_real_time_the_same_command_inserts_a_part(tmp_path: Path, controller: str) -> None:
    log = tmp_path / "run.mcap"
    config = str(patient_cell(tmp_path))
    begin = time.monotonic()
    code, out, err = run(
        *("--config", config, "--controller", controller, "--log", str(log), "--real-time")
    )
    took_s = time.monotonic() - begin
    assert (code, err) == (0, ""), out
    stamps = read_log(log).raw_force.stamps_ns
    recorded_s = (stamps[-1] - stamps[0]) * 1e-9
    assert 5.0 < recorded_s < took_s


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("--config", "config/nowhere.yaml"), "error: config/nowhere.yaml: cannot be read"),
        (
            ("--controller", "ddpg"),
            "error: controller 'ddpg' is not valid: one of expert, extended, look_ahead, p, "
            "skill is",
        ),
        (("--part", "config/limits.yaml"), "error: config/limits.yaml: "),
        (("--log", "Makefile/r.mcap"), "error: cannot create the folder Makefile: File exists"),
        (("--log", "runs/a.html"), "error: the log runs/a.html is not valid: its name must end"),
        (("--log", "runs/r.1"), "error: the log runs/r.1 is not valid: its name must end in .mcap"),
    ],
)
def test_unusable_input_ends_before_anything_moves(
    tmp_path: Path, arguments: tuple[str, ...], message: str
) -> None:
    log = tmp_path / "run.mcap"
    code, out, err = run("--config", MOCK, "--log", str(log), *arguments)
    assert code == 2
    assert out == ""
    assert err.startswith(message)
    assert not log.exists()


def test_a_log_is_never_overwritten(tmp_path: Path) -> None:
    log = tmp_path / "run.mcap"
    log.write_text("precious")
    code, _, err = run("--config", MOCK, "--log", str(log))
    assert code == 2
    assert err.startswith(f"error: {log} exists and a log is never overwritten")
    assert log.read_text() == "precious"


@pytest.mark.parametrize("insertions", ["0", "-1", "many"])
def test_a_number_of_insertions_that_is_none(tmp_path: Path, insertions: str) -> None:
    log = str(tmp_path / "run.mcap")
    code, _, err = run("--config", MOCK, "--log", log, "--insertions", insertions)
    assert code == 2
    assert "--insertions" in err


def test_help_explains_itself() -> None:
    code, out, _ = run("--help")
    assert code == 0
    for word in ("--config", "--insertions", "--controller", "--seed", "--log", "--real-time"):
        assert word in out
    assert "Exit code: 0 every part inserted" in out
