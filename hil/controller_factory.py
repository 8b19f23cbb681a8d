"""The controllers that a cell's file can name, made from their settings."""

import math
from collections.abc import Callable
from functools import partial

import numpy as np

from controllers.insertion import Controller
from controllers.limits import Limits
from controllers.proportional import ProportionalController
from controllers.settings import LookAheadControllerSettings, ProportionalSettings
from drivers.contract.errors import ConfigurationError
from drivers.contract.messages import Wrench
from drivers.contract.settings import MICRO, written
from hil.config import CellConfig
from hil.look_ahead import look_ahead_factory
from learning.policy.policy import Policy
from learning.skill_controller import SkillController

_ROUNDING = 1.0 + 1e-9
"""The same limit may have been converted to SI in two ways."""


def controller_factory(
    config: CellConfig, name: str, sensor_noise: Wrench, generator: np.random.Generator
) -> Callable[[], Controller]:
    """Return what makes controller `name` anew, once for each insertion.

    `sensor_noise` is the standard deviation of a reading; all chance comes from `generator`.
    Raises ConfigurationError if the configuration does not name it, or if it may ask for more
    than the limits allow, or does not fit the part.
    """
    if name not in config.controllers:
        valid = ", ".join(sorted(config.controllers))
        raise ConfigurationError(f"controller {name!r} is not valid: one of {valid} is")
    choice = config.controllers[name]
    if isinstance(choice, ProportionalSettings):
        return partial(ProportionalController, choice, config.part.insertion.axial_step_m)
    if isinstance(choice, LookAheadControllerSettings):
        return look_ahead_factory(choice, config, name, sensor_noise, generator)
    policy = choice.stored.policy
    sensor_m = config.force_sensor.settings.origin_m
    if problem := _too_far(policy, config.limits) or policy.torque_problem(sensor_m):
        raise ConfigurationError(
            f"{config.sources[0].path}: controllers.{name}.policy = {choice.written!r} is not "
            f"valid: {problem}"
        )
    return partial(SkillController, policy)


def _too_far(policy: Policy, limits: Limits) -> str:
    """Return in words how the policy's moves exceed the limits, or nothing."""
    box_m = policy.expert.step_box_m
    if any(b > limit * _ROUNDING for b, limit in zip(box_m, limits.step_m, strict=True)):
        box = ", ".join(f"{v:.12g}" for v in MICRO.to_written(box_m))
        limit = written(Limits, "step_m", limits.step_m)
        return f"its step box [{box}] um must not exceed the limit {limit}"
    for name, scale in policy.outputs:
        if name.startswith("turn_") and scale > limits.rotation_step_rad * _ROUNDING:
            limit = written(Limits, "rotation_step_rad", limits.rotation_step_rad)
            return (
                f"its {name} of up to {math.degrees(scale):.12g} deg must not exceed "
                f"the limit {limit}"
            )
    return ""
