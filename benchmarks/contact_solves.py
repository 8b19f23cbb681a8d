"""Contact solves per second: the exact search against the paper's discretised one, side by side.

A solve is one pose of a shaft in a part with two holes: all eight contact candidates and the
wrench. Run from the repository's root: python benchmarks/contact_solves.py
"""

import time
from collections.abc import Callable
from functools import partial

import numpy as np
from machine import describe

from simulator.checks import FloatArray
from simulator.contact import solve
from simulator.extremum import Search, discretised_search, exact_search
from simulator.geometry import Hole, Part, Shaft

PART = Part((Hole(1.01e-3, 5e-4), Hole(1.01e-3, 5e-4, 1.5e-3)))
SHAFT = Shaft(1e-3, 4e-3)
INSERTING = np.array([0.0, 0.0, 1.0])
SEARCHES: dict[str, Search] = {
    "exact": exact_search,
    "360 points": discretised_search(360),
    "720 points": discretised_search(720),
}
BATCHES = (1, 16, 64, 4096)
ROUNDS = 7
ROUND_S = 0.12


def poses(n: int) -> FloatArray:
    """Poses of an insertion: 10 um and 0.3 degrees of error, at any depth."""
    spread = np.array([1e-5, 1e-5, 1.5e-3, 5e-3, 5e-3])
    centre = np.array([0.0, 0.0, 1.5e-3, 0.0, 0.0])
    return centre + spread * np.random.default_rng(1).uniform(-1.0, 1.0, (n, 5))


def seconds_per_call(call: Callable[[], object], duration_s: float) -> float:
    calls, start = 0, time.perf_counter()
    while (elapsed := time.perf_counter() - start) < duration_s:
        call()
        calls += 1
    return elapsed / calls


def main() -> None:
    print(describe())
    print(f"median of {ROUNDS} rounds, the searches taking turns; solves per second (us per call)")
    print(f"{'batch':>6}" + "".join(f"{name:>26}" for name in SEARCHES) + "  exact is faster by")
    for batch in BATCHES:
        solve_batch = partial(solve, PART, SHAFT, poses(batch), INSERTING)
        rounds: dict[str, list[float]] = {name: [] for name in SEARCHES}
        for _ in range(ROUNDS):
            for name, search in SEARCHES.items():
                one_solve = partial(solve_batch, search=search)
                rounds[name].append(seconds_per_call(one_solve, ROUND_S))
        times = {name: float(np.median(values)) for name, values in rounds.items()}
        cells = "".join(f"{batch / t:>14,.0f} {f'({t * 1e6:,.0f})':>11}" for t in times.values())
        ratios = [f"{times[name] / times['exact']:.1f}x" for name in list(SEARCHES)[1:]]
        print(f"{batch:>6}{cells}  {', '.join(ratios)}")


if __name__ == "__main__":
    main()
