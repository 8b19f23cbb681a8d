"""A log in a process of its own holds what a plain one holds; its writer outlives its sender."""

import contextlib
import os
import signal
import subprocess
import sys
import textwrap
import threading
import time
from pathlib import Path

import pytest

from drivers.contract.errors import LogError
from drivers.contract.messages import ForceSample
from hil.log_file import LogFile
from hil.log_process import LogProcess
from hil.log_reader import read_log
from hil.recorder import Recorder
from tests.hil.log import scenario

MS = 1_000_000
ZERO = (0.0,) * 6


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return tmp_path / "run.mcap"


def _writer_pid(log: LogProcess) -> int:
    pid = log._process.pid
    assert pid is not None
    return pid


def _sample(ms: int) -> ForceSample:
    return ForceSample(ms * MS, ms * MS, ms, ZERO)


def _record_samples(recorder: Recorder, milliseconds: int) -> None:
    for ms in range(milliseconds):
        recorder.on_sample(_sample(ms))


def test_both_kinds_hold_the_same(tmp_path: Path) -> None:
    logs = []
    for kind in (LogFile, LogProcess):
        path = tmp_path / kind.__name__
        recorder = Recorder(kind(path, scenario.METADATA))
        for call in scenario.calls(seed=5, milliseconds=500):
            call.make(recorder)
        recorder.close()
        logs.append(read_log(path))
    plain, sent = logs
    assert sent.complete
    assert sent.metadata == plain.metadata
    assert scenario.rows(sent) == scenario.rows(plain)
    assert plain.raw_force.sequences.size > 200


def test_what_is_flushed_comes_to_the_disk_without_more(path: Path) -> None:
    log = LogProcess(path, {})
    recorder = Recorder(log)
    recorder.on_sample(_sample(0))
    recorder.on_sample(_sample(1))
    log.flush()
    deadline_s = time.monotonic() + 10.0
    while read_log(path).raw_force.sequences.tolist() != [0, 1]:
        assert time.monotonic() < deadline_s
        time.sleep(0.01)
    recorder.close()


def test_a_writer_that_dies_is_an_error_and_leaves_what_it_had(path: Path) -> None:
    log = LogProcess(path, scenario.METADATA)
    recorder = Recorder(log)
    os.kill(_writer_pid(log), signal.SIGKILL)
    log._process.join()
    died = rf"the process that writes the log {path} has died"
    with pytest.raises(LogError, match=died):
        _record_samples(recorder, 2000)
    assert not log.usable
    with pytest.raises(LogError, match=died):
        recorder.on_sample(_sample(2000))
    recorder.close()
    assert read_log(path).metadata == scenario.METADATA


def test_a_writer_that_dies_before_the_end_is_an_error_at_the_end(path: Path) -> None:
    log = LogProcess(path, {})
    os.kill(_writer_pid(log), signal.SIGSTOP)
    log.write("/force/raw", b"", 0, 0)
    os.kill(_writer_pid(log), signal.SIGKILL)
    with pytest.raises(LogError, match="has died"):
        log.close()


def test_a_writer_that_stalls_holds_nobody_up(path: Path) -> None:
    """What it was sent it still writes once it goes on."""
    log = LogProcess(path, {}, patience_s=0.0)
    recorder = Recorder(log)
    writer = _writer_pid(log)
    os.kill(writer, signal.SIGSTOP)
    rescue = threading.Timer(20.0, os.kill, (writer, signal.SIGCONT))
    rescue.start()
    with pytest.raises(LogError, match="does not keep up"):
        _record_samples(recorder, 100_000)
    assert rescue.is_alive(), "the sender waited"
    rescue.cancel()
    recorder.close()
    os.kill(writer, signal.SIGCONT)
    log._let_go()
    held = read_log(path)
    assert held.complete
    sequences = held.raw_force.sequences.tolist()
    assert sequences == list(range(len(sequences)))
    assert len(sequences) > 400


def test_a_writer_that_stalls_for_good_is_left_behind(
    path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    log = LogProcess(path, {})
    writer = _writer_pid(log)
    os.kill(writer, signal.SIGSTOP)
    log.write("/force/raw", b"", 0, 0)
    monkeypatch.setattr("hil.log_process.PATIENCE_S", 0.1)
    with pytest.raises(LogError, match="does not answer"):
        log.close()
    assert not log._process.is_alive()
    assert read_log(path).raw_force.sequences.size == 0


INTERRUPTED_START = """
    import atexit, os, signal, sys
    from pathlib import Path
    from hil import log_process

    # A test run in the background of a shell has SIGINT ignored, and so would this one.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    register = atexit.register
    def register_under_a_signal(*arguments):
        os.kill(os.getpid(), signal.SIGINT)
        return register(*arguments)
    log_process.atexit.register = register_under_a_signal
    log_process.LogProcess(Path(sys.argv[1]), {})
"""


@pytest.mark.slow
def test_a_signal_while_the_writer_starts_ends_both(path: Path) -> None:
    command = [sys.executable, "-c", textwrap.dedent(INTERRUPTED_START), str(path)]
    process = subprocess.Popen(command, stderr=subprocess.PIPE, start_new_session=True)
    try:
        _, err = process.communicate(timeout=60.0)
    finally:
        with contextlib.suppress(ProcessLookupError):
            os.killpg(process.pid, signal.SIGKILL)
    assert b"KeyboardInterrupt" in err
    assert read_log(path).complete


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGTSTP])
def test_signals_to_the_whole_terminal_do_not_end_the_writer(
    path: Path, number: signal.Signals
) -> None:
    log = LogProcess(path, {})
    recorder = Recorder(log)
    os.kill(_writer_pid(log), number)
    _record_samples(recorder, 100)
    recorder.close()
    assert read_log(path).raw_force.sequences.tolist() == list(range(100))


SENDER = """
    import os, signal, sys
    from pathlib import Path
    from drivers.contract.messages import ForceSample
    from hil.log_process import LogProcess
    from hil.recorder import Recorder

    log = LogProcess(Path(sys.argv[1]), {})
    recorder = Recorder(log)
    for ms in range(100):
        recorder.on_sample(ForceSample(ms * 1_000_000, ms * 1_000_000, ms, (0.0,) * 6))
    log.flush()
    if sys.argv[2] == "killed":
        os.kill(os.getpid(), signal.SIGKILL)
"""


@pytest.mark.slow
@pytest.mark.parametrize("ending", ["killed", "exited"])
def test_the_writer_finishes_the_file_of_a_sender_that_is_gone(path: Path, ending: str) -> None:
    command = [sys.executable, "-W", "error", "-c", textwrap.dedent(SENDER), str(path), ending]
    done = subprocess.run(command, capture_output=True, timeout=60.0)
    assert done.stderr == b""
    assert done.returncode == (-signal.SIGKILL if ending == "killed" else 0)
    log = read_log(path)
    assert log.complete
    assert log.raw_force.sequences.tolist() == list(range(100))
