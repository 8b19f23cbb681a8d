"""Loads a cell: all its files are read, validated and checked against one another."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Generic, TypeVar, cast

from controllers.limits import Limits, PartLimits, tighten
from controllers.settings import (
    FilterSettings,
    LookAheadControllerSettings,
    ProportionalSettings,
    SkillSettings,
)
from drivers.backends import DeviceClass, settings_class
from drivers.contract.configuration.problems import Problems
from drivers.contract.configuration.yaml_loader import SourceFile, read_yaml
from drivers.contract.device_settings import (
    ForceSensorSettings,
    StageSettings,
    TelemetrySettings,
)
from drivers.contract.errors import ConfigurationError, PolicyError
from drivers.contract.settings import Settings
from hil.config.cell import ArmPoses, CellSettings, PolicySettings
from hil.config.checks import (
    cell_problems,
    part_problems,
    rate_problems,
    stage_problems,
    workspace_problems,
)
from learning.part import PartSettings
from learning.policy.file import StoredPolicy, read_policy

DeviceSettings = TypeVar("DeviceSettings", bound=Settings)


@dataclass(frozen=True, slots=True)
class DeviceConfig(Generic[DeviceSettings]):
    """A device: its backend's name and the settings of that backend's class."""

    backend: str
    settings: DeviceSettings


@dataclass(frozen=True, slots=True)
class PolicyConfig:
    """A controller that runs a trained policy."""

    written: str
    """The file's name as the cell states it."""
    path: Path
    stored: StoredPolicy


ControllerConfig = ProportionalSettings | LookAheadControllerSettings | PolicyConfig


@dataclass(frozen=True, slots=True)
class CellConfig:
    """Everything that a cell is built from, valid as a whole."""

    limits: Limits
    """The machine's, tightened by the part's and by the speeds that the stage allows itself."""
    part: PartSettings
    force_sensor: DeviceConfig[ForceSensorSettings]
    stage: DeviceConfig[StageSettings]
    arm: DeviceConfig[TelemetrySettings]
    gripper: DeviceConfig[TelemetrySettings]
    arm_poses: ArmPoses
    filter: FilterSettings
    skill: SkillSettings
    controllers: Mapping[str, ControllerConfig]
    sources: tuple[SourceFile, SourceFile, SourceFile]
    """The files of cell, limits and part as they were read."""


def load_cell(path: Path, part_override: Path | None = None) -> CellConfig:
    """Load the cell at `path`, with the part at `part_override` in place of the cell's own.

    Raises ConfigurationError, one line per problem, if any of its files cannot be used. The files
    that a cell names are looked at once the cell's own is valid, and what must fit together once
    each file is.
    """
    problems = Problems()
    cell_source, values = read_yaml(path)
    cell = problems.validated(CellSettings, values, path)
    sensor = _device(problems, path, values, DeviceClass.FORCE_SENSOR, ForceSensorSettings)
    stage = _device(problems, path, values, DeviceClass.STAGE, StageSettings)
    arm = _device(problems, path, values, DeviceClass.ARM, TelemetrySettings)
    gripper = _device(problems, path, values, DeviceClass.GRIPPER, TelemetrySettings)
    controllers = _controllers(problems, path, values)
    if not (cell and sensor and stage and arm and gripper) or problems:
        raise problems.error()

    limits_path = path.parent / cell.limits
    part_path = part_override or path.parent / cell.part
    limits_source, limits_values = read_yaml(limits_path)
    part_source, part_values = read_yaml(part_path)
    machine = problems.validated(Limits, limits_values, limits_path)
    part = problems.validated(PartSettings, part_values, part_path)
    if not (machine and part):
        raise problems.error()

    limits = _tightened(problems, part_path, machine, part.limits)
    telemetry = {"stage": stage.settings, "arm": arm.settings, "gripper": gripper.settings}
    for file, lines in (
        (part_path, part_problems(limits, part)),
        (path, cell_problems(limits, cell)),
        (limits_path, workspace_problems(machine)),
        (path, stage_problems(machine, stage.settings)),
        (path, rate_problems(limits, sensor.settings, telemetry)),
    ):
        for line in lines:
            problems.add(file, line)
    if problems:
        raise problems.error()
    return CellConfig(
        limits=_slowed(limits, stage.settings),
        part=part,
        force_sensor=sensor,
        stage=stage,
        arm=arm,
        gripper=gripper,
        arm_poses=cell.arm_poses,
        filter=cell.filter,
        skill=cell.skill,
        controllers=controllers,
        sources=(cell_source, limits_source, part_source),
    )


def _device(
    problems: Problems,
    path: Path,
    values: Mapping[str, object],
    device: DeviceClass,
    kind: type[DeviceSettings],
) -> DeviceConfig[DeviceSettings] | None:
    """Return a device of a cell's file, or None after noting why not.

    A group that is missing or names no backend is noted with the rest of the file.
    """
    group = values.get(device)
    backend = group.get("backend") if isinstance(group, Mapping) else None
    if not isinstance(group, Mapping) or not isinstance(backend, str):
        return None
    try:
        model = cast(type[DeviceSettings], settings_class(device, backend))
    except ConfigurationError as error:
        problems.add(path, str(error))
        return None
    own = {key: value for key, value in group.items() if key != "backend"}
    settings = problems.validated(model, own, path, device)
    return None if settings is None else DeviceConfig(backend, settings)


def _controllers(
    problems: Problems, path: Path, values: Mapping[str, object]
) -> Mapping[str, ControllerConfig]:
    """Return the controllers of a cell's file, without those that it notes a problem of.

    One that is no group or has no valid kind is noted with the rest of the file.
    """
    groups = values.get("controllers")
    controllers: dict[str, ControllerConfig] = {}
    for name, group in groups.items() if isinstance(groups, Mapping) else ():
        kind = group.get("kind") if isinstance(group, Mapping) else None
        place = ("controllers", str(name))
        if kind == "proportional":
            proportional = problems.validated(ProportionalSettings, group, path, *place)
            if proportional is not None:
                controllers[name] = proportional
        elif kind == "look_ahead":
            look_ahead = problems.validated(LookAheadControllerSettings, group, path, *place)
            if look_ahead is not None:
                controllers[name] = look_ahead
        elif kind == "skill":
            skill = problems.validated(PolicySettings, group, path, *place)
            policy = None if skill is None else _policy(problems, path, name, skill.policy)
            if policy is not None:
                controllers[name] = policy
    return controllers


def _policy(problems: Problems, path: Path, name: str, written: str) -> PolicyConfig | None:
    """Return a policy that the cell at `path` names, or None after noting why not."""
    file = path.parent / written
    try:
        return PolicyConfig(written, file, read_policy(file))
    except PolicyError as error:
        problems.add(path, f"controllers.{name}.policy = {written!r} is not valid: {error}")
        return None


def _tightened(problems: Problems, path: Path, machine: Limits, part: PartLimits) -> Limits:
    try:
        return tighten(machine, part)
    except ConfigurationError as error:
        for line in str(error).splitlines():
            problems.add(path, f"limits.{line}")
        return machine


def _slowed(limits: Limits, stage: StageSettings) -> Limits:
    """Return `limits` with the stage's own speed limits where those are lower."""
    names = ("speed_m_s", "angular_speed_rad_s")
    slower = {name: min(getattr(limits, name), getattr(stage, name)) for name in names}
    return limits.model_copy(update=slower)
