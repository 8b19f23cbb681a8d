"""Result lines of the comparison, from its runs."""

from collections.abc import Iterator, Sequence
from math import inf
from statistics import median

from benchmarks.off_the_shelf.quality import Point, Quality
from benchmarks.off_the_shelf.runs import OURS, Run, by_name

AIM = 10.0
"""Our time to the quality of the library's best is to be so many times shorter."""
LEVELS = (0.5, 0.7, 0.8, 0.9, 0.92, 0.94, 0.96, 0.98)
"""Scores that the table of times has a column for."""


def run_line(run: Run) -> str:
    """What a training came to."""
    last = run.points[-1]
    return (
        f"{run.task.name:<19}seed {run.task.seed}: {last.training_steps} steps in "
        f"{last.wall_s:.1f} s ({last.cpu_s:.1f} s of CPU, start-up {run.startup_s:.1f} s); "
        f"best {described(run.best)}; last {described(last)}"
    )


def described(point: Point) -> str:
    """A point in words."""
    q = point.quality
    return (
        f"{q.inserted:.0%} inserted, score {q.score:.4f}, {q.steps:.0f} steps, "
        f"radial force {1e3 * q.radial_force_N:.2f} mN, peak {1e3 * q.peak_force_N:.0f} mN "
        f"at {point.wall_s:.1f} s"
    )


def lines(runs: Sequence[Run]) -> Iterator[str]:
    """Yield the comparison of the library's best with ours, and the table of times."""
    ours = [run for run in runs if run.task.trainer in OURS]
    theirs = [run for run in runs if run.task.trainer not in OURS]
    for formulation in dict.fromkeys(run.task.formulation for run in theirs):
        yield from _against([r for r in theirs if r.task.formulation == formulation], ours)
    yield ""
    yield "Median time of ours to the best of each, in s, and how many times less that is:"
    for name, group in by_name(theirs):
        yield f"  {name}: {_to_best(group, ours)}"
    yield ""
    yield "Median wall-clock time over seeds to all start poses inserted, and to a score (then with"
    yield "all inserted), in s; - is never in half of the seeds:"
    yield f"{'':<19}{'inserted':>9}" + "".join(f"{level:>8.2f}" for level in LEVELS)
    for name, group in by_name(runs):
        goals = [_goal(0.0), *map(_goal, LEVELS)]
        times = [median(_seconds(run.until(goal)) for run in group) for goal in goals]
        cells = ["-" if time == inf else f"{time:.1f}" for time in times]
        yield f"{name:<19}{cells[0]:>9}" + "".join(f"{cell:>8}" for cell in cells[1:])


def _against(theirs: Sequence[Run], ours: Sequence[Run]) -> Iterator[str]:
    best = _best_of(theirs)
    goal = best.best
    yield ""
    yield f"Best of the library, {best.task.formulation}: {best.task.name}, seed {best.task.seed}:"
    yield f"  {described(goal)}, {goal.training_steps} steps, {goal.cpu_s:.1f} s of CPU"
    for name, group in by_name(ours):
        reached = [run.until(goal.quality) for run in group]
        for run, point in zip(group, reached, strict=True):
            yield f"  {name}, seed {run.task.seed}: {_compared(run, point, best)}"
        yield f"  {name}: {_verdict(median(_seconds(point) for point in reached), goal)}"


def _to_best(theirs: Sequence[Run], ours: Sequence[Run]) -> str:
    goal = _best_of(theirs).best
    if goal.quality.inserted == 0.0:
        return "inserts nothing"
    told = []
    for name, group in by_name(ours):
        seconds = median(_seconds(run.until(goal.quality)) for run in group)
        shown = f"{seconds:.2f} ({goal.wall_s / seconds:.1f})" if 0.0 < seconds < inf else "-"
        told.append(f"{name} {shown}")
    return f"score {goal.quality.score:.4f} at {goal.wall_s:.1f}; {', '.join(told)}"


def _best_of(runs: Sequence[Run]) -> Run:
    return max(runs, key=lambda run: (run.best.quality.inserted, run.best.quality.score))


def _verdict(seconds: float, goal: Point) -> str:
    """Say whether a median time to a goal meets the aim."""
    if seconds == inf:
        return "does not reach it in half of the seeds; the aim is missed"
    if seconds == 0.0:
        return "is there before it is trained, by its expert"
    ratio = goal.wall_s / seconds
    verdict = "met" if ratio >= AIM else "missed"
    return f"{seconds:.2f} s (median), {ratio:.1f} times less; aim {AIM:g}: {verdict}"


def _compared(run: Run, point: Point | None, best: Run) -> str:
    if point is None:
        return f"not reached; its best: {described(run.best)}"
    cold = (best.best.wall_s + best.startup_s) / (point.wall_s + run.startup_s)
    return (
        f"reached after {point.training_steps} steps, {point.wall_s:.2f} s, "
        f"{point.cpu_s:.2f} s of CPU; {cold:.1f} times less with both start-ups"
    )


def _goal(score: float) -> Quality:
    return Quality(1.0, score, 0.0, 0.0, 0.0, 0.0)


def _seconds(point: Point | None) -> float:
    if point is None:
        return inf
    return point.wall_s if point.training_steps else 0.0
