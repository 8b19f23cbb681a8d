"""Rows of a batch worked in blocks, on all cores."""

import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from functools import cache

BLOCK = 4096
"""Rows worked at a time: what they need stays in a core's cache."""


@cache
def _pool() -> ThreadPoolExecutor:
    return ThreadPoolExecutor(len(os.sched_getaffinity(0)), thread_name_prefix="environments")


# A forked child has none of its parent's threads.
os.register_at_fork(after_in_child=_pool.cache_clear)


def in_blocks(work: Callable[[slice], None], rows: int) -> None:
    """Call `work` for each block of `rows`; where there are several, on as many threads as cores.

    Blocks must not depend on one another. Returns when all are done; an exception in one is raised.
    """
    if rows <= BLOCK:
        work(slice(0, rows))
        return
    blocks = [slice(begin, min(begin + BLOCK, rows)) for begin in range(0, rows, BLOCK)]
    for _ in _pool().map(work, blocks):
        pass
