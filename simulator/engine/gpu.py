"""Batches of contact solves on a CUDA device, one thread to a pose.

The threads run the functions that the CPU runs, compiled for the device, where a product and a sum
may be rounded once: results agree to rounding. Ends do not stand on faces here.
"""

from importlib import import_module
from typing import Any

import numpy as np
import numpy.typing as npt

from simulator.engine.batch import Batch, Found, Given, checked
from simulator.engine.single import solve_one
from simulator.engine.table import Table

cuda: Any = import_module("numba.cuda")
_THREADS = 128


def _solve_poses(table: Table, given: Given, found: Found) -> None:
    i = cuda.blockIdx.x * cuda.blockDim.x + cuda.threadIdx.x
    if i >= len(given.poses):
        return
    pose, slide = given.poses[i], given.sliding[i if len(given.sliding) > 1 else 0]
    wrench, penetration, state, points = solve_one(
        table,
        given.geometry[i if len(given.geometry) > 1 else 0],
        (pose[0], pose[1], pose[2]),
        pose[3],
        pose[4],
        (slide[0], slide[1], slide[2]),
        given.stiffness[i if len(given.stiffness) > 1 else 0],
        given.friction[i if len(given.friction) > 1 else 0],
    )
    for axis in range(6):
        found.wrench[i, axis] = wrench[axis]
    found.penetration[i], found.state[i], found.points[i] = penetration, state, points


_kernel = cuda.jit(_solve_poses)


def solve(
    table: Table,
    poses: npt.ArrayLike,
    sliding: npt.ArrayLike,
    *,
    stiffness_N_m: npt.ArrayLike = 4e3,
    friction: npt.ArrayLike = 0.2,
    geometry: npt.ArrayLike = 0,
) -> Batch:
    """As `simulator.engine.solve.solve`, without blocking; the arrays are copied to and fro."""
    given = checked(table, poses, sliding, stiffness_N_m, friction, geometry, None)
    given = given._replace(entered=np.zeros((1, 1), dtype=np.bool_))
    batch = Batch.empty(len(given.poses))
    if len(given.poses):
        sent = [type(arrays)(*map(cuda.to_device, arrays)) for arrays in (table, given)]
        found: Any = Found(*map(cuda.to_device, batch.arrays()))
        _kernel[-(-len(given.poses) // _THREADS), _THREADS](*sent, found)
        for array, result in zip(batch.arrays(), found, strict=True):
            result.copy_to_host(array)
    return batch
