"""Environment steps per second, next to gymnasium's SyncVectorEnv and to MuJoCo, side by side.

Every environment pushes random steps into the part, and starts anew when its episode is over. A
step of MuJoCo moves the same part, with rings of boxes for holes and held by soft springs, as long
as the longest step takes at 5 mm/s: 12 ms, six mj_step of MuJoCo's default 2 ms, at poses of an
insertion. Run from the repository's root: python benchmarks/environment.py
"""

import sys
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from itertools import cycle
from pathlib import Path

import gymnasium
import mujoco
import numpy as np
from machine import cores, describe

from learning.environments import PAPER, DualPegVectorEnv
from simulator.checks import FloatArray

sys.path.append(str(Path(__file__).parents[1]))
from tests.simulator.mujoco import model as mujoco_model

BATCHES = (1, 100, 10_000, 1_000_000)
SYNC = 100
"""Environments in gymnasium's SyncVectorEnv."""
SIDES = (32, 64)
"""Boxes to a hole."""
HOLDER_N_m = 100.0
MUJOCO_STEPS = 6
"""mj_step of 2 ms in the 60 um of a longest step at 5 mm/s."""
ROUNDS = 5
ROUND_S = 0.5
Step = Callable[[], object]


def actions(n: int) -> FloatArray:
    """Steps that push into the part and swing a little, (n, 3), float32."""
    table = np.random.default_rng(1).uniform(-1.0, 1.0, (n, 3)) * [0.1, 0.1, 0.5] + [0.0, 0.0, 0.5]
    return table.astype(np.float32)


def vector_step(n: int) -> Step:
    env = DualPegVectorEnv(n)
    env.reset(seed=1)
    moves = cycle([actions(n), actions(n)[::-1].copy()])
    return lambda: env.step(next(moves))


def sync_step(n: int) -> Step:
    env = gymnasium.make_vec("tenon/DualPeg-v0", num_envs=n, vectorization_mode="sync")
    env.reset(seed=1)
    moves = actions(n)
    return lambda: env.step(moves)


def mujoco_step(sides: int, threads: ThreadPoolExecutor, workers: int) -> tuple[Step, int]:
    """A call that makes steps on all threads, and how many steps those are."""
    scene = mujoco_model.build(PAPER.part, PAPER.shaft, sides, holder_N_m=HOLDER_N_m)
    env = DualPegVectorEnv(4 * workers)
    env.reset(seed=1)
    poses: list[FloatArray] = []
    for _ in range(40):
        *_, info = env.step(actions(env.num_envs))
        poses.append(info["pose"].reshape(workers, 4, 5))
    states = [mujoco.MjData(scene.model) for _ in range(workers)]

    def work(worker: int) -> None:
        data = states[worker]
        for row in poses:
            for pose in row[worker]:
                data.qpos[:] = mujoco_model.joints(pose)
                data.qvel[:] = 0.0
                mujoco.mj_step(scene.model, data, nstep=MUJOCO_STEPS)

    return lambda: list(threads.map(work, range(workers))), workers * len(poses) * 4


@dataclass(frozen=True, slots=True)
class Speed:
    steps_per_s: float
    cpu_ns: float
    """Time of all cores for a step; other processes on the machine hardly change it."""


def speeds(calls: dict[str, tuple[Step, int]]) -> dict[str, Speed]:
    """Median speed of each call, the calls taking turns."""
    for step, _ in calls.values():
        step()
    rounds: dict[str, list[tuple[float, float]]] = {name: [] for name in calls}
    for _ in range(ROUNDS):
        for name, (step, n) in calls.items():
            made, start, cpu = 0, time.perf_counter(), time.process_time()
            while (elapsed := time.perf_counter() - start) < ROUND_S:
                step()
                made += n
            rounds[name].append((made / elapsed, 1e9 * (time.process_time() - cpu) / made))
    return {name: Speed(*np.median(values, axis=0)) for name, values in rounds.items()}


def rows(workers: int, threads: ThreadPoolExecutor) -> Iterator[tuple[str, tuple[Step, int]]]:
    for n in BATCHES:
        yield f"vector, {n:,}", (vector_step(n), n)
    yield f"SyncVectorEnv, {SYNC:,}", (sync_step(SYNC), SYNC)
    for sides in SIDES:
        yield f"MuJoCo, {sides} boxes to a hole", mujoco_step(sides, threads, workers)


def main() -> None:
    print(describe())
    workers = cores()
    with ThreadPoolExecutor(workers) as threads:
        found = speeds(dict(rows(workers, threads)))
    print(f"median of {ROUNDS} rounds, taking turns, all on up to {workers} threads")
    best = max(speed.steps_per_s for speed in found.values())
    print(f"{'':<32}{'steps per second':>18}{'CPU ns per step':>18}  fastest is faster by")
    for name, speed in found.items():
        ratio = best / speed.steps_per_s
        print(f"{name:<32}{speed.steps_per_s:>18,.0f}{speed.cpu_ns:>18,.0f}  {ratio:,.1f}x")


if __name__ == "__main__":
    main()
