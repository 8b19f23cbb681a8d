"""Many insertions at once: every controller on the same plants with the same chance."""

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from contextlib import contextmanager
from multiprocessing import get_context
from typing import NamedTuple

import numpy as np

from learning.evaluation.contenders import Contender
from learning.evaluation.plant import Plant
from learning.evaluation.trial import Record, Trial, TrialRules, insert

_CHUNK = 5
"""Plants that a process takes at a time."""
_TRIAL, _CONTROLLER = 0, 1
"""What random numbers are for: the last of the numbers that they are made from."""


class Case(NamedTuple):
    """A plant with the seed of all chance in its insertions but the plant itself."""

    plant: Plant
    seed: tuple[int, int]


def cases_of(plants: Sequence[Plant], seed: int) -> list[Case]:
    """Each plant with a seed that depends on `seed` and the plant's number alone."""
    return [Case(plant, (seed, number)) for number, plant in enumerate(plants)]


def insert_each(contender: Contender, cases: Sequence[Case], rules: TrialRules) -> list[Record]:
    """One insertion of each case, one after the other.

    Noise and stage see the same random numbers whatever the controller is; its own are others.
    """
    records = []
    for plant, seed in cases:
        trial = Trial(plant, rules, np.random.default_rng((*seed, _TRIAL)))
        own = np.random.default_rng((*seed, _CONTROLLER))
        records.append(insert(trial, contender.controller(plant, trial, own)))
    return records


class Workers:
    """Processes that share insertions; how many there are changes no result."""

    def __init__(self, pool: ProcessPoolExecutor | None) -> None:
        """Without a `pool`, everything is done in this process."""
        self._pool = pool

    def insert(
        self,
        contenders: Sequence[Contender],
        cases: Sequence[Case],
        rules: TrialRules,
        done: Callable[[int], None] = lambda count: None,
    ) -> list[list[Record]]:
        """Records by contender and case; `done` hears of insertions made since it last heard."""
        chunks = [cases[first : first + _CHUNK] for first in range(0, len(cases), _CHUNK)]
        jobs = [(contender, chunk) for contender in contenders for chunk in chunks]
        found: list[list[Record]] = [[] for _ in jobs]
        if self._pool is None:
            for number, (contender, chunk) in enumerate(jobs):
                found[number] = insert_each(contender, chunk, rules)
                done(len(chunk))
        else:
            for number, records in self._shared(self._pool, jobs, rules):
                found[number] = records
                done(len(records))
        per = len(chunks)
        return [
            [record for records in found[first : first + per] for record in records]
            for first in range(0, len(jobs), per)
        ]

    @staticmethod
    def _shared(
        pool: ProcessPoolExecutor,
        jobs: Sequence[tuple[Contender, Sequence[Case]]],
        rules: TrialRules,
    ) -> Iterator[tuple[int, list[Record]]]:
        """Number and records of each job, in the order in which they end."""
        numbers: dict[Future[list[Record]], int] = {
            pool.submit(insert_each, contender, chunk, rules): number
            for number, (contender, chunk) in enumerate(jobs)
        }
        waiting = set(numbers)
        try:
            while waiting:
                ended, waiting = wait(waiting, return_when=FIRST_COMPLETED)
                for future in ended:
                    yield numbers[future], future.result()
        finally:
            for future in waiting:
                future.cancel()


@contextmanager
def workers(count: int) -> Iterator[Workers]:
    """`count` processes, which end with the context; 1 is this process alone."""
    if count == 1:
        yield Workers(None)
        return
    with ProcessPoolExecutor(count, mp_context=get_context("spawn")) as pool:
        yield Workers(pool)
