"""Checks across the files of a cell: what is valid alone must also fit the limits and the part."""

from collections.abc import Iterator

from controllers.limits import Limits
from controllers.settings import InsertionSettings, SkillSettings
from drivers.contract.device_settings import (
    ForceSensorSettings,
    StageSettings,
    TelemetrySettings,
)
from drivers.contract.settings import written
from hil.config.cell import CellSettings
from learning.part import ContactSettings, PartSettings


def part_problems(limits: Limits, part: PartSettings) -> Iterator[str]:
    """Yield a line for everything in a part's file that does not fit the limits."""
    insertion = part.insertion
    for attribute, limit, value, most in (
        ("stroke_m", "workspace_max_m", insertion.stroke_m, limits.workspace_max_m[2]),
        ("axial_step_m", "step_m", insertion.axial_step_m, limits.step_m[2]),
        ("finish_force_N", "force_N", insertion.finish_force_N, limits.force_N[2]),
    ):
        if value > most:
            key = f"insertion.{written(InsertionSettings, attribute, value)}"
            yield f"{key} is not valid: must not exceed {_limit(limits, limit)} along z"
    for limit in ("radial_stiffness_N_m", "axial_stiffness_N_m"):
        if part.contact.stiffness_N_m > getattr(limits, limit):
            stiffness = written(ContactSettings, "stiffness_N_m", part.contact.stiffness_N_m)
            yield f"contact.{stiffness} is not valid: must not exceed {_limit(limits, limit)}"


def cell_problems(limits: Limits, cell: CellSettings) -> Iterator[str]:
    """Yield a line for everything in skill that does not fit the limits."""
    depth = f"skill.{written(SkillSettings, 'start_depth_m', cell.skill.start_depth_m)}"
    if cell.skill.start_depth_m > limits.clear_depth_m:
        yield f"{depth} is not valid: must not exceed {_limit(limits, 'clear_depth_m')}"
    if cell.skill.start_depth_m < limits.workspace_min_m[2]:
        lowest = _limit(limits, "workspace_min_m")
        yield f"{depth} is not valid: must not be below {lowest} along z"
    if cell.skill.contact_force_N > min(limits.force_N):
        force = f"skill.{written(SkillSettings, 'contact_force_N', cell.skill.contact_force_N)}"
        yield f"{force} is not valid: must not exceed any of {_limit(limits, 'force_N')}"


def workspace_problems(machine: Limits) -> Iterator[str]:
    """Yield a line for each side of the workspace that leaves out x = y = 0, where parts wait."""
    sides = zip("xy", machine.workspace_min_m, machine.workspace_max_m, strict=False)
    for axis, low, high in sides:
        if low > 0.0:
            lowest = written(Limits, "workspace_min_m", machine.workspace_min_m)
            yield f"{lowest} is not valid: must not exceed 0 along {axis}"
        if high < 0.0:
            highest = written(Limits, "workspace_max_m", machine.workspace_max_m)
            yield f"{highest} is not valid: must not be below 0 along {axis}"


def stage_problems(machine: Limits, stage: StageSettings) -> Iterator[str]:
    """Yield a line for each limit of the stage itself that does not fit the machine's."""
    for attribute in ("speed_m_s", "angular_speed_rad_s"):
        value = getattr(stage, attribute)
        if value > getattr(machine, attribute):
            key = f"stage.{written(StageSettings, attribute, value)}"
            yield f"{key} is not valid: must not exceed {_limit(machine, attribute)}"
    if stage.acceleration_m_s2 < machine.deceleration_m_s2:
        key = f"stage.{written(StageSettings, 'acceleration_m_s2', stage.acceleration_m_s2)}"
        yield f"{key} is not valid: must not be below {_limit(machine, 'deceleration_m_s2')}"
    corners = (machine.workspace_min_m, machine.workspace_max_m)
    if any(abs(c) > t for corner in corners for c, t in zip(corner, stage.travel_m, strict=True)):
        key = f"stage.{written(StageSettings, 'travel_m', stage.travel_m)}"
        reach = " and ".join(
            _limit(machine, name) for name in ("workspace_min_m", "workspace_max_m")
        )
        yield f"{key} is not valid: must reach {reach}"


def rate_problems(
    limits: Limits, sensor: ForceSensorSettings, devices: dict[str, TelemetrySettings]
) -> Iterator[str]:
    """Yield a line for each device that reports too seldom for the limits on age."""
    for attribute in ("sample_age_s", "heartbeat_s"):
        yield from _rate_problem(limits, attribute, "force_sensor.rate_Hz", sensor.rate_Hz)
    for name, settings in devices.items():
        key = f"{name}.telemetry_rate_Hz"
        yield from _rate_problem(limits, "device_age_s", key, settings.telemetry_rate_Hz)


def _rate_problem(limits: Limits, attribute: str, key: str, rate_Hz: float) -> Iterator[str]:
    longest_s: float = getattr(limits, attribute)
    if rate_Hz * longest_s < 1.0:
        yield (
            f"{key} = {rate_Hz:.12g} is not valid: must be at least {1.0 / longest_s:.12g}, "
            f"the rate that {_limit(limits, attribute)} asks for"
        )


def _limit(limits: Limits, attribute: str) -> str:
    return f"the limit {written(Limits, attribute, getattr(limits, attribute))}"
