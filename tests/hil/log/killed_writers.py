"""Records the same run again and again, each time until recorder and log writer are killed.

    python -m tests.hil.log.killed_writers FOLDER SEED MILLISECONDS SECONDS...

For the N-th of SECONDS a process records at the pace of the host's clock into `N.mcap`, through a
log writer in a process of its own; so long after the first call both are killed. Before each call
of the recorder it adds the time to `N.told`.
"""

import os
import signal
import sys
import time
from collections.abc import Sequence
from pathlib import Path

from hil.log_process import LogProcess
from hil.recorder import Recorder
from tests.hil.log import scenario

AT_ONCE = 8


def record(stem: Path, calls: Sequence[scenario.Call]) -> None:
    """Tell a recorder the calls, each when it is due."""
    recorder = Recorder(LogProcess(stem.with_suffix(".mcap"), scenario.METADATA))
    with stem.with_suffix(".told").open("wb", buffering=0) as told:
        start_ns = time.monotonic_ns()
        for call in calls:
            wait_ns = (call.time_ns - scenario.START_NS) - (time.monotonic_ns() - start_ns)
            time.sleep(max(wait_ns, 0) * 1e-9)
            told.write(call.time_ns.to_bytes(8, "little"))
            call.make(recorder)


def start(stem: Path, calls: Sequence[scenario.Call]) -> int:
    """Return the process that records, which leads a group of its own."""
    process = os.fork()
    if process == 0:
        os.setpgid(0, 0)
        try:
            record(stem, calls)
        finally:
            os._exit(1)
    return process


def kill(process: int, stem: Path, until_s: float) -> None:
    """Kill the process and its log writer at a time of the monotonic clock."""
    time.sleep(max(until_s - time.monotonic(), 0.0))
    os.killpg(process, signal.SIGKILL)
    _, status = os.waitpid(process, 0)
    if not os.WIFSIGNALED(status):
        sys.exit(f"the run in {stem} was over before the kill")


def main(folder: Path, seed: int, milliseconds: int, moments_s: Sequence[float]) -> None:
    """Record and kill, some at once."""
    calls = list(scenario.calls(seed, milliseconds))
    plans = [(moment_s, folder / str(number)) for number, moment_s in enumerate(moments_s)]
    for first in range(0, len(plans), AT_ONCE):
        batch = sorted(plans[first : first + AT_ONCE])
        processes = [start(stem, calls) for _, stem in batch]
        while not all(stem.with_suffix(".told").exists() for _, stem in batch):
            time.sleep(0.001)
        start_s = time.monotonic()
        for process, (moment_s, stem) in zip(processes, batch, strict=True):
            kill(process, stem, start_s + moment_s)


if __name__ == "__main__":
    main(Path(sys.argv[1]), int(sys.argv[2]), int(sys.argv[3]), [float(a) for a in sys.argv[4:]])
