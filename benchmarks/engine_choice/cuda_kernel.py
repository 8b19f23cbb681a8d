"""Numba on a GPU: the scalar functions of `numba_kernels`, one thread per pose."""

from numba import cuda

from benchmarks.engine_choice.numba_kernels import force
from benchmarks.engine_choice.problem import Held
from simulator.checks import FloatArray

THREADS = 128


@cuda.jit
def solve_pose(poses: Held, forces: Held) -> None:
    i = cuda.grid(1)
    if i < poses.shape[1]:
        forces[0, i], forces[1, i], forces[2, i] = force(
            poses[0, i], poses[1, i], poses[2, i], poses[3, i], poses[4, i]
        )


class CudaKernel:
    def place(self, poses: FloatArray) -> Held:
        return cuda.to_device(poses)

    def solve(self, placed: Held) -> Held:
        n = placed.shape[1]
        forces = cuda.device_array((3, n))
        solve_pose[(n + THREADS - 1) // THREADS, THREADS](placed, forces)
        cuda.synchronize()
        return forces

    def fetch(self, forces: Held) -> FloatArray:
        found: FloatArray = forces.copy_to_host()
        return found
