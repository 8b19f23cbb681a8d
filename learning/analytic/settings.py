"""Settings of a training by the analytic policy gradient: the file as a whole."""

from collections.abc import Iterator
from typing import Annotated

from annotated_types import Ge, Gt, Le, MaxLen, MinLen
from pydantic import Field, model_validator

from drivers.contract.messages import Vector3
from drivers.contract.settings import DEGREES, MICRO, MILLI, Settings, written
from learning.evaluation.settings import FixedSettings, TrialSettings
from learning.policy.expert import Approach, Expert
from learning.policy.inputs import Input, Output
from learning.policy.policy import LONGEST_HISTORY
from learning.settings import NetworkSettings, RewardSettings

_Force = Annotated[float, Gt(0), Le(10_000)]
_Torque = Annotated[float, Gt(0), Le(1_000_000)]
_Length = Annotated[float, Gt(0), Le(100_000)]
_Step = Annotated[float, Gt(0), Le(1_000)]
_Angle = Annotated[float, Gt(0), Le(5)]
_Count = Annotated[int, Ge(1), Le(1_000_000)]


class InputSettings(Settings):
    """What the policy sees, each with the value that the network sees as 1; None: not at all."""

    force_N: Annotated[tuple[_Force, _Force, _Force], MILLI] = Field(alias="force_mN")
    torque_Nm: Annotated[tuple[_Torque, _Torque, _Torque], MICRO] | None = Field(
        None, alias="torque_uNm"
    )
    """About the sensor."""
    displacement_m: Annotated[tuple[_Length, _Length], MICRO] | None = Field(
        None, alias="displacement_um"
    )
    """Of the stage since the insertion began, along x and y."""
    depth_m: Annotated[_Length, MICRO] = Field(alias="depth_um")
    turn_rad: Annotated[tuple[_Angle, _Angle], DEGREES] | None = Field(None, alias="turn_deg")
    """Of the stage about x and y."""

    def inputs(self) -> tuple[Input, ...]:
        """Return the inputs as a policy names them."""
        groups = {
            "force": self.force_N,
            "torque": self.torque_Nm or (),
            "displacement": self.displacement_m or (),
            "turn": self.turn_rad or (),
        }
        named = [
            Input(f"{group}_{axis}", scale)
            for group, scales in groups.items()
            for axis, scale in zip("xyz", scales, strict=False)
        ]
        return (*named, Input("depth", self.depth_m))


class ApproachSettings(Settings):
    """Short axial steps of the expert where the shaft meets the first rim."""

    step_m: Annotated[_Step, MICRO] = Field(alias="step_um")
    depth_m: Annotated[_Step, MICRO] = Field(alias="depth_um")
    """Down to where they are short."""


class ExpertSettings(FixedSettings):
    """The expert (eq. 6) that the policy corrects."""

    approach: ApproachSettings | None = None


class OutputSettings(Settings):
    """What the policy may add to the expert."""

    range_m: Annotated[tuple[_Step, _Step, _Step], MICRO] = Field(alias="range_um")
    """Largest residual along each axis, to either side."""
    turn_rad: Annotated[_Angle, DEGREES] | None = Field(None, alias="turn_deg")
    """Largest turn about x and about y; without it the policy does not turn the shaft."""

    def outputs(self) -> tuple[Output, ...]:
        """Return the outputs as a policy names them."""
        names = ("step_x", "step_y", "step_z", "turn_x", "turn_y")
        turns = () if self.turn_rad is None else (self.turn_rad, self.turn_rad)
        scales = (*self.range_m, *turns)
        return tuple(Output(name, scale) for name, scale in zip(names, scales, strict=False))


class JudgedSettings(Settings):
    """Plants that no training draws, to judge the policy on."""

    count: Annotated[int, Ge(1), Le(100_000)]
    seed: Annotated[int, Ge(0)]


class AnalyticSettings(Settings):
    """All of a training but its seed."""

    plants: Annotated[str, MinLen(1), MaxLen(1_000)]
    """File that plants are drawn from, relative to this one."""
    pool: _Count
    """Plants that are drawn, once."""
    trial: TrialSettings
    inputs: InputSettings
    input_bound: Annotated[float, Gt(0), Le(1_000)]
    """Magnitude that scaled inputs are cut to."""
    history: Annotated[int, Ge(1), Le(LONGEST_HISTORY)]
    """Observations that the network sees, the newest and those before it."""
    expert: ExpertSettings
    residual: OutputSettings
    reward: RewardSettings
    """Eqs. (11) to (13)."""
    force_weight: Annotated[float, Ge(0), Le(1_000)]
    """Of u + u^2, by which the reward of a step is less, with u the radial force over the gentle
    force of the trial; 0 for the paper's reward."""
    insertions: _Count
    """At once, each with a plant of the pool."""
    steps: Annotated[int, Ge(1), Le(10_000)]
    """After which an insertion is broken off."""
    updates: _Count
    gradient_norm_max: Annotated[float, Gt(0), Le(1_000_000)]
    """A longer gradient is shortened to it."""
    actor: NetworkSettings
    """Its learning rate falls evenly to zero."""
    actor_last_weight: Annotated[float, Ge(0), Le(1)]
    """Largest magnitude of weights and biases of the actor's last layer at first."""
    judged: JudgedSettings

    @property
    def policy_expert(self) -> Expert:
        """The expert as policies hold it."""
        expert, approach = self.expert, self.expert.approach
        return Expert(
            gain_m_N=expert.gain_factor * expert.force_jacobian_m_N,
            axial_step_m=expert.axial_step_m,
            step_box_m=self.trial.step_box_m,
            approach=None if approach is None else Approach(approach.step_m, approach.depth_m),
        )

    @property
    def torque_origin_m(self) -> Vector3 | None:
        """Place that torques are about, or None where the policy sees none."""
        return None if self.inputs.torque_Nm is None else self.trial.sensor_m

    @model_validator(mode="after")
    def _check(self) -> "AnalyticSettings":
        if problems := [*self._problems()]:
            raise ValueError("\n".join(problems))
        return self

    def _problems(self) -> Iterator[str]:
        trial, expert, residual = self.trial, self.expert, self.residual
        box = written(TrialSettings, "step_box_m", trial.step_box_m)
        if any(r > b for r, b in zip(residual.range_m, trial.step_box_m, strict=True)):
            key = written(OutputSettings, "range_m", residual.range_m)
            yield f"residual.{key} is not valid: must not exceed trial.{box}"
        if expert.axial_step_m > trial.step_box_m[2]:
            key = written(ExpertSettings, "axial_step_m", expert.axial_step_m)
            yield f"expert.{key} is not valid: must not exceed z of trial.{box}"
        if expert.approach is not None and expert.approach.step_m > expert.axial_step_m:
            key = written(ApproachSettings, "step_m", expert.approach.step_m)
            most = written(ExpertSettings, "axial_step_m", expert.axial_step_m)
            yield f"expert.approach.{key} is not valid: must not exceed expert.{most}"
        if residual.turn_rad is not None and residual.turn_rad > trial.turn_rad:
            key = written(OutputSettings, "turn_rad", residual.turn_rad)
            most = written(TrialSettings, "turn_rad", trial.turn_rad)
            yield f"residual.{key} is not valid: must not exceed trial.{most}"
        if self.inputs.turn_rad is not None and residual.turn_rad is None:
            yield "inputs.turn_deg is no key where residual.turn_deg is missing: nothing turns"
        if self.steps > trial.steps_max:
            yield (
                f"steps = {self.steps} is not valid: must not exceed "
                f"trial.steps_max = {trial.steps_max}"
            )
