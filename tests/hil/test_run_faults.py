"""What goes wrong in and after a run is told in one line and in the exit code."""

import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
import typer

from drivers.contract.clock import ManualClock
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
