"""Libraries for a batched contact engine, side by side on one kernel, in float64.

Run from the repository's root: python -m benchmarks.engine_choice [cpu | cuda] [largest batch]

A library that is not installed is skipped. None but numpy and numba is needed elsewhere; to
measure the others, use a virtual environment of its own.
"""

import os
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from importlib.metadata import version

import numpy as np

from benchmarks.engine_choice import array_kernels
from benchmarks.engine_choice.problem import Kernel, insertion_poses
from benchmarks.machine import describe
from simulator.checks import FloatArray

BATCHES = (1, 1_000, 100_000, 1_000_000)
ROUNDS = 7
ROUND_S = 0.1
FIRST_BATCH = 10_000
TOLERANCE = 1e-9
SLICES = ((0, 1), (0, 7), (3, 10), (995, 996), (1, 1_001), (90_001, 100_000))


@dataclass(frozen=True, slots=True)
class Candidate:
    package: str
    load: Callable[[], Kernel]


@dataclass(frozen=True, slots=True)
class Loaded:
    kernel: Kernel
    first_use_s: float
    """Import, and the first calls with a small and a large batch, nothing being cached."""
    next_size_s: float
    """First call with a batch of yet another size."""


def candidates(device: str) -> dict[str, Candidate]:
    def plain() -> Kernel:
        from benchmarks.engine_choice.numba_kernels import CpuKernel, plain_span

        return CpuKernel.of(plain_span)

    def blocked() -> Kernel:
        from benchmarks.engine_choice.numba_kernels import CpuKernel, blocked_span

        return CpuKernel.of(blocked_span)

    def cuda() -> Kernel:
        from benchmarks.engine_choice.cuda_kernel import CudaKernel

        return CudaKernel()

    def warp() -> Kernel:
        from benchmarks.engine_choice.warp_kernels import WarpKernel

        return WarpKernel(device)

    if device == "cpu":
        numba = {
            "numba plain": Candidate("numba", plain),
            "numba blocked": Candidate("numba", blocked),
        }
    else:
        numba = {"numba cuda": Candidate("numba-cuda[cu13]", cuda)}
    return {
        "numpy": Candidate("numpy", array_kernels.load_numpy),
        **numba,
        "warp": Candidate("warp-lang", warp),
        "torch.compile": Candidate("torch", partial(array_kernels.load_torch, device)),
        "jax": Candidate("jax", partial(array_kernels.load_jax, device)),
    }


def answer(kernel: Kernel, poses: FloatArray) -> FloatArray:
    return kernel.fetch(kernel.solve(kernel.place(np.ascontiguousarray(poses))))


def load(candidate: Candidate) -> Loaded:
    poses = insertion_poses(FIRST_BATCH + 1)
    start = time.perf_counter()
    kernel = candidate.load()
    answer(kernel, poses[:, :1])
    answer(kernel, poses[:, :FIRST_BATCH])
    loaded = time.perf_counter()
    answer(kernel, poses)
    return Loaded(kernel, loaded - start, time.perf_counter() - loaded)


def seconds_per_call(call: Callable[[], object]) -> float:
    calls, start = 0, time.perf_counter()
    while (elapsed := time.perf_counter() - start) < ROUND_S or calls == 0:
        call()
        calls += 1
    return elapsed / calls


def identical(kernel: Kernel, poses: FloatArray) -> str:
    """Share of entries that keep their bits when they are solved in another batch."""
    whole = answer(kernel, poses)
    same = [answer(kernel, poses[:, first:last]) == whole[:, first:last] for first, last in SLICES]
    entries = np.concatenate([part.all(axis=0) for part in same])
    return "yes" if entries.all() else f"{entries.mean():.3%}"


def medians(kernels: dict[str, Kernel], batches: list[int]) -> dict[str, list[float]]:
    """Median seconds per call of each library for each batch, the libraries taking turns."""
    found: dict[str, list[float]] = {name: [] for name in kernels}
    for batch in batches:
        poses = insertion_poses(batch)
        rounds: dict[str, list[float]] = {name: [] for name in kernels}
        placed = {name: kernel.place(poses) for name, kernel in kernels.items()}
        for name, kernel in kernels.items():
            kernel.solve(placed[name])
        for _ in range(ROUNDS):
            for name, kernel in kernels.items():
                solve = partial(kernel.solve, placed[name])
                rounds[name].append(seconds_per_call(solve))
        for name, values in rounds.items():
            found[name].append(float(np.median(values)))
    return found


def main() -> None:
    device = sys.argv[1] if len(sys.argv) > 1 else "cpu"
    batches = [n for n in BATCHES if n <= int((sys.argv[2:] or [BATCHES[-1]])[0])]
    if device not in ("cpu", "cuda"):
        raise SystemExit(f"device is {device!r}; it must be cpu or cuda")
    print(describe())
    print(f"load average {os.getloadavg()[0]:.1f} at the start")
    loaded, versions = {}, {}
    for name, candidate in candidates(device).items():
        try:
            loaded[name] = load(candidate)
        except ImportError:
            print(f"{name} is skipped: pip install {candidate.package}")
            continue
        package = candidate.package.split("[")[0]
        versions[package] = version(package)
    print(", ".join(f"{package} {number}" for package, number in versions.items()))

    poses = insertion_poses(100_000)
    reference = answer(loaded["numpy"].kernel, poses)
    size = np.abs(reference).max()
    error = {
        name: float(np.abs(answer(entry.kernel, poses) - reference).max() / size)
        for name, entry in loaded.items()
    }
    times = medians({name: entry.kernel for name, entry in loaded.items()}, batches)
    print(f"device {device}; median of {ROUNDS} rounds, the libraries taking turns")
    sizes = "".join(f" {f'n = {n:,}':>16} |" for n in batches)
    print(f"| {'library':<14} |{sizes} first use | other size |   error | same bits |")
    print("|---|" + "---:|" * (len(batches) + 3) + "---|")
    for name, entry in loaded.items():
        cells = "".join(
            f" {f'{s / n * 1e9:,.0f} ns' if n > 1 else f'{s * 1e6:.1f} us':>16} |"
            for s, n in zip(times[name], batches, strict=True)
        )
        print(
            f"| {name:<14} |{cells} {entry.first_use_s:>7.1f} s | {entry.next_size_s:>8.3f} s |"
            f" {error[name]:.1e} | {identical(entry.kernel, poses):>9} |"
        )
    print(f"load average {os.getloadavg()[0]:.1f} at the end")
    far = [name for name, value in error.items() if not value < TOLERANCE]
    if far:
        raise SystemExit(f"{', '.join(far)} disagree with numpy by more than {TOLERANCE}")


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as folder:
        os.environ["WARP_CACHE_PATH"] = folder
        os.environ["TORCHINDUCTOR_CACHE_DIR"] = folder
        # Idle threads of one library must not spin on the cores that the next one needs.
        os.environ["OMP_WAIT_POLICY"] = "passive"
        main()
