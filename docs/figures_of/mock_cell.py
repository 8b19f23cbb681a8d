"""Runs of the mock cell: one insertion with the expert, and a stop of the P-controller."""

import tempfile
from pathlib import Path

import numpy as np

from drivers.contract.clock import ManualClock
from hil import figures
from hil.cell import Cell
from hil.config import load_cell
from hil.log_file import LogFile
from hil.log_reader import Log, read_log
from hil.metadata import metadata
from hil.recorder import Recorder
from hil.summary import summarise
from hil.truth_probe import TruthProbe

ROOT = Path(__file__).parents[2]
SEED = 1


def draw_insertion() -> str:
    """Draw the forces along one insertion with the expert."""
    with tempfile.TemporaryDirectory() as folder:
        log = _run("expert", Path(folder))
        facts = summarise(log).facts
        return figures.insertion_figure(log, facts, [1], ["One insertion with the expert"])


def draw_stop() -> str:
    """Draw the insertion in which the supervisor stops the P-controller."""
    with tempfile.TemporaryDirectory() as folder:
        log = _run("p", Path(folder))
        summary = summarise(log)
        return figures.failure_figure(log, summary, summary.insertions[-1])


def _run(controller: str, folder: Path) -> Log:
    """Insert parts of the paper's simulation until one is done (expert) or stopped (p)."""
    config = load_cell(
        ROOT / "config" / "mock_cell.yaml", ROOT / "config" / "parts" / "paper_simulation.yaml"
    )
    path = folder / f"{controller}.mcap"
    cell = Cell(config, controller, ManualClock(), np.random.default_rng(SEED))
    recorder = Recorder(LogFile(path, metadata(config, controller, 1, SEED, False)))
    cell.follow(recorder)
    cell.follow(TruthProbe(cell.world, recorder))
    cell.connect()
    number = 1
    while cell.insert_part(number).is_clear and controller == "p":
        number += 1
    cell.close()
    recorder.close()
    return read_log(path)
