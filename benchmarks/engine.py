"""Contact solves per second of the batched engine, next to what there is to compare it with.

A solve is one pose of a shaft in a part with two holes: all contact candidates, friction, the
wrench and the contact state; MuJoCo's is one step of the same part, its holes as rings of boxes.
Run from the repository's root: python benchmarks/engine.py
"""

import sys
import time
import tracemalloc
from collections.abc import Callable
from functools import partial
from importlib.metadata import version
from pathlib import Path

import mujoco
import numpy as np
from contact_solves import INSERTING, PART, SEARCHES, SHAFT, poses, seconds_per_call
from machine import describe
from roofline import OPERATIONS, machine_rates, operations_per_solve

from simulator.contact import ContactLaw
from simulator.contact import solve as reference
from simulator.engine.batch import Batch
from simulator.engine.solve import solve
from simulator.engine.table import tabulate
from simulator.geometry import Hole, Part, Shaft
from simulator.profile import Chamfer, Rounding

sys.path.insert(0, str(Path(__file__).parents[1]))
from tests.simulator.mujoco.model import build, joints

BATCH = 1_000_000
ROUNDS = 5
BOXES = 32
HOLES = (1, 2, 3, 4, 6)
WORKED = Shaft(1e-3, 4e-3, Rounding(8e-5), Chamfer(4e-5, 3e-5))
Solver = Callable[[], object]


def engine(part: Part, n: int, threads: int) -> Solver:
    table, out = tabulate([(part, SHAFT)]), Batch.empty(n)
    return partial(solve, table, poses(n), INSERTING, threads=threads, out=out)


def stepping(n: int) -> Solver:
    """MuJoCo with the shaft put at each pose in turn."""
    scene = build(PART, SHAFT, BOXES)
    data = mujoco.MjData(scene.model)
    places = [joints(pose) for pose in poses(n)]

    def run() -> None:
        for place in places:
            data.qpos[:] = place
            mujoco.mj_step(scene.model, data)

    return run


def per_second(solvers: dict[str, tuple[Solver, int]]) -> dict[str, float]:
    """Median over rounds in which the solvers take turns."""
    rounds: dict[str, list[float]] = {name: [] for name in solvers}
    for _ in range(ROUNDS):
        for name, (call, n) in solvers.items():
            rounds[name].append(n / seconds_per_call(call, 0.1))
    return {name: float(np.median(values)) for name, values in rounds.items()}


def side_by_side() -> float:
    n = 4096
    solvers: dict[str, tuple[Solver, int]] = {
        "engine, 2 threads": (engine(PART, BATCH, 2), BATCH),
        "engine, 1 thread": (engine(PART, BATCH, 1), BATCH),
        "numpy reference": (partial(reference, PART, SHAFT, poses(n), INSERTING), n),
    }
    for name in ("360 points", "720 points"):
        search = SEARCHES[name]
        call = partial(reference, PART, SHAFT, poses(n), INSERTING, search=search)
        solvers[f"discretised search, {name}"] = call, n
    solvers[f"MuJoCo, 2 x {BOXES} boxes"] = stepping(500), 500
    rates = per_second(solvers)
    first = next(iter(rates.values()))
    for name, rate in rates.items():
        print(f"{name:<32}{rate:>14,.0f} solves/s{first / rate:>12,.1f}x")
    return rates["engine, 1 thread"]


def agreement() -> None:
    found = solve(tabulate([(PART, SHAFT)]), poses(BATCH), INSERTING, threads=2)
    worst, largest = 0.0, 0.0
    for first in range(0, BATCH, 50_000):
        rows = slice(first, first + 50_000)
        expected = reference(PART, SHAFT, poses(BATCH)[rows], INSERTING)
        largest = max(largest, float(expected.penetration.max()))
        worst = max(worst, float(np.abs(found.wrench[rows, :3] - expected.wrench[:, :3]).max()))
    scale_N = ContactLaw().stiffness_N_m * largest
    print(
        f"largest difference from the reference's forces: {worst / scale_N:.1e} of {scale_N:.3f} N"
    )


def over_batches() -> None:
    print(f"{'batch':>9}{'1 thread':>16}{'2 threads':>16}   solves/s")
    for n in (1, 10, 100, 1000, 10_000, 100_000, 1_000_000):
        rates = per_second({str(t): (engine(PART, n, t), n) for t in (1, 2)})
        print(f"{n:>9}" + "".join(f"{rate:>16,.0f}" for rate in rates.values()))


def over_holes() -> None:
    print(f"{'holes':>9}{'1 thread':>16}   solves/s")
    for holes in HOLES:
        # As many walls as asked for along the depths that the poses reach.
        wall_m = 3e-3 / (2 * holes)
        part = Part((Hole(1.01e-3, wall_m), *[Hole(1.01e-3, wall_m, wall_m)] * (holes - 1)))
        n = 100_000
        rate = per_second({"": (engine(part, n, 1), n)})[""]
        print(f"{holes:>9}{rate:>16,.0f}")


def over_shapes() -> None:
    chamfered = Part((Hole(1.01e-3, 5e-4, entry=Chamfer(4e-5, 6e-5)), *PART.holes[1:]))
    n = 100_000
    at_mouth = poses(n)
    at_mouth[:, 2] = np.random.default_rng(2).uniform(-1e-5, 1e-4, n)
    solvers: dict[str, tuple[Solver, int]] = {}
    for name, part, shaft, places in (
        ("plain", PART, SHAFT, poses(n)),
        ("plain, at the mouth", PART, SHAFT, at_mouth),
        ("worked ends, chamfered mouth", chamfered, WORKED, poses(n)),
        ("the same, at the mouth", chamfered, WORKED, at_mouth),
        ("interference fit", PART, Shaft(1.012e-3, 4e-3), poses(n)),
    ):
        solvers[name] = partial(solve, tabulate([(part, shaft)]), places, INSERTING), n
    for name, rate in per_second(solvers).items():
        print(f"{name:<32}{rate:>14,.0f} solves/s on 1 thread")


def memory() -> None:
    table, own = tabulate([(PART, SHAFT)]), np.ones(BATCH)
    place, sliding = poses(BATCH), np.tile(INSERTING, (BATCH, 1))
    rows = np.zeros(BATCH, dtype=np.int64)
    given = sum(array.nbytes for array in (place, sliding, own, own, rows)) / BATCH
    tracemalloc.start()
    solve(table, place, sliding, stiffness_N_m=own, friction=own, geometry=rows, threads=2)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    print(
        f"memory: {given:.0f} bytes per pose given, with a law and geometry each, "
        f"{peak / BATCH:.1f} more at the peak; "
        f"{(given * BATCH + peak) / 2**20:.0f} MiB for {BATCH:,} poses"
    )


def roofline(rate: float) -> None:
    counts, rates = operations_per_solve(), machine_rates()
    print(
        "a solve: "
        + ", ".join(f"{counts[name]:.0f} {name}" for name in OPERATIONS)
        + f", {sum(counts.values()):.0f} in all: {sum(counts.values()) * rate * 1e-9:.1f} GFLOP/s"
    )
    print(
        "this core: " + ", ".join(f"{value * 1e-9:.2f} G {name}/s" for name, value in rates.items())
    )
    least_s = (counts["add"] + counts["mul"]) / rates["add or mul"]
    least_s += counts["div"] / rates["div"] + counts["sqrt"] / rates["sqrt"]
    traffic_s = (40 + 48 + 8 + 3) / rates["byte"]
    print(
        f"a solve takes {1e9 / rate:.1f} ns; arithmetic alone {least_s * 1e9:.1f} ns "
        f"({least_s * rate:.0%}), memory alone {traffic_s * 1e9:.1f} ns ({traffic_s * rate:.0%})"
    )


def main() -> None:
    print(describe())
    print(f"numba {version('numba')}, mujoco {version('mujoco-core')}")
    start = time.perf_counter()
    solve(tabulate([(PART, SHAFT)]), poses(1), INSERTING)
    print(f"compiled, or loaded from disk, in {time.perf_counter() - start:.1f} s")
    rate = side_by_side()
    agreement()
    over_batches()
    over_holes()
    over_shapes()
    memory()
    roofline(rate)


if __name__ == "__main__":
    main()
