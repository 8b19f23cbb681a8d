"""Signals to the running command, as terminals and service managers send them."""

import os
import signal
import subprocess
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

import pytest

from hil.log_reader import read_log
from tests.hil.command import MOCK, start

pytestmark = pytest.mark.slow

LONGEST_S = 120.0


@contextmanager
def running(log: Path, *arguments: str) -> Iterator[subprocess.Popen[str]]:
    """A run in a process group of its own that has begun to insert; nothing of it stays behind."""
    process = start("--config", MOCK, "--insertions", "1000", "--log", str(log), *arguments)
    try:
        deadline_s = time.monotonic() + LONGEST_S
        while not log.exists() or log.stat().st_size < 30_000:
            assert process.poll() is None
            assert time.monotonic() < deadline_s
            time.sleep(0.02)
        yield process
    finally:
        with suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGKILL)
        process.communicate()


@pytest.mark.parametrize(
    ("number", "code"),
    [(signal.SIGINT, 130), (signal.SIGTERM, 143), (signal.SIGHUP, 129), (signal.SIGTSTP, 148)],
)
def test_a_signal_to_all_holds_the_cell_and_finishes_the_file(
    tmp_path: Path, number: signal.Signals, code: int
) -> None:
    log = tmp_path / "run.mcap"
    with running(log) as process:
        os.killpg(process.pid, number)
        out, err = process.communicate(timeout=LONGEST_S)
    assert (process.returncode, err) == (code, "")
    ending = f"The run was interrupted by {number.name}; the cell is held."
    assert " ".join(out.split()).count(ending) == 1
    assert ending in log.with_suffix(".html").read_text()
    recorded = read_log(log)
    assert recorded.metadata["ending"] == {"text": ending}
    assert recorded.complete
    assert (recorded.stage_twist.velocity[-1] == 0.0).all()


def test_an_impatient_user_gets_the_report_all_the_same(tmp_path: Path) -> None:
    log = tmp_path / "run.mcap"
    page = log.with_suffix(".html")
    with running(log) as process:
        while process.poll() is None and not page.exists():
            with suppress(ProcessLookupError):
                os.killpg(process.pid, signal.SIGINT)
            time.sleep(0.01)
        _, err = process.communicate(timeout=LONGEST_S)
    assert (process.returncode, err) == (130, "")
    assert page.read_text().endswith("</html>")
    assert read_log(log).complete


def test_a_run_whose_log_writer_stalls_ends_by_itself(tmp_path: Path) -> None:
    log = tmp_path / "run.mcap"
    with running(log, "--real-time") as process:
        children = Path(f"/proc/{process.pid}/task/{process.pid}/children")
        (writer,) = map(int, children.read_text().split())
        os.kill(writer, signal.SIGSTOP)
        assert process.stdout is not None
        assert any("does not keep up" in line for line in process.stdout)
        os.kill(writer, signal.SIGCONT)
        _, err = process.communicate(timeout=LONGEST_S)
    assert (process.returncode, err) == (3, "")
    assert read_log(log).complete
