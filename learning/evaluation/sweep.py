"""Plants outside of what a controller expects: one parameter after the other is pushed."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from annotated_types import Ge, MinLen

from drivers.contract.configuration.problems import Problems
from drivers.contract.configuration.yaml_loader import read_yaml
from drivers.contract.settings import Settings
from learning.evaluation.comparison import Told, tuned
from learning.evaluation.contenders import Contender
from learning.evaluation.load import Evaluation, load_evaluation
from learning.evaluation.metrics import Interval, Measured, Thresholds, measured, success_rate
from learning.evaluation.plant import drawn_plants
from learning.evaluation.trials import Workers, cases_of
from learning.randomisation.plant import PlantSettings
from simulator.randomisation.plants import PlantDistribution


class PushSettings(Settings):
    """A parameter and the values that it is pushed to."""

    keys: Annotated[tuple[str, ...], MinLen(1)]
    """Keys of the plants' file that take each value, with dots between groups and numbers."""
    label: str
    """The parameter with its unit, as the figure names it."""
    values: Annotated[tuple[float, ...], MinLen(1)]
    expected: tuple[float, float]
    """Range that the controllers expect."""


class SweepSettings(Settings):
    """The file as a whole, but for the parameters."""

    comparison: str
    """The comparison (YAML) that plants, rules and controllers are from, relative to this file."""
    controllers: Annotated[tuple[str, ...], MinLen(1)]
    """Those of the comparison that take part."""
    plants: Annotated[int, Ge(1)]
    """For each value; the same alignment and noise for all values."""


@dataclass(frozen=True, slots=True)
class Push:
    """A parameter with the plants for each of its values."""

    name: str
    settings: PushSettings
    distributions: tuple[PlantDistribution, ...]
    """By value."""


@dataclass(frozen=True, slots=True)
class Sweep:
    """All that a sweep needs, valid as a whole."""

    settings: SweepSettings
    evaluation: Evaluation
    pushes: tuple[Push, ...]


@dataclass(frozen=True, slots=True, eq=False)
class Point:
    """What came of one controller at one value of one parameter."""

    push: str
    value: float
    controller: str
    success: Interval
    figures: Measured


def load_sweep(path: Path) -> Sweep:
    """Load the file at `path` and all that it names.

    Raises ConfigurationError, one line per problem, if one of them cannot be used.
    """
    problems = Problems()
    _, values = read_yaml(path)
    groups = values.get("push")
    settings = problems.validated(
        SweepSettings, {key: value for key, value in values.items() if key != "push"}, path
    )
    if not isinstance(groups, Mapping) or not groups:
        problems.add(path, "push is missing: must be a mapping of names to groups of keys")
        groups = {}
    if settings is None:
        raise problems.error()
    evaluation = load_evaluation(path.parent / settings.comparison)
    for name in settings.controllers:
        if name not in evaluation.entries:
            valid = ", ".join(evaluation.entries)
            problems.add(path, f"controllers: {name!r} is not valid: must be one of {valid}")
    plants_path = (path.parent / settings.comparison).parent / evaluation.settings.plants.file
    _, plants = read_yaml(plants_path)
    pushes = [_push(problems, path, name, group, plants) for name, group in groups.items()]
    if problems:
        raise problems.error()
    return Sweep(settings, evaluation, tuple(push for push in pushes if push is not None))


def run_sweep(sweep: Sweep, workers: Workers, told: Told) -> Iterator[Point]:
    """Insert; points in the order of the file, the controllers of each value together."""
    evaluation, settings = sweep.evaluation, sweep.evaluation.settings
    contenders = tuned(evaluation, workers, told, sweep.settings.controllers)
    thresholds = Thresholds(settings.trial.step_s, settings.trial.gentle_N)
    for push in sweep.pushes:
        for value, distribution in zip(push.settings.values, push.distributions, strict=True):
            yield from _points(
                sweep, contenders, push.name, value, distribution, thresholds, workers
            )
            told(push.name, 1, len(push.distributions))


def _points(
    sweep: Sweep,
    contenders: Mapping[str, Contender],
    push: str,
    value: float,
    distribution: PlantDistribution,
    thresholds: Thresholds,
    workers: Workers,
) -> Iterator[Point]:
    settings = sweep.evaluation.settings
    seed = settings.plants.seed
    cases = cases_of(drawn_plants(distribution, sweep.settings.plants, seed), seed)
    found = workers.insert([*contenders.values()], cases, settings.trial.rules())
    for name, records in zip(contenders, found, strict=True):
        figures = measured(records, thresholds)
        yield Point(push, value, name, success_rate(figures.is_success), figures)


def _push(
    problems: Problems, path: Path, name: str, group: object, plants: Mapping[str, object]
) -> Push | None:
    settings = problems.validated(PushSettings, group, path, "push", name)
    if settings is None:
        return None
    distributions = []
    for value in settings.values:
        changed: object = plants
        for key in settings.keys:
            try:
                changed = _changed(changed, key.split("."), value)
            except LookupError:
                problems.add(path, f"push.{name}.keys: {key!r} is no place in the plants' file")
                return None
        plant = problems.validated(PlantSettings, changed, path, "push", name)
        if plant is None:
            return None
        distributions.append(plant.distribution())
    try:
        for distribution in distributions:
            drawn_plants(distribution, 1, 0)
    except ValueError as error:
        problems.add(path, f"push.{name} is not valid: {error}")
        return None
    return Push(name, settings, tuple(distributions))


def _changed(tree: object, keys: Sequence[str], value: float) -> object:
    """The tree with a constant at the place that `keys` lead to; missing groups are made.

    Raises LookupError where they lead to no place.
    """
    if not keys:
        return {"constant": value}
    key, rest = keys[0], keys[1:]
    if isinstance(tree, Mapping):
        return {**tree, key: _changed(tree.get(key, {}), rest, value)}
    if isinstance(tree, tuple) and key.isdecimal():
        number = int(key)
        return (*tree[:number], _changed(tree[number], rest, value), *tree[number + 1 :])
    raise LookupError(f"there is no {key}")
