"""Draws the figures of README and docs from runs of the mock cell: python docs/make_figures.py."""

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

ROOT = Path(__file__).parents[1]
FIGURES = ROOT / "docs" / "figures"
SEED = 1


def run(controller: str, folder: Path) -> Log:
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


def main() -> None:
    """Write the figures."""
    FIGURES.mkdir(exist_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        expert, conventional = (run(name, Path(folder)) for name in ("expert", "p"))
        drawn = figures.insertion_figure(
            expert, summarise(expert).facts, [1], ["One insertion with the expert"]
        )
        (FIGURES / "insertion.svg").write_text(drawn, encoding="utf-8")
        summary = summarise(conventional)
        drawn = figures.failure_figure(conventional, summary, summary.insertions[-1])
        (FIGURES / "stop.svg").write_text(drawn, encoding="utf-8")


if __name__ == "__main__":
    main()
