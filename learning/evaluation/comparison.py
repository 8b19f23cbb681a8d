"""A comparison from the file to its results: tune, insert, measure."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, fields

import numpy as np

from drivers.contract.errors import ConfigurationError
from learning.evaluation.contenders import Admittance, Contender, Privileged, Proportional
from learning.evaluation.load import Entry, Evaluation, Untuned
from learning.evaluation.metrics import (
    QUANTITIES,
    Gap,
    Interval,
    Measured,
    Spread,
    Thresholds,
    gap_closed,
    measured,
    spread,
    success_rate,
)
from learning.evaluation.plant import Plant
from learning.evaluation.settings import AdmittanceSettings, TunedSettings
from learning.evaluation.trial import Record
from learning.evaluation.trials import Workers, cases_of
from learning.evaluation.tuning import TRIED, tune

Told = Callable[[str, int, int], None]
"""Hears of progress: what is being done, how much of it was done since, how much there is."""


@dataclass(frozen=True, slots=True, eq=False)
class Result:
    """What came of one controller."""

    name: str
    kind: str
    parameters: Mapping[str, float]
    """Gain and the like in the unit that the name ends in; empty where there are none to show."""
    records: Sequence[Record]
    """By plant."""
    measured: Measured
    success: Interval
    spreads: Mapping[str, Spread]
    """By name of `QUANTITIES`."""
    gap: Gap | None
    """Beside a tuned P-controller and a privileged one that tilts; None for these two."""

    @property
    def successes(self) -> int:
        """Number of insertions that succeeded."""
        return int(self.measured.is_success.sum())


@dataclass(frozen=True, slots=True, eq=False)
class Comparison:
    """Controllers side by side."""

    evaluation: Evaluation
    plants: Sequence[Plant]
    results: Sequence[Result]


def compare(evaluation: Evaluation, workers: Workers, told: Told) -> Comparison:
    """Run a comparison; the same file gives the same results with any number of workers.

    Raises ConfigurationError for a controller that cannot be tuned between the ends given.
    """
    settings, plants = evaluation.settings, evaluation.plants()
    contenders = tuned(evaluation, workers, told, [*evaluation.entries])
    cases, rules = cases_of(plants, settings.plants.seed), settings.trial.rules()
    thresholds = Thresholds(settings.trial.step_s, settings.trial.gentle_N)
    records: dict[str, list[Record]] = {}
    for name, contender in contenders.items():

        def done(count: int, name: str = name) -> None:
            told(name, count, len(cases))

        (records[name],) = workers.insert([contender], cases, rules, done)
    figures = {name: measured(each, thresholds) for name, each in records.items()}
    ends = _ends(evaluation.entries)
    results = []
    for name, entry in evaluation.entries.items():
        of = figures[name]
        # Every controller with the same draws: equal insertions have equal intervals.
        generator = np.random.default_rng(settings.bootstrap.seed)
        samples = settings.bootstrap.samples
        spreads = {q: spread(of.values[q], samples, generator) for q in QUANTITIES}
        gap = None
        if ends is not None and name not in ends:
            worst, bound = (figures[end] for end in ends)
            gap = gap_closed(of, worst, bound, samples, generator)
        results.append(
            Result(
                name,
                entry.kind,
                parameters(contenders[name]),
                records[name],
                of,
                success_rate(of.is_success),
                spreads,
                gap,
            )
        )
    return Comparison(evaluation, plants, results)


def tuned(
    evaluation: Evaluation, workers: Workers, told: Told, names: Sequence[str]
) -> dict[str, Contender]:
    """Return these controllers ready to insert.

    Raises ConfigurationError for one that cannot be tuned between the ends given.
    """
    cases = cases_of(evaluation.training_plants(), evaluation.settings.tuning.seed)
    rules = evaluation.settings.trial.rules()

    def best(name: str, settings: Untuned) -> Contender:
        total = TRIED[settings.kind] * len(cases)

        def done(count: int) -> None:
            told(f"tuning {name}", count, total)

        try:
            return tune(settings, lambda tried: workers.insert(tried, cases, rules, done))
        except ValueError as error:
            raise ConfigurationError(
                f"{evaluation.source.path}: controllers.{name} cannot be tuned: {error}"
            ) from error

    entries = {name: evaluation.entries[name].contender for name in names}
    return {
        name: best(name, entry) if isinstance(entry, TunedSettings | AdmittanceSettings) else entry
        for name, entry in entries.items()
    }


def _ends(entries: Mapping[str, Entry]) -> tuple[str, str] | None:
    """Names of the controllers between which the gap lies, if there are both."""
    tuned = [name for name, entry in entries.items() if entry.kind == "tuned"]
    bound = [
        name
        for name, entry in entries.items()
        if isinstance(entry.contender, Privileged) and entry.contender.tilt
    ]
    return (tuned[0], bound[0]) if tuned and bound else None


def parameters(contender: Contender) -> dict[str, float]:
    """Return what a controller with few parameters is set to, by names that end in their units."""
    if not isinstance(contender, Proportional | Admittance):
        return {}
    values: dict[str, float] = {}
    for field in fields(contender):
        value = getattr(contender, field.name)
        stem, per_si = field.name, 1.0
        if stem.endswith("_m_N"):
            stem, per_si = f"{stem.removesuffix('_m_N')}_um_N", 1e6
        elif stem.endswith("_m"):
            stem, per_si = f"{stem.removesuffix('_m')}_um", 1e6
        values[stem] = value * per_si
    return values
