"""Settings of the controllers, as people write them and as the code uses them."""

from typing import Annotated, Literal

from annotated_types import Ge, Gt, Le, Lt
from pydantic import Field, model_validator

from drivers.contract.settings import KILO, MICRO, MILLI, PERCENT, Settings, written

_Stiffness = Annotated[float, Gt(0), Le(1_000)]
_Clearance = Annotated[float, Ge(-1_000), Le(1_000)]
_Friction = Annotated[float, Ge(0), Le(2)]
_AxialStep = Annotated[float, Gt(0), Le(1_000)]
_Std = Annotated[float, Ge(0), Le(1_000)]


class FilterSettings(Settings):
    """How the force stream is filtered."""

    force_acceleration_std_N_s2: Annotated[float, Gt(0), Le(1_000_000)]
    """How fast a force's rate is expected to change: higher follows faster and smooths less."""
    torque_acceleration_std_Nm_s2: Annotated[float, Gt(0), Le(1_000_000)]
    """The same for torques."""
    gate_probability: Annotated[float, Gt(0.5), Lt(1)]
    """Share of good samples that pass the outlier gate."""
    rejections_max: Annotated[int, Ge(0), Le(20)]
    """Samples in a row that may be taken for outliers; the next one is believed."""
    tare_samples: Annotated[int, Ge(10), Le(100_000)]
    """Samples over which the bias is averaged."""
    bias_change_max_N: Annotated[float, Gt(0), Le(1_000), MILLI] = Field(alias="bias_change_max_mN")
    """Largest change of the bias at a tare; more means that something touches."""


class SkillSettings(Settings):
    """How an insertion is led, whatever the part."""

    start_depth_m: Annotated[float, Ge(-100_000), Lt(0), MICRO] = Field(alias="start_depth_um")
    """Depth at which an insertion begins, in free air."""
    settle_s: Annotated[float, Ge(0), Le(10_000), MILLI] = Field(alias="settle_time_ms")
    """Rest after a step before the next observation."""
    hold_timeout_s: Annotated[float, Gt(0), Le(60_000), MILLI] = Field(alias="hold_timeout_ms")
    """Longest hold before the insertion is given up."""
    contact_force_N: Annotated[float, Gt(0), Le(1_000), MILLI] = Field(alias="contact_force_mN")
    """Force that counts as contact in the approach, where none is expected."""


class InsertionSettings(Settings):
    """How far and how hard one kind of part is inserted."""

    stroke_m: Annotated[float, Gt(0), Le(100_000), MICRO] = Field(alias="stroke_um")
    """Depth at which the insertion is done."""
    steps_max: Annotated[int, Ge(1), Le(100_000)]
    """Steps after which the insertion is given up."""
    finish_force_N: Annotated[float, Gt(0), Le(10_000), MILLI] = Field(alias="finish_force_mN")
    """Axial force at which the insertion is given up as blocked."""
    axial_step_m: Annotated[float, Gt(0), Le(1_000), MICRO] = Field(alias="axial_step_um")
    """Step into the hole."""


class ProportionalSettings(Settings):
    """A lateral step against the force; the step into the hole is the part's."""

    kind: Literal["proportional"]
    force_jacobian_m_N: Annotated[float, Gt(0), Le(100_000), MICRO] = Field(
        alias="force_jacobian_um_N"
    )
    """Displacement that the contact answers with a unit force."""
    gain_factor: Annotated[float, Gt(0), Le(1)] = Field(alias="lambda")
    """Share of that displacement made in one step."""


class LookAheadControllerSettings(Settings):
    """A look ahead over a belief of pose and part; what alignment leaves is the part's.

    Pairs are the lowest and the highest value.
    """

    kind: Literal["look_ahead"]
    stiffness_N_m: Annotated[tuple[_Stiffness, _Stiffness], KILO] = Field(alias="stiffness_mN_um")
    """Of the contact."""
    clearance_m: Annotated[tuple[_Clearance, _Clearance], MICRO] = Field(alias="clearance_um")
    """Diameter of the first hole less the shaft's; below 0 the shaft is the thicker one."""
    friction: tuple[_Friction, _Friction]
    place_std_m: Annotated[_Std, MICRO] = Field(alias="place_std_um")
    """Of where the stage is taken to be, after all."""
    report_std_m: Annotated[_Std, MICRO] = Field(alias="report_std_um")
    """Of a place that the stage reports."""
    step_std_m: Annotated[_Std, MICRO] = Field(alias="step_std_um")
    """Of what comes of a commanded step."""
    model_error: Annotated[float, Ge(0), Le(100), PERCENT] = Field(alias="model_error_percent")
    """Standard deviation of the contact model, as a share of the force."""
    axial_step_m: Annotated[tuple[_AxialStep, _AxialStep], MICRO] = Field(alias="axial_step_um")
    """Steps into the hole: the longest, its half, and so on down to the shortest."""
    force_budget_N: Annotated[float, Gt(0), Le(1_000), MILLI] = Field(alias="force_budget_mN")
    """Radial force that a step may be expected to lead to."""
    quantile: Annotated[float, Gt(0.5), Lt(1)]
    """Share of the hypotheses that must stay within it."""
    hypotheses: Annotated[int, Ge(64), Le(4_096)]
    moves: Annotated[int, Ge(1), Le(20)]
    """Random moves of each hypothesis after each resampling."""
    samples: Annotated[int, Ge(16), Le(512)]
    """Hypotheses that are asked what a step leads to."""

    @model_validator(mode="after")
    def _check(self) -> "LookAheadControllerSettings":
        for name in ("stiffness_N_m", "clearance_m", "friction", "axial_step_m"):
            low, high = getattr(self, name)
            if low > high:
                stated = written(LookAheadControllerSettings, name, (low, high))
                raise ValueError(f"{stated} is not valid: the lowest value must come first")
        return self

    @property
    def axial_steps_m(self) -> tuple[float, ...]:
        """The steps into the hole, the longest first."""
        shortest, step = self.axial_step_m
        steps = [step]
        while 0.5 * steps[-1] > shortest:
            steps.append(0.5 * steps[-1])
        return (*steps, shortest) if shortest < step else (step,)
