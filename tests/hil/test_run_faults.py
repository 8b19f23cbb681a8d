"""What goes wrong in and after a run is told in one line and in the exit code."""

import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
import typer

from controllers.control_loop import ControlLoop
from drivers.contract.clock import ManualClock
from drivers.contract.errors import DeviceError
from drivers.contract.messages import ForceSample, Pose, SensorStatus
from drivers.force_sensor.mock import MockForceSensor
from drivers.stage.mock import MockStage
from hil.cell import Cell
from hil.log_reader import read_log
from hil.run_cell import run_cell

ROOT = Path(__file__).parents[2]
MOCK = ROOT / "config" / "mock_cell.yaml"

pytestmark = pytest.mark.slow


@pytest.fixture
def log(tmp_path: Path) -> Path:
    return tmp_path / "run.mcap"


def run(log: Path, insertions: int = 1) -> int:
    """Return the exit code of the command, run in this process."""
    with pytest.raises(typer.Exit) as caught:
        run_cell(MOCK, log, insertions)
    return caught.value.exit_code


def at_ms(time_ms: int, monkeypatch: pytest.MonkeyPatch, act: Callable[[], None]) -> None:
    """Do something once simulated time has come so far."""
    sleep = ManualClock.sleep_until_ns
    waiting = [act]

    def sleep_and_act(clock: ManualClock, time_ns: int) -> None:
        sleep(clock, time_ns)
        if waiting and clock.now_ns() >= time_ms * 1_000_000:
            waiting.pop()()

    monkeypatch.setattr(ManualClock, "sleep_until_ns", sleep_and_act)


def test_a_report_that_cannot_be_written(log: Path, capsys: pytest.CaptureFixture[str]) -> None:
    page = log.with_suffix(".html")
    page.mkdir()
    assert run(log) == 3
    assert capsys.readouterr().err == f"error: cannot write the report {page}: Is a directory\n"
    assert read_log(log).complete
    assert sorted(log.parent.iterdir()) == [page, log]


def test_a_log_that_is_gone_after_the_run(
    log: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    at_ms(500, monkeypatch, log.unlink)
    assert run(log) == 3
    expected = f"error: cannot read the log {log}: No such file or directory\n"
    assert capsys.readouterr().err == expected


def test_nobody_listens_to_the_run(log: Path) -> None:
    """As with `| head -1`: log and page are whole all the same."""
    reader, writer = os.pipe()
    os.close(reader)
    arguments = ["hil/run_cell.py", "--config", str(MOCK), "--log", str(log)]
    with os.fdopen(writer, "wb") as stdout:
        done = subprocess.run(
            [sys.executable, *arguments],
            cwd=ROOT,
            stdout=stdout,
            stderr=subprocess.PIPE,
            text=True,
            check=False,
        )
    assert done.stderr == "error: cannot write to standard output: Broken pipe\n"
    assert done.returncode == 3
    assert read_log(log).complete
    assert log.with_suffix(".html").read_text().endswith("</html>")


def test_a_stop_while_the_last_part_is_withdrawn(
    log: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """The part is inserted, but the shaft stays in it: no success."""
    withdraw, read = ControlLoop.withdraw, MockForceSensor.read

    def read_fault(sensor: MockForceSensor, timeout_s: float) -> ForceSample:
        return read(sensor, timeout_s)._replace(status=SensorStatus.FAULT)

    def withdraw_with_fault(loop: ControlLoop, start: Pose) -> bool:
        monkeypatch.setattr(MockForceSensor, "read", read_fault)
        return withdraw(loop, start)

    monkeypatch.setattr(ControlLoop, "withdraw", withdraw_with_fault)
    assert run(log) == 1
    ending = (
        "The run ended with insertion 1, which left the shaft in the part: force sensor status: "
    )
    assert ending in " ".join(capsys.readouterr().out.split())
    assert read_log(log).metadata["ending"]["text"].startswith(ending)


def test_a_stop_while_the_last_part_is_taken_away(
    log: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """The shaft is out, but a latched stop is no success."""
    move_arm, read = Cell._move_arm, MockForceSensor.read
    targets: list[Pose] = []

    def read_fault(sensor: MockForceSensor, timeout_s: float) -> ForceSample:
        return read(sensor, timeout_s)._replace(status=SensorStatus.FAULT)

    def move_then_fault(cell: Cell, target: Pose) -> None:
        move_arm(cell, target)
        targets.append(target)
        if len(targets) == 2:
            monkeypatch.setattr(MockForceSensor, "read", read_fault)
            cell._loop.tick()

    monkeypatch.setattr(Cell, "_move_arm", move_then_fault)
    assert run(log) == 3
    said = " ".join(capsys.readouterr().out.split())
    assert "The run ended by a fault: force sensor status: " in said


def test_a_device_that_cannot_be_reached(
    log: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(stage: MockStage) -> None:
        raise DeviceError("the stage at port 7 does not answer")

    closed: list[str] = []
    monkeypatch.setattr(MockStage, "connect", fail)
    for kind in (MockForceSensor, MockStage):
        monkeypatch.setattr(kind, "close", lambda device: closed.append(type(device).__name__))
    assert run(log) == 3
    expected = "The run ended by a fault: the stage at port 7 does not answer."
    assert expected in " ".join(capsys.readouterr().out.split())
    assert closed == ["MockStage", "MockForceSensor"]
