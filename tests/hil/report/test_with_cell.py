"""A real insertion on the mock cell agrees with its summary."""

from pathlib import Path

import numpy as np
import pytest

from controllers.messages import SkillPhase
from drivers.contract.clock import ManualClock
from hil.cell import Cell
from hil.config import load_cell
from hil.log_file import LogFile
from hil.log_reader import read_log
from hil.metadata import metadata
from hil.recorder import Recorder
from hil.summary import Outcome, summarise
from tests.hil.report.page import report

CELL = Path(__file__).parents[3] / "config" / "mock_cell.yaml"


@pytest.mark.slow
def test_summary_and_report_of_one_insertion(tmp_path: Path) -> None:
    config = load_cell(CELL)
    cell = Cell(config, "expert", ManualClock(), np.random.default_rng(1))
    path = tmp_path / "run.mcap"
    recorder = Recorder(LogFile(path, metadata(config, "expert", 1, 1, real_time=False)))
    cell.follow(recorder)
    cell.connect()
    outcome = cell.insert_part(1)
    cell.close()
    recorder.close()

    log = read_log(path)
    summary = summarise(log)
    (insertion,) = summary.insertions
    assert outcome.phase is SkillPhase.DONE
    assert insertion.outcome is Outcome.DONE
    assert insertion.steps == outcome.steps
    assert insertion.deepest_m == pytest.approx(3200e-6, abs=1e-6)
    assert insertion.forces is not None
    assert 0.0 < insertion.forces.radial.peak_N < 0.07
    assert summary.facts.walls_m == (
        (0.0, pytest.approx(500e-6)),
        (pytest.approx(3000e-6), pytest.approx(3500e-6)),
    )
    page = report(log, tmp_path)
    assert page.banner == []
    assert "1 of 1 inserted" in page.text
