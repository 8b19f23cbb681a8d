from pathlib import Path

import pytest

from hil.log_file import LogFile
from hil.recorder import Recorder
from tests.hil.log import node_reader, scenario


@pytest.fixture(scope="session")
def node_folder() -> Path:
    """Where the log reader for web viewers is installed."""
    return node_reader.install()


@pytest.fixture(scope="session")
def finished_log(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A log with every kind of message, closed by its recorder."""
    path = tmp_path_factory.mktemp("finished") / "run.mcap"
    recorder = Recorder(LogFile(path, scenario.METADATA))
    for call in scenario.calls(seed=1, milliseconds=1000):
        call.make(recorder)
    recorder.close()
    return path
