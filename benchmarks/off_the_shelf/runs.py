"""Trainings one after the other, each in a process of its own, and what came of them."""

import csv
import time
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from multiprocessing import get_context
from pathlib import Path
from typing import NamedTuple

from benchmarks.off_the_shelf.quality import Point, Quality
from learning.policy.policy import Policy

PAPER, ANALYTIC = "paper", "analytic"
OURS = (PAPER, ANALYTIC)
"""Our trainers: Algorithm 1, and the analytic policy gradient."""
DIRECT, RESIDUAL = "direct", "residual"
FORMULATIONS = (DIRECT, RESIDUAL)
"""The whole step, or a correction of our expert's."""


class Task(NamedTuple):
    """A training to do."""

    trainer: str
    """An algorithm of the library, or one of OURS."""
    formulation: str
    seed: int
    length: int
    """Steps of the library's; ours are as long as their files say."""
    every: int
    """From one judgement to the next: steps; Algorithm 1: insertions; analytic: updates."""
    config: Path
    """Of our training; its problem is also that of `residual`."""

    @property
    def name(self) -> str:
        return f"{self.trainer} {self.formulation}"


@dataclass(frozen=True, slots=True)
class Run:
    """A training that was done."""

    task: Task
    startup_s: float
    points: Sequence[Point]
    policy: Policy
    """The best of its points."""

    @property
    def best(self) -> Point:
        """The point of the best quality, the first one of several."""
        return max(self.points, key=lambda point: (point.quality.inserted, point.quality.score))

    def until(self, quality: Quality) -> Point | None:
        """Return the first point that reaches a quality; None if none does."""
        return next((p for p in self.points if p.quality.reaches(quality)), None)


def done(task: Task) -> Run:
    """Do a training in a new process."""
    with ProcessPoolExecutor(1, get_context("spawn")) as pool:
        return pool.submit(_train, task, time.monotonic()).result()


def _train(task: Task, began: float) -> Run:
    # What one trainer loads must not weigh on the other's start.
    if task.trainer in OURS:
        from benchmarks.off_the_shelf.ours import train_analytic, train_paper

        if task.trainer == PAPER:
            recorder = train_paper(task.config, task.seed, task.every, began)
        else:
            recorder = train_analytic(task.config, task.formulation, task.seed, task.every, began)
    else:
        from benchmarks.off_the_shelf.library import AS_REGISTERED, residual, train
        from learning.training.plan import load_plan

        is_direct = task.formulation == DIRECT
        form = AS_REGISTERED if is_direct else residual(load_plan(task.config))
        recorder = train(task.trainer, form, task.seed, task.length, task.every, began)
    if recorder.best is None:
        raise ValueError(f"{task.name} was never judged")
    return Run(task, recorder.startup_s, recorder.points, recorder.best)


def write_curves(runs: Sequence[Run], path: Path) -> None:
    """Write every point of every run as CSV, SI units."""
    head = ("trainer", "formulation", "seed", "startup_s", *Point._fields[:-1], *Quality._fields)
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(head)
        for run in runs:
            for *clock, quality in run.points:
                task = (run.task.trainer, run.task.formulation, run.task.seed)
                writer.writerow((*task, run.startup_s, *clock, *quality))


def by_name(runs: Sequence[Run]) -> Iterator[tuple[str, list[Run]]]:
    """Yield the runs of each trainer and formulation, in their order."""
    for name in dict.fromkeys(run.task.name for run in runs):
        yield name, [run for run in runs if run.task.name == name]
