"""Controllers that take part in a comparison: what makes one anew for each insertion."""

from dataclasses import dataclass
from typing import Protocol

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
from controllers.messages import Move, Observation
from learning.evaluation.admittance import AdmittanceController
from learning.evaluation.plant import Plant
from learning.evaluation.privileged import PrivilegedController
from learning.evaluation.settings import BeliefSettings
from learning.evaluation.trial import Trial
from learning.policy.policy import Policy
from learning.skill_controller import SkillController
from simulator.geometry import Hole, Part


class Contender(Protocol):
    """Makes controllers; it travels to other processes."""

    def controller(self, plant: Plant, trial: Trial, generator: np.random.Generator) -> Controller:
        """Return a controller for a trial that has not begun."""
        ...


class _Proportional(Controller):
    def __init__(self, gain_m_N: float, axial_step_m: float) -> None:
        self._gain_m_N = gain_m_N
        self._axial_step_m = axial_step_m

    def step(self, observation: Observation) -> Move:
        fx, fy = observation.wrench[:2]
        return Move((-self._gain_m_N * fx, -self._gain_m_N * fy, self._axial_step_m))


@dataclass(frozen=True, slots=True)
class Proportional:
    """The P-controller (eq. 6)."""

    gain_m_N: float
    axial_step_m: float

    def controller(self, plant: Plant, trial: Trial, generator: np.random.Generator) -> Controller:
        """Return a controller for a trial that has not begun."""
        return _Proportional(self.gain_m_N, self.axial_step_m)


@dataclass(frozen=True, slots=True)
class Admittance:
    """See `learning.evaluation.admittance`."""

    lateral_m_N: float
    axial_m_N: float
    lag_steps: float
    axial_step_m: float

    def controller(self, plant: Plant, trial: Trial, generator: np.random.Generator) -> Controller:
        """Return a controller for a trial that has not begun."""
        return AdmittanceController(
            self.lateral_m_N, self.axial_m_N, self.lag_steps, self.axial_step_m
        )


@dataclass(frozen=True, slots=True, eq=False)
class Skill:
    """A trained policy on top of its expert."""

    policy: Policy

    def controller(self, plant: Plant, trial: Trial, generator: np.random.Generator) -> Controller:
        """Return a controller for a trial that has not begun."""
        return SkillController(self.policy)


@dataclass(frozen=True, slots=True)
class LookAhead:
    """The contact-pose filter with a look ahead; it knows the drawing of part and shaft.

    Of the drawing the clearance is wrong: it is the middle of what is held possible.
    """

    settings: BeliefSettings

    def controller(self, plant: Plant, trial: Trial, generator: np.random.Generator) -> Controller:
        """Return a controller for a trial that has not begun."""
        s, rules = self.settings, trial.rules
        bore_m = plant.shaft.diameter_m + 0.5 * sum(s.clearance_m)
        drawn = Part(tuple(Hole(bore_m, h.thickness_m, h.gap_m, h.entry) for h in plant.part.holes))
        model = ContactModel(drawn, plant.shaft, rules.sensor_m)
        pose_filter = ContactPoseFilter(
            model,
            Prior(s.position_error_m, s.tilt_error_rad, s.stiffness_N_m, s.clearance_m, s.friction),
            Noise(s.force_noise_N, s.torque_noise_Nm, s.place_std_m, s.model_error),
            StageNoise(s.report_std_m, s.step_std_m),
            generator,
            FilterEffort(s.hypotheses, s.moves),
        )
        look_ahead = LookAheadSettings(
            rules.step_box_m, s.turn_rad, s.axial_steps_m, s.force_budget_N, s.quantile, s.samples
        )
        return BeliefController(pose_filter, model, look_ahead, generator)


@dataclass(frozen=True, slots=True)
class Privileged:
    """Told the true pose and plant; see `learning.evaluation.privileged`."""

    tilt: bool

    def controller(self, plant: Plant, trial: Trial, generator: np.random.Generator) -> Controller:
        """Return a controller for a trial that has not begun."""
        return PrivilegedController(plant, trial.rules, lambda: trial.shaft_pose, self.tilt)
