"""Batches of contact solves on the CPU."""

from concurrent.futures import ThreadPoolExecutor

import numpy.typing as npt

from simulator.engine.batch import Batch, BoolArray, checked, checked_out
from simulator.engine.block import solve_blocks
from simulator.engine.lanes import BLOCK, working_memory
from simulator.engine.table import Table

_LEAST_PER_THREAD = 128 * BLOCK
"""Poses for which a second thread saves more than it takes to start."""
CHUNK = 256 * BLOCK
"""Poses that a thread takes at a time: a core that others use as well takes fewer of them."""


def solve(
    table: Table,
    poses: npt.ArrayLike,
    sliding: npt.ArrayLike,
    *,
    stiffness_N_m: npt.ArrayLike = 4e3,
    friction: npt.ArrayLike = 0.2,
    geometry: npt.ArrayLike = 0,
    entered: BoolArray | None = None,
    threads: int = 1,
    out: Batch | None = None,
) -> Batch:
    """Contacts of `poses`, shape (n, 5), as `simulator.contact.solve` finds them one law at a time.

    `sliding` has the shape (3,) or (n, 3); `stiffness_N_m`, `friction`, and `geometry`, the row of
    the table, are one number or (n,). With `entered`, (n, N) for N walls, ends stand on the faces
    of walls not entered: it is first carried on to these poses, in place, as by
    `simulator.blocking.update_entered`. The result is the same to the bit in every batch and with
    any number of threads; they end with the call. `out` takes the results in place of new memory.
    Raises `ValueError` for wrong shapes and types and for parameters outside their range.
    """
    given = checked(table, poses, sliding, stiffness_N_m, friction, geometry, entered)
    n = len(given.poses)
    batch = Batch.empty(n) if out is None else checked_out(out, n)
    found = batch.arrays()
    if threads < 1:
        raise ValueError(f"threads is {threads}; it must be at least 1")

    def run(first: int) -> None:
        memory = working_memory(table.columns.shape[1])
        solve_blocks(table, given, found, first, min(n, first + CHUNK), *memory)

    chunks, workers = range(0, n, CHUNK), min(threads, n // _LEAST_PER_THREAD)
    if workers < 2:
        for first in chunks:
            run(first)
    else:
        with ThreadPoolExecutor(workers) as pool:
            for _ in pool.map(run, chunks):
                pass
    return batch
