"""A training as its files ask for it: settings, part, environment."""

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from drivers.contract.configuration.problems import Problems
from drivers.contract.configuration.yaml_loader import SourceFile, read_yaml
from drivers.contract.settings import written
from learning.environments.config import DualPegConfig, RewardWeights
from learning.environments.core import DualPegCore
from learning.part import PartSettings
from learning.policy.expert import Expert
from learning.settings import TaskSettings, TrainingSettings
from learning.task import InsertionTask
from simulator.checks import FloatArray

_TRAINING_STATES, _EVALUATION_STATES = 0, 1
"""What a key is for: the second number that it is made from."""


@dataclass(frozen=True, slots=True)
class Plan:
    """What is trained, and on what."""

    settings: TrainingSettings
    part: PartSettings
    sources: tuple[SourceFile, SourceFile]
    """The files of training and part as they were read."""

    @property
    def environment(self) -> DualPegConfig:
        """The part as an environment, without noise on what is observed."""
        task, part = self.settings.task, self.part
        return DualPegConfig(
            part=part.simulated_part(),
            shaft=part.simulated_shaft(),
            law=part.contact_law(),
            step_box_m=task.step_box_m,
            force_limit_N=task.force_limit_N,
            stroke_m=part.insertion.stroke_m,
            start_depth_m=task.start_depth_m,
            position_error_m=part.alignment.position_error_m,
            tilt_error_rad=part.alignment.tilt_error_rad,
            steps_max=part.insertion.steps_max,
            reward=RewardWeights(task.reward.alpha_x, task.reward.alpha_y, task.reward.omega),
        )

    @property
    def noisy_environment(self) -> DualPegConfig:
        """The same with the noise of eq. (16), to train in."""
        sigma, clean = self.settings.task.state_sigma, self.environment
        x, y, z = clean.force_limit_N
        return replace(
            clean,
            force_noise_N=(sigma * x, sigma * y, sigma * z),
            depth_noise_m=sigma * clean.stroke_m,
        )

    @property
    def expert(self) -> Expert:
        """The expert that the policy corrects (eq. 6)."""
        feedback = self.settings.expert
        return Expert(
            gain_m_N=feedback.gain_factor * feedback.force_jacobian_m_N,
            axial_step_m=self.part.insertion.axial_step_m,
            step_box_m=self.settings.task.step_box_m,
        )

    def task(self) -> InsertionTask:
        """Make the insertion to train on."""
        return InsertionTask(self.noisy_environment, self.expert, self.settings.residual.range_m)

    def training_poses(self, seed: int) -> FloatArray:
        """Return the start poses (n, 5) that the rounds of a seed draw from."""
        return self._poses(self.settings.initial_states, seed, _TRAINING_STATES)

    def evaluation_poses(self, seed: int) -> FloatArray:
        """Return start poses (n, 5) that no round has seen."""
        return self._poses(self.settings.evaluation.initial_states, seed, _EVALUATION_STATES)

    def _poses(self, n: int, seed: int, purpose: int) -> FloatArray:
        (key,) = np.random.SeedSequence((seed, purpose)).generate_state(1, np.uint64)
        return DualPegCore(self.environment, n).reset(key).pose


def load_plan(path: Path, part_override: Path | None = None) -> Plan:
    """Load the training at `path`, with the part at `part_override` in place of the one it names.

    Raises ConfigurationError, one line per problem, if one of the files cannot be used.
    """
    problems = Problems()
    source, values = read_yaml(path)
    settings = problems.validated(TrainingSettings, values, path)
    if settings is None:
        raise problems.error()
    part_path = part_override or path.parent / settings.part
    part_source, part_values = read_yaml(part_path)
    part = problems.validated(PartSettings, part_values, part_path)
    if part is None:
        raise problems.error()
    longest_m = settings.task.step_box_m[2]
    if part.insertion.axial_step_m > longest_m:
        step = written(type(part.insertion), "axial_step_m", part.insertion.axial_step_m)
        box = written(TaskSettings, "step_box_m", settings.task.step_box_m)
        problems.add(
            part_path, f"insertion.{step} is not valid: must not exceed z of task.{box} in {path}"
        )
    if settings.task.start_depth_m < -part.insertion.stroke_m:
        depth = written(TaskSettings, "start_depth_m", settings.task.start_depth_m)
        stroke = written(type(part.insertion), "stroke_m", part.insertion.stroke_m)
        problems.add(
            path, f"task.{depth} is not valid: must not be further off than the part's {stroke}"
        )
    if problems:
        raise problems.error()
    return Plan(settings, part, (source, part_source))
