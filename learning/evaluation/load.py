"""Loads a comparison: its file, and every file that it names, before anything runs."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

from drivers.contract.configuration.problems import Problems
from drivers.contract.configuration.yaml_loader import SourceFile, read_yaml
from drivers.contract.errors import ConfigurationError, PolicyError
from drivers.contract.settings import written
from learning.evaluation.contenders import Contender, LookAhead, Privileged, Proportional, Skill
from learning.evaluation.plant import Plant, drawn_plants
from learning.evaluation.settings import (
    KINDS,
    AdmittanceSettings,
    BeliefSettings,
    EvaluationSettings,
    FixedSettings,
    PolicySettings,
    PrivilegedSettings,
    TrialSettings,
    TunedSettings,
)
from learning.policy.file import load_policy
from learning.randomisation import load_randomisation
from simulator.randomisation.plants import PlantDistribution

Untuned = TunedSettings | AdmittanceSettings
"""Settings whose free parameters are found on training plants."""


@dataclass(frozen=True, slots=True)
class Entry:
    """A controller of the comparison."""

    kind: str
    contender: Contender | Untuned
    """Ready, or still to be tuned."""


@dataclass(frozen=True, slots=True)
class Evaluation:
    """All that a comparison needs, valid as a whole."""

    settings: EvaluationSettings
    distribution: PlantDistribution
    entries: Mapping[str, Entry]
    """By the name in the file, in its order."""
    source: SourceFile

    def plants(self) -> list[Plant]:
        """Draw the plants to judge on."""
        return drawn_plants(
            self.distribution, self.settings.plants.count, self.settings.plants.seed
        )

    def training_plants(self) -> list[Plant]:
        """Draw the plants to tune on."""
        return drawn_plants(
            self.distribution, self.settings.tuning.count, self.settings.tuning.seed
        )


def load_evaluation(path: Path, count: int | None = None, seed: int | None = None) -> Evaluation:
    """Load the file at `path`, with `count` plants and `seed` in place of its own where given.

    Raises ConfigurationError, one line per problem, if it or a file that it names cannot be used.
    """
    problems = Problems()
    source, values = read_yaml(path)
    groups = values.get("controllers")
    rest = {key: value for key, value in values.items() if key != "controllers"}
    settings = problems.validated(EvaluationSettings, rest, path)
    entries: dict[str, Entry] = {}
    names: list[str] = []
    if not isinstance(groups, Mapping) or not groups:
        problems.add(path, "controllers is missing: must be a mapping of names to groups of keys")
    else:
        names = list(groups)
        for name, group in groups.items():
            entry = _entry(problems, path, name, group)
            if entry is not None:
                entries[name] = entry
    if settings is None:
        raise problems.error()
    settings = _overridden(settings, count, seed)
    distribution = _distribution(problems, path, "plants.file", settings.plants.file)
    if settings.tuning.seed == settings.plants.seed:
        problems.add(
            path,
            f"tuning.seed = {settings.tuning.seed} is not valid: must differ from plants.seed, or "
            "controllers are judged on the plants that they were tuned on",
        )
    for line in (*_step_problems(settings, entries), *_torque_problems(settings, entries)):
        problems.add(path, line)
    for name in settings.figures.compared:
        if names and name not in names:
            problems.add(
                path,
                f"figures.compared names {name!r}, which is no controller: must be two of "
                f"{', '.join(names)}",
            )
    if problems or distribution is None:
        raise problems.error()
    evaluation = Evaluation(settings, distribution, entries, source)
    _check_plants(evaluation, path)
    return evaluation


def _overridden(
    settings: EvaluationSettings, count: int | None, seed: int | None
) -> EvaluationSettings:
    given = {name: v for name, v in (("count", count), ("seed", seed)) if v is not None}
    return settings.model_copy(update={"plants": settings.plants.model_copy(update=given)})


def _step_problems(settings: EvaluationSettings, entries: Mapping[str, Entry]) -> Iterator[str]:
    """Yield a line for each controller that looks ahead to steps that no trial makes."""
    longest_m, turn_rad = settings.trial.step_box_m[2], settings.trial.turn_rad
    for name, entry in entries.items():
        if not isinstance(entry.contender, LookAhead):
            continue
        asked = entry.contender.settings
        for attribute, value, is_possible, limit in (
            (
                "axial_step_m",
                asked.axial_step_m,
                asked.axial_step_m[1] <= longest_m,
                written(TrialSettings, "step_box_m", settings.trial.step_box_m),
            ),
            (
                "turn_rad",
                asked.turn_rad,
                asked.turn_rad <= turn_rad,
                written(TrialSettings, "turn_rad", turn_rad),
            ),
        ):
            if not is_possible:
                key = written(BeliefSettings, attribute, value)
                yield f"controllers.{name}.{key} is not valid: must not exceed trial.{limit}"


def _torque_problems(settings: EvaluationSettings, entries: Mapping[str, Entry]) -> Iterator[str]:
    """Yield a line for each policy that reads the torques of a sensor elsewhere."""
    for name, entry in entries.items():
        if isinstance(entry.contender, Skill):
            problem = entry.contender.policy.torque_problem(settings.trial.sensor_m)
            if problem:
                yield f"controllers.{name}.policy is not valid: {problem}"


def _check_plants(evaluation: Evaluation, path: Path) -> None:
    """Raise ConfigurationError if the plants have what a trial has not."""
    try:
        drawn_plants(evaluation.distribution, 1, evaluation.settings.plants.seed)
    except ValueError as error:
        file = evaluation.settings.plants.file
        raise ConfigurationError(f"{path}: plants.file = {file!r} is not valid: {error}") from error


def _entry(problems: Problems, path: Path, name: str, group: object) -> Entry | None:
    """Return a controller, or None after noting why not."""
    place = f"controllers.{name}"
    if not isinstance(group, Mapping):
        problems.add(path, f"{place} is not valid: must be a group of keys, kind among them")
        return None
    kind = group.get("kind")
    if not isinstance(kind, str) or kind not in KINDS:
        shown = (
            f"{place}.kind = {kind!r} is not valid"
            if "kind" in group
            else f"{place}.kind is missing"
        )
        problems.add(path, f"{shown}: must be one of {', '.join(KINDS)}")
        return None
    settings = problems.validated(KINDS[kind], group, path, "controllers", name)
    if settings is None:
        return None
    contender = _contender(problems, path, name, settings)
    return None if contender is None else Entry(kind, contender)


def _contender(
    problems: Problems, path: Path, name: str, settings: object
) -> Contender | Untuned | None:
    match settings:
        case TunedSettings() | AdmittanceSettings():
            return settings
        case FixedSettings():
            gain = settings.gain_factor * settings.force_jacobian_m_N
            return Proportional(gain, settings.axial_step_m)
        case PrivilegedSettings():
            return Privileged(settings.tilt)
        case PolicySettings():
            return _skill(problems, path, name, settings.policy)
        case BeliefSettings():
            return LookAhead(settings)
    raise LookupError(f"{type(settings).__name__} are settings of no controller")


def _skill(problems: Problems, path: Path, name: str, written_path: str) -> Skill | None:
    try:
        return Skill(load_policy(path.parent / written_path))
    except PolicyError as error:
        key = f"controllers.{name}.policy"
        problems.add(path, f"{key} = {written_path!r} is not valid: {error}")
        return None


def _distribution(
    problems: Problems, path: Path, key: str, written_path: str
) -> PlantDistribution | None:
    try:
        return load_randomisation(path.parent / written_path)
    except ConfigurationError as error:
        for line in str(error).splitlines():
            problems.add(path, f"{key} = {written_path!r} is not valid: {line}")
        return None
