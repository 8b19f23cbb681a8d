"""The numbers of a run, in SI units."""

import math
from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum
from statistics import fmean

from scipy.stats import binomtest

from controllers.messages import Reason, Rule, Severity
from hil.summary.facts import RunFacts

GENTLE_BAND_N = 0.044
"""Radial force that is counted as gentle; the same for every run, so that runs can be compared."""


class Outcome(StrEnum):
    """How an insertion ended."""

    DONE = "done"
    FAILED = "failed"
    NOT_FINISHED = "not finished"
    """The log ends before the insertion does; never counted as a success."""


@dataclass(frozen=True, slots=True)
class Load:
    """A force over some samples [N]."""

    peak_N: float
    """The sample of largest magnitude."""
    mean_N: float
    median_N: float
    p95_N: float
    """One sample in twenty is larger."""


@dataclass(frozen=True, slots=True)
class Forces:
    """Raw forces without bias, over one insert phase or several."""

    samples: int
    x: Load
    """|f_x|"""
    y: Load
    """|f_y|"""
    z: Load
    """f_z with its sign"""
    radial: Load
    """Magnitude across the hole, sqrt(f_x^2 + f_y^2)."""
    gentle_share: float
    """Share of the samples whose radial force is at most `GENTLE_BAND_N`."""


@dataclass(frozen=True, slots=True)
class VerdictCounts:
    """What the supervisor did in some time."""

    proposals: int
    """Proposals answered."""
    answers: Mapping[Severity, int]
    """Answers to proposals by severity; all severities are there."""
    hardest: Mapping[Severity, int]
    """Proposals by the hardest verdict from the answer to the next proposal."""
    rules: Counter[tuple[Rule, Severity]]
    """In how many answers a rule fired."""
    onsets: Counter[tuple[Rule, Severity]]
    """How often a rule began to fire under the supervisor's watch, tick by tick."""
    lowest_cap_m_s: float
    """Lowest speed cap that is on record; infinite where there is none."""


@dataclass(frozen=True, slots=True)
class InsertionSummary:
    """One insertion."""

    number: int
    outcome: Outcome
    reason: str
    """Why it failed or, if it is not finished, why it was being given up; else empty."""
    start_ns: int
    end_ns: int
    """Approach and retraction included."""
    given_up_ns: int | None
    """When it was given up and the shaft led out again, if it was."""
    steps: int
    """Steps sent in the insert phase."""
    deepest_m: float
    """Greatest depth in the insert phase; NaN where that was not entered."""
    forces: Forces | None
    """In the insert phase; None where that holds no usable sample."""
    lower_hole_peak_N: float
    """Radial, from the second hole's upper rim on; NaN where that was not reached."""
    verdicts: VerdictCounts

    @property
    def duration_s(self) -> float:
        """Return the time from the first phase to the last."""
        return (self.end_ns - self.start_ns) * 1e-9


@dataclass(frozen=True, slots=True)
class Timing:
    """The control loop, from sample to verdict; all zero in simulated time."""

    ticks: int
    mean_s: float
    max_s: float
    missed_deadlines: int


@dataclass(frozen=True, slots=True)
class Stop:
    """A stop that the supervisor latched."""

    stamp_ns: int
    reason: Reason


@dataclass(frozen=True, slots=True)
class RunSummary:
    """A whole run."""

    facts: RunFacts
    complete: bool
    """Whether the log was closed."""
    ending: str
    """How the log ends where it was not closed."""
    insertions: tuple[InsertionSummary, ...]
    forces: Forces | None
    """Over the samples of all insert phases."""
    lower_hole_peak_N: float
    duration_s: float
    """From the first record to the last."""
    verdicts: VerdictCounts
    timing: Timing
    stops: tuple[Stop, ...]
    """In order of time."""

    def count(self, outcome: Outcome) -> int:
        """Return how many insertions ended so."""
        return sum(insertion.outcome is outcome for insertion in self.insertions)

    @property
    def success_interval(self) -> tuple[float, float]:
        """Return the 95 % interval of the success rate over all insertions begun."""
        return wilson_interval(self.count(Outcome.DONE), len(self.insertions))

    @property
    def steps_mean(self) -> float:
        """Return the mean number of steps; NaN without an insertion."""
        return fmean(i.steps for i in self.insertions) if self.insertions else math.nan

    @property
    def steps_max(self) -> int:
        """Return the largest number of steps; 0 without an insertion."""
        return max((i.steps for i in self.insertions), default=0)


def wilson_interval(successes: int, trials: int) -> tuple[float, float]:
    """Return Wilson's 95 % interval of a success rate; 0 to 1 without a trial."""
    if trials == 0:
        return (0.0, 1.0)
    interval = binomtest(successes, trials).proportion_ci(0.95, method="wilson")
    return (float(interval.low), float(interval.high))
