from collections.abc import Callable
from pathlib import Path

import pytest

from drivers.contract.messages import Vector3
from tests.hil.report.runs import RunWriter, metadata


@pytest.fixture
def write_run(tmp_path: Path) -> Callable[..., RunWriter]:
    """Begin logs, each in a file of its own."""
    count = 0

    def begin(
        bias_mN: Vector3 = (0.0, 0.0, 0.0), busy_ns: int = 0, name: str = "", **about: object
    ) -> RunWriter:
        nonlocal count
        count += 1
        path = tmp_path / (name or f"run{count}.mcap")
        return RunWriter(path, metadata(**about), bias_mN, busy_ns)  # type: ignore[arg-type]  # any of its arguments

    return begin
