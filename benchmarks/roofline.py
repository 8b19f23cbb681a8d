"""What the engine's arithmetic could reach on this machine.

Operations of a solve are counted by running the engine's own functions, interpreted, on numbers
that count; the machine's rates are measured with loops of a few lines.
"""

import json
import os
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Callable
from pathlib import Path

import numpy as np
from numba import njit

from simulator.checks import FloatArray

ROOT = Path(__file__).parents[1]
OPERATIONS = ("add", "mul", "div", "sqrt")
POSES = 2000
SIZE = 2048
REPEATS = 4000

COUNT = f"""
import json, math, sys
sys.path.insert(0, "benchmarks")
from contact_solves import INSERTING, PART, SHAFT, poses
from roofline import Counting, tally
from simulator.engine.single import solve_one
from simulator.engine.table import tabulate

square_root = math.sqrt
def counted_root(x):
    tally["sqrt"] += 1
    return Counting(square_root(x))
math.sqrt = counted_root
table = tabulate([(PART, SHAFT)])
table = table._replace(columns=[[Counting(x) for x in table.columns[0]]])
sliding = tuple(map(Counting, INSERTING))
for pose in poses({POSES}):
    x, y, z, rx, ry = map(Counting, pose)
    solve_one(table, 0, (x, y, z), rx, ry, sliding, Counting(4e3), Counting(0.2))
print(json.dumps(tally))
"""

tally: Counter[str] = Counter()


def _counting(operation: str, name: str) -> Callable[..., "Counting"]:
    plain = getattr(float, name)

    def apply(self: float, *other: float) -> "Counting":
        tally[operation] += 1
        return Counting(plain(self, *map(float, other)))

    return apply


class Counting(float):
    """A number that counts what is done to it; comparisons, signs and absolute values are free.

    The ignored types: `float` declares operators of two arguments, ours take either kind of call.
    """

    __add__ = _counting("add", "__add__")  # type: ignore[assignment]  # see above
    __radd__ = _counting("add", "__radd__")
    __sub__ = _counting("add", "__sub__")  # type: ignore[assignment]  # see above
    __rsub__ = _counting("add", "__rsub__")
    __mul__ = _counting("mul", "__mul__")  # type: ignore[assignment]  # see above
    __rmul__ = _counting("mul", "__rmul__")
    __truediv__ = _counting("div", "__truediv__")  # type: ignore[assignment]  # see above
    __rtruediv__ = _counting("div", "__rtruediv__")

    def __neg__(self) -> "Counting":
        return Counting(-float(self))

    def __abs__(self) -> "Counting":
        return Counting(abs(float(self)))


def operations_per_solve() -> dict[str, float]:
    """Additions, multiplications, divisions and square roots of a solve, on average."""
    environment = os.environ | {"NUMBA_DISABLE_JIT": "1", "PYTHONPATH": str(ROOT)}
    run = subprocess.run(
        [sys.executable, "-c", COUNT],
        env=environment,
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=True,
    )
    counts = json.loads(run.stdout)
    return {name: counts[name] / POSES for name in OPERATIONS}


@njit(error_model="numpy", nogil=True)
def _add_and_multiply(x: FloatArray, repeats: int) -> None:
    for _ in range(repeats):
        for i in range(len(x)):
            a = x[i]
            b, c, d = a + 0.1, a + 0.2, a + 0.3
            for _ in range(8):
                a, b = a * 0.999 + 0.001, b * 0.998 + 0.002
                c, d = c * 0.997 + 0.003, d * 0.996 + 0.004
            x[i] = (a + b) + (c + d) - 3.0


@njit(error_model="numpy", nogil=True)
def _divide(x: FloatArray, repeats: int) -> None:
    for _ in range(repeats):
        for i in range(len(x)):
            x[i] = 1.5 / x[i]


@njit(error_model="numpy", nogil=True)
def _take_roots(x: FloatArray, repeats: int) -> None:
    for _ in range(repeats):
        for i in range(len(x)):
            x[i] = np.sqrt(x[i])


@njit(error_model="numpy", nogil=True)
def _stream(a: FloatArray, b: FloatArray, c: FloatArray) -> None:
    for i in range(len(a)):
        a[i] = b[i] + 0.5 * c[i]


def _rate(call: Callable[[], object], amount: float) -> float:
    call()
    best = 0.0
    for _ in range(5):
        start = time.perf_counter()
        call()
        best = max(best, amount / (time.perf_counter() - start))
    return best


def machine_rates() -> dict[str, float]:
    """Operations per second and core, vectors in the nearest cache; bytes per second in memory."""
    x = np.full(SIZE, 1.1)
    passes = SIZE * REPEATS
    large = np.ones((3, 8_000_000))
    return {
        "add or mul": _rate(lambda: _add_and_multiply(x, REPEATS // 10), passes / 10 * 71),
        "div": _rate(lambda: _divide(x, REPEATS), passes),
        "sqrt": _rate(lambda: _take_roots(x, REPEATS), passes),
        "byte": _rate(lambda: _stream(*large), 24.0 * large.shape[1]),
    }
