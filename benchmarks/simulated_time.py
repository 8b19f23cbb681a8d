"""How much faster than real time the mock cell runs, with everything logged.

python benchmarks/simulated_time.py [insertions]
"""

import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from machine import describe

from controllers.messages import SkillPhase
from drivers.contract.clock import ManualClock
from hil.cell import Cell
from hil.config import load_cell
from hil.log_process import LogProcess
from hil.metadata import metadata
from hil.recorder import Recorder

CELL = Path(__file__).parents[1] / "config" / "mock_cell.yaml"


def main(insertions: int) -> None:
    config = load_cell(CELL)
    clock = ManualClock()
    cell = Cell(config, "expert", clock, np.random.default_rng(1))
    with tempfile.TemporaryDirectory() as folder:
        log = Path(folder) / "run.mcap"
        recorder = Recorder(LogProcess(log, metadata(config, "expert", insertions, 1, False)))
        cell.follow(recorder)
        begin = time.perf_counter()
        cell.connect()
        phases = [cell.insert_part(number).phase for number in range(1, insertions + 1)]
        cell.close()
        recorder.close()
        wall_s = time.perf_counter() - begin
        size_MB = log.stat().st_size / 1e6
    simulated_s = clock.now_ns() * 1e-9
    ticks = simulated_s * config.force_sensor.settings.rate_Hz
    print(describe())
    print(f"inserted {phases.count(SkillPhase.DONE)} of {insertions}, log of {size_MB:.1f} MB")
    print(
        f"simulated {simulated_s:.1f} s in {wall_s:.2f} s: {simulated_s / wall_s:.1f} x real time"
    )
    print(f"{wall_s / ticks * 1e6:.1f} us per tick")


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 30)
