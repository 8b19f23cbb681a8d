"""Controllers that look ahead over a belief, made from the settings of a cell."""

from collections.abc import Callable, Iterator

import numpy as np

from controllers.belief_controller import BeliefController
from controllers.contact_pose import (
    ContactModel,
    ContactPoseFilter,
    FilterEffort,
    LookAheadSettings,
    Noise,
    Prior,
    StageNoise,
)
from controllers.insertion import Controller
from controllers.limits import Limits
from controllers.messages import Observation
from controllers.settings import LookAheadControllerSettings
from drivers.contract.errors import ConfigurationError
from drivers.contract.messages import Pose, Wrench
from drivers.contract.settings import written
from hil.config import CellConfig
from learning.part import PartSettings

_ZERO6 = (0.0,) * 6


def look_ahead_factory(
    settings: LookAheadControllerSettings,
    config: CellConfig,
    name: str,
    sensor_noise: Wrench,
    generator: np.random.Generator,
) -> Callable[[], Controller]:
    """Return what makes controller `name` anew; all code that it runs has been loaded by then.

    Raises ConfigurationError if the settings do not fit the limits or the part.
    """
    part, limits = config.part, config.limits
    if problems := [*_problems(settings, limits, part)]:
        place = f"{config.sources[0].path}: controllers.{name}"
        raise ConfigurationError("\n".join(f"{place}.{problem}" for problem in problems))
    model = ContactModel(
        part.simulated_part(), part.simulated_shaft(), config.force_sensor.settings.origin_m
    )
    prior = Prior(
        part.alignment.position_error_m,
        part.alignment.tilt_error_rad,
        settings.stiffness_N_m,
        settings.clearance_m,
        settings.friction,
    )
    noise = Noise(
        force_N=max(sensor_noise[:3]),
        torque_Nm=max(sensor_noise[3:]),
        place_m=settings.place_std_m,
        model=settings.model_error,
    )
    stage = StageNoise(settings.report_std_m, settings.step_std_m)
    effort = FilterEffort(settings.hypotheses, settings.moves)
    look_ahead = LookAheadSettings(
        limits.step_m,
        limits.rotation_step_rad,
        settings.axial_steps_m,
        settings.force_budget_N,
        settings.quantile,
        settings.samples,
    )

    def new(chance: np.random.Generator) -> Controller:
        pose_filter = ContactPoseFilter(model, prior, noise, stage, chance, effort)
        return BeliefController(pose_filter, model, look_ahead, chance)

    _rehearse(new(np.random.default_rng(0)))
    return lambda: new(generator)


def _problems(
    settings: LookAheadControllerSettings, limits: Limits, part: PartSettings
) -> Iterator[str]:
    """Yield a line for everything that does not fit the limits or the part."""
    if settings.axial_step_m[1] > limits.step_m[2]:
        steps = written(LookAheadControllerSettings, "axial_step_m", settings.axial_step_m)
        box = written(Limits, "step_m", limits.step_m)
        yield f"{steps} is not valid: must not exceed the limit {box} along z"
    drawn_m = part.holes[0].diameter_m - part.shaft.diameter_m
    no_bore_m = drawn_m - min(hole.diameter_m for hole in part.holes)
    if settings.clearance_m[0] <= no_bore_m:
        clearance = written(LookAheadControllerSettings, "clearance_m", settings.clearance_m)
        yield (
            f"{clearance} is not valid: must be greater than {no_bore_m * 1e6:.12g}, "
            "at which the narrowest hole is closed"
        )


def _rehearse(controller: Controller) -> None:
    """Let a controller work on two observations: what is compiled is loaded at its first use."""
    for depth_m in (0.0, 1e-5):
        pose = Pose((0.0, 0.0, depth_m))
        seen = Observation(0, 0, _ZERO6, _ZERO6, pose, (0.0, 0.0, depth_m), pose)
        for _ in controller.think(seen):
            pass
        controller.step(seen)
