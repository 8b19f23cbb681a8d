"""The limits of the machine, and how a part may tighten them."""

from typing import Annotated

from annotated_types import Ge, Gt, Le
from pydantic import Field, model_validator

from drivers.contract.errors import ConfigurationError
from drivers.contract.settings import (
    DEGREES,
    KILO,
    MICRO,
    MILLI,
    Positive,
    PositiveTriple,
    Settings,
    written,
)

_Coordinate = Annotated[float, Ge(-100_000), Le(100_000)]
_Corner = Annotated[tuple[_Coordinate, _Coordinate, _Coordinate], MICRO]
_Step = Annotated[float, Gt(0), Le(1_000)]
_Force = Annotated[float, Gt(0), Le(10_000)]
_Duration = Annotated[float, Gt(0), Le(1_000), MILLI]
_Stiffness = Annotated[float, Ge(0.1), Le(10_000), KILO]
_SLOWEST = Ge(0.01)
"""[mm/s]"""
_SLOWEST_TURN = Ge(0.001)
"""[deg/s]"""

CREEP_SHARE = 0.1
"""Largest share of the speed limit that still is a creep speed: the governor needs the rest."""


class Limits(Settings):
    """Everything that the supervisor enforces; no key has a default or can be left out.

    The ranges refuse what no cell can mean. A value within them can still be too weak for a rig.
    """

    speed_m_s: Annotated[float, _SLOWEST, Le(5), MILLI] = Field(alias="speed_limit_mm_s")
    angular_speed_rad_s: Annotated[float, _SLOWEST_TURN, Le(5), DEGREES] = Field(
        alias="angular_speed_limit_deg_s"
    )
    arm_speed_m_s: Annotated[float, Ge(0.1), Le(250), MILLI] = Field(alias="arm_speed_limit_mm_s")
    step_m: Annotated[tuple[_Step, _Step, _Step], MICRO] = Field(alias="step_box_um")
    rotation_step_rad: Annotated[float, Gt(0), Le(1), DEGREES] = Field(
        alias="rotation_step_limit_deg"
    )
    workspace_min_m: _Corner = Field(alias="workspace_min_um")
    workspace_max_m: _Corner = Field(alias="workspace_max_um")
    tilt_rad: Annotated[float, Gt(0), Le(5), DEGREES] = Field(alias="tilt_limit_deg")
    clear_depth_m: Annotated[float, Ge(-100_000), Le(-20), MICRO] = Field(alias="clear_depth_um")
    """Depth above which the shaft cannot touch the part."""
    arm_tolerance_m: Annotated[float, Gt(0), Le(1_000), MICRO] = Field(alias="arm_tolerance_um")

    force_N: Annotated[tuple[_Force, _Force, _Force], MILLI] = Field(alias="force_limit_mN")
    force_rate_N_s: Annotated[float, Gt(0), Le(1_000)] = Field(alias="force_rate_limit_N_s")
    gentle_force_N: Annotated[_Force, MILLI] = Field(alias="gentle_force_mN")
    """Force that a part stands for any time; the impulse counts what exceeds it."""
    impulse_N_s: Annotated[float, Gt(0), Le(1_000), MILLI] = Field(alias="impulse_limit_mN_s")

    sample_age_s: _Duration = Field(alias="sample_age_limit_ms")
    device_age_s: _Duration = Field(alias="device_age_limit_ms")
    proposal_age_s: _Duration = Field(alias="proposal_age_limit_ms")
    heartbeat_s: _Duration = Field(alias="heartbeat_limit_ms")

    reaction_s: Annotated[float, Ge(0.1), Le(1_000), MILLI] = Field(alias="reaction_time_ms")
    """From a force at the sensor to the stage beginning to brake."""
    deceleration_m_s2: Annotated[float, Ge(1), Le(100_000), MILLI] = Field(
        alias="deceleration_mm_s2"
    )
    radial_stiffness_N_m: _Stiffness = Field(alias="radial_stiffness_mN_um")
    """Most that a radial force can grow per length of radial travel."""
    axial_stiffness_N_m: _Stiffness = Field(alias="axial_stiffness_mN_um")
    """Most that any force can grow per length of axial travel, an edge passing a rim included."""
    lever_m: Annotated[float, Ge(100), Le(1_000_000), MICRO] = Field(alias="lever_um")
    """Longest distance from the stage's pivot to a contact: turns rotation into radial travel."""
    creep_speed_m_s: Annotated[float, Ge(0.001), Le(0.5), MILLI] = Field(alias="creep_speed_mm_s")
    """The governor does not go below this speed; the force limit stops what creep does not."""
    uncertainty_sigmas: Annotated[float, Ge(0), Le(10)]

    @model_validator(mode="after")
    def _check(self) -> "Limits":
        for axis, low, high in zip("xyz", self.workspace_min_m, self.workspace_max_m, strict=True):
            if not low < high:
                lowest = written(Limits, "workspace_min_m", self.workspace_min_m)
                highest = written(Limits, "workspace_max_m", self.workspace_max_m)
                raise ValueError(f"{lowest} is not valid: must be below {highest} along {axis}")
        if self.gentle_force_N > min(self.force_N[:2]):
            gentle = written(Limits, "gentle_force_N", self.gentle_force_N)
            force = written(Limits, "force_N", self.force_N)
            raise ValueError(f"{gentle} is not valid: must not exceed {force} along x or y")
        if self.creep_speed_m_s > CREEP_SHARE * self.speed_m_s:
            creep = written(Limits, "creep_speed_m_s", self.creep_speed_m_s)
            speed = written(Limits, "speed_m_s", self.speed_m_s)
            raise ValueError(f"{creep} is not valid: must not exceed a tenth of {speed}")
        return self


class PartLimits(Settings):
    """Limits of one part. Each may only tighten the machine's."""

    speed_m_s: Annotated[float, _SLOWEST, MILLI] | None = Field(None, alias="speed_limit_mm_s")
    angular_speed_rad_s: Annotated[float, _SLOWEST_TURN, DEGREES] | None = Field(
        None, alias="angular_speed_limit_deg_s"
    )
    step_m: Annotated[PositiveTriple, MICRO] | None = Field(None, alias="step_box_um")
    force_N: Annotated[PositiveTriple, MILLI] | None = Field(None, alias="force_limit_mN")
    force_rate_N_s: Positive | None = Field(None, alias="force_rate_limit_N_s")
    gentle_force_N: Annotated[Positive, MILLI] | None = Field(None, alias="gentle_force_mN")
    impulse_N_s: Annotated[Positive, MILLI] | None = Field(None, alias="impulse_limit_mN_s")


def tighten(machine: Limits, part: PartLimits) -> Limits:
    """Return the machine's limits with the part's put in their place.

    Raises ConfigurationError, one line per key, if some of the part's limits are looser than the
    machine's.
    """
    given = {name: getattr(part, name) for name in PartLimits.model_fields}
    changes = {name: value for name, value in given.items() if value is not None}
    looser = []
    for name, value in changes.items():
        allowed = getattr(machine, name)
        pairs = zip(value, allowed, strict=True) if isinstance(value, tuple) else [(value, allowed)]
        if any(v > a for v, a in pairs):
            looser.append(
                f"{written(Limits, name, value)} is not valid: a part may only tighten the "
                f"machine's {written(Limits, name, allowed)}"
            )
    if looser:
        raise ConfigurationError("\n".join(looser))
    return machine.model_copy(update=changes)
