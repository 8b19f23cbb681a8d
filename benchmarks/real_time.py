"""What one tick of the cell takes in real time at 1 kHz, with everything logged.

python benchmarks/real_time.py [seconds]
"""

import sys
import tempfile
import time
from pathlib import Path

import numpy as np
from machine import describe

from controllers.control_loop import Subscriber
from controllers.messages import Tick
from drivers.contract.clock import SystemClock
from drivers.contract.errors import TenonError
from drivers.contract.messages import ForceSample
from hil.cell import Cell
from hil.config import load_cell
from hil.log_process import LogProcess
from hil.metadata import metadata
from hil.recorder import Recorder

CELL = Path(__file__).parents[1] / "config" / "mock_cell.yaml"


REFERENCE_LOOPS = 1500


class TimeIsUpError(TenonError):
    """The benchmark has run for as long as it should."""


class Stopwatch(Subscriber):
    """Notes how long each tick takes and how late each sample is read."""

    def __init__(self, samples: int) -> None:
        self._samples = samples
        self.tick_ns: list[int] = []
        self.late_ns: list[int] = []

    def on_sample(self, sample: ForceSample) -> None:
        self.late_ns.append(sample.receipt_ns - sample.stamp_ns)

    def on_tick(self, tick: Tick) -> None:
        self.tick_ns.append(tick.end_ns - tick.start_ns)
        if len(self.tick_ns) >= self._samples:
            raise TimeIsUpError


def reference_us(seconds: float, rate_Hz: float) -> list[float]:
    """Return how long some arithmetic takes at the same pace: the jitter of the machine."""
    durations, due_s = [], time.perf_counter()
    for _ in range(round(seconds * rate_Hz)):
        due_s += 1.0 / rate_Hz
        time.sleep(max(0.0, due_s - time.perf_counter()))
        begin_s, total = time.perf_counter(), 0
        for number in range(REFERENCE_LOOPS):
            total += number
        durations.append((time.perf_counter() - begin_s) * 1e6)
    return durations


def main(seconds: float) -> None:
    config = load_cell(CELL)
    rate_Hz = config.force_sensor.settings.rate_Hz
    cell = Cell(config, "expert", SystemClock(), np.random.default_rng(1))
    stopwatch = Stopwatch(round(seconds * rate_Hz))
    with tempfile.TemporaryDirectory() as folder:
        recorder = Recorder(
            LogProcess(
                Path(folder) / "run.mcap",
                metadata(config, "expert", 1, 1, True),
                patience_s=0.0,
            )
        )
        cell.follow(recorder)
        cell.follow(stopwatch)
        cell.connect()
        inserted = 0
        try:
            while True:
                cell.insert_part(inserted + 1)
                inserted += 1
        except TimeIsUpError:
            cell.close()
            recorder.close()
    tick_us = np.array(stopwatch.tick_ns) * 1e-3
    late_us = np.array(stopwatch.late_ns) * 1e-3
    missed = int(np.count_nonzero(late_us > 1e6 / rate_Hz))
    print(describe())
    print(f"{len(tick_us)} ticks at {rate_Hz:g} Hz in real time, {inserted} parts inserted")
    idle_us = np.array(reference_us(min(seconds, 10.0), rate_Hz))
    for name, values in (
        ("sample to verdict", tick_us),
        ("sample read after", late_us),
        (f"for comparison, {REFERENCE_LOOPS} additions", idle_us),
    ):
        p50, p99 = np.percentile(values, [50, 99])
        print(f"{name}: p50 {p50:.0f} us, p99 {p99:.0f} us, max {values.max():.0f} us")
    print(f"samples read later than one period: {missed}")


if __name__ == "__main__":
    main(float(sys.argv[1]) if len(sys.argv) > 1 else 60.0)
