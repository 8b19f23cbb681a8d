"""What a killed run leaves: everything that the recorder was told up to 100 ms before the end."""

import random
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

import pytest

from hil.log_file import LogFile
from hil.log_reader import read_log
from hil.recorder import Recorder
from tests.hil.log import node_reader, scenario

pytestmark = pytest.mark.slow

LOSS_NS = 100_000_000
RUN_MS = 3000
LATEST_KILL_S = 0.9
"""A killer that is late still finds the run going."""
KILLS = 24
SEED = 20240229

Rows = dict[str, list[tuple[int, object]]]


@dataclass(frozen=True)
class Killed:
    """A log whose writer was killed, and the time of the last call that the writer had begun."""

    path: Path
    told_ns: int


@pytest.fixture(scope="module")
def reference(tmp_path_factory: pytest.TempPathFactory) -> Rows:
    """What the log holds where nobody kills the writer."""
    path = tmp_path_factory.mktemp("reference") / "run.mcap"
    recorder = Recorder(LogFile(path, scenario.METADATA))
    for call in scenario.calls(SEED, RUN_MS):
        call.make(recorder)
    recorder.close()
    return scenario.rows(read_log(path))


@pytest.fixture(scope="module")
def killed(tmp_path_factory: pytest.TempPathFactory) -> list[Killed]:
    """Logs of writers that were killed at random moments."""
    folder = tmp_path_factory.mktemp("killed")
    rng = random.Random(SEED)  # noqa: S311, no secret
    moments_s = [rng.uniform(0.0, LATEST_KILL_S) for _ in range(KILLS)]
    arguments = [str(folder), str(SEED), str(RUN_MS), *map(str, moments_s)]
    subprocess.run([sys.executable, "-m", "tests.hil.log.killed_writers", *arguments], check=True)
    return [
        Killed(
            path=folder / f"{number}.mcap",
            told_ns=int.from_bytes((folder / f"{number}.told").read_bytes()[-8:], "little"),
        )
        for number in range(KILLS)
    ]


def _check_kept(held: Rows, reference: Rows, told_ns: int) -> None:
    for name, expected in reference.items():
        rows = held[name]
        assert rows == expected[: len(rows)], f"{name} differs from the undisturbed run's"
        missing_ns = [time_ns for time_ns, _ in expected[len(rows) :] if time_ns <= told_ns]
        lost_ns = max((told_ns - time_ns for time_ns in missing_ns), default=0)
        assert lost_ns <= LOSS_NS, f"{name} lacks the last {lost_ns / 1e6} ms"


def test_a_killed_writer_loses_100_ms_at_most(killed: list[Killed], reference: Rows) -> None:
    for run in killed:
        log = read_log(run.path)
        assert not log.complete
        assert log.metadata == scenario.METADATA
        _check_kept(scenario.rows(log), reference, run.told_ns)


def test_viewers_read_of_a_killed_run_what_we_read(killed: list[Killed], node_folder: Path) -> None:
    found = node_reader.read(node_folder, "stream", [run.path for run in killed])
    for run in killed:
        raw = read_log(run.path).raw_force
        assert not found[run.path].complete
        assert [stamp for stamp, _ in found[run.path].raw_force] == raw.stamps_ns.tolist()


def test_no_call_leaves_more_than_100_ms_off_the_disk(tmp_path: Path, reference: Rows) -> None:
    """A kill between two calls, or within a write, leaves what the file held after some call."""
    path = tmp_path / "run.mcap"
    recorder = Recorder(LogFile(path, scenario.METADATA))
    latest_with_size = {}
    size = path.stat().st_size
    for call in scenario.calls(SEED, RUN_MS):
        latest_with_size[size] = call.time_ns
        call.make(recorder)
        size = path.stat().st_size
    recorder.close()
    content = path.read_bytes()
    assert len(latest_with_size) > 10
    for size, told_ns in latest_with_size.items():
        cut = tmp_path / "cut.mcap"
        cut.write_bytes(content[:size])
        _check_kept(scenario.rows(read_log(cut)), reference, told_ns)
