"""Settings of a comparison: the plants, the rules of a trial, and the controllers, by kind."""

from collections.abc import Mapping
from typing import Annotated, Literal

from annotated_types import Ge, Gt, Le, Lt
from pydantic import AfterValidator, Field
from pydantic_core import PydanticCustomError

from controllers.settings import LookAheadControllerSettings, ProportionalSettings
from drivers.contract.configuration.problems import INVALID
from drivers.contract.settings import DEGREES, MICRO, MILLI, Settings
from learning.evaluation.trial import TrialRules

_Length = Annotated[float, Gt(0), Le(1_000)]
_Lengths = Annotated[tuple[_Length, _Length, _Length], MICRO]
_Force = Annotated[float, Gt(0), Le(10_000)]
_Place = Annotated[float, Ge(-1_000_000), Le(1_000_000)]
_Bound = Annotated[float, Gt(0), Le(100_000)]
Pair = tuple[float, float]


def _in_order(pair: Pair) -> Pair:
    if not pair[0] < pair[1]:
        raise PydanticCustomError(INVALID, "a low and a high end, low less than high")
    return pair


_Search = Annotated[tuple[_Bound, _Bound], AfterValidator(_in_order)]
"""Ends between which a parameter is searched; both above zero, as it is searched by ratios."""


class PlantChoice(Settings):
    """Plants to judge controllers on."""

    file: str
    """What they are drawn from, relative to this file."""
    count: Annotated[int, Ge(1), Le(1_000_000)]
    seed: Annotated[int, Ge(0)]


class TuningSettings(Settings):
    """Other plants from the same file, on which controllers with free parameters are tuned."""

    count: Annotated[int, Ge(1), Le(100_000)]
    seed: Annotated[int, Ge(0)]


class TrialSettings(Settings):
    """What holds in every insertion, whatever the controller; vectors are x, y, z in M."""

    step_box_m: _Lengths = Field(alias="step_box_um")
    """Longest step along each axis, to either side."""
    turn_rad: Annotated[float, Ge(0), Le(5), DEGREES] = Field(alias="turn_deg")
    """Largest turn about x and about y in a step."""
    force_limit_N: Annotated[tuple[_Force, _Force, _Force], MILLI] = Field(alias="force_limit_mN")
    """A larger force along an axis makes an insertion a failure."""
    start_depth_m: Annotated[float, Ge(-100_000), Lt(0), MICRO] = Field(alias="start_depth_um")
    beyond_m: Annotated[float, Gt(0), Le(100_000), MICRO] = Field(alias="beyond_um")
    """Depth below the last mouth at which the part is inserted."""
    steps_max: Annotated[int, Ge(1), Le(100_000)]
    sensor_m: Annotated[tuple[_Place, _Place, _Place], MICRO] = Field(alias="sensor_um")
    """Where the force sensor is."""
    step_s: Annotated[float, Gt(0), Le(60_000), MILLI] = Field(alias="step_time_ms")
    """What a step takes; for impulse and times alone."""
    gentle_N: Annotated[float, Gt(0), Le(10_000), MILLI] = Field(alias="gentle_force_mN")
    """Radial force over which a step is counted as not gentle."""

    def rules(self) -> TrialRules:
        """Return the rules as a trial takes them."""
        return TrialRules(
            step_box_m=self.step_box_m,
            turn_rad=self.turn_rad,
            force_limit_N=self.force_limit_N,
            start_depth_m=self.start_depth_m,
            beyond_m=self.beyond_m,
            steps_max=self.steps_max,
            sensor_m=self.sensor_m,
        )


class BootstrapSettings(Settings):
    """How intervals of means are found: the insertions are drawn again and again."""

    samples: Annotated[int, Ge(100), Le(1_000_000)]
    seed: Annotated[int, Ge(0)]


class FigureSettings(Settings):
    """What figures show."""

    insertions: Annotated[int, Ge(1), Le(100_000)]
    """Insertions, the first ones, whose forces are shown as a distribution."""
    compared: tuple[str, str]
    """Names of the two controllers whose forces are shown by depth."""


class FixedSettings(ProportionalSettings):
    """The P-controller (eq. 6) as in a cell; here it carries its own axial step."""

    axial_step_m: Annotated[_Length, MICRO] = Field(alias="axial_step_um")


class TunedSettings(Settings):
    """The P-controller, its gain tuned for the mean radial force."""

    kind: Literal["tuned"]
    gain_um_N: _Search
    """Ends between which the gain is searched."""
    axial_step_m: Annotated[_Length, MICRO] = Field(alias="axial_step_um")


class AdmittanceSettings(Settings):
    """An admittance (`learning.evaluation.admittance`), tuned for the mean radial force."""

    kind: Literal["admittance"]
    lateral_um_N: _Search
    """Ends between which the lateral step per force is searched."""
    axial_um_N: _Search
    """Ends between which the loss of axial step per force is searched."""
    lag_steps: _Search
    """Ends between which mass over damping is searched, in steps."""
    axial_step_m: Annotated[_Length, MICRO] = Field(alias="axial_step_um")
    """Where no force acts."""


class PolicySettings(Settings):
    """A trained policy on top of the expert that it was trained with."""

    kind: Literal["skill"]
    policy: str
    """Its file, relative to this one."""


class PrivilegedSettings(Settings):
    """A bound: told the true pose and plant, it finds the gentlest move by optimisation."""

    kind: Literal["privileged"]
    tilt: bool
    """Whether it may turn the shaft as well."""


class BeliefSettings(LookAheadControllerSettings):
    """The look ahead as in a cell; here it carries what the cell's part, sensor and limits say."""

    position_error_m: Annotated[float, Ge(0), Le(1_000), MICRO] = Field(alias="position_error_um")
    """Radius of the disc in which it expects the shaft."""
    tilt_error_rad: Annotated[float, Ge(0), Le(5), DEGREES] = Field(alias="tilt_error_deg")
    """Radius of the disc in which it expects the tilt."""
    force_noise_N: Annotated[float, Gt(0), Le(1_000), MILLI] = Field(alias="force_noise_mN")
    """Standard deviation of a reading."""
    torque_noise_Nm: Annotated[float, Gt(0), Le(100_000), MICRO] = Field(alias="torque_noise_uNm")
    """Standard deviation of a reading."""
    turn_rad: Annotated[float, Ge(0), Le(5), DEGREES] = Field(alias="turn_deg")
    """Largest turn about each axis in one step; 0 keeps the tilt."""


ControllerSettings = (
    FixedSettings
    | TunedSettings
    | AdmittanceSettings
    | PolicySettings
    | BeliefSettings
    | PrivilegedSettings
)
KINDS: Mapping[str, type[ControllerSettings]] = {
    "proportional": FixedSettings,
    "tuned": TunedSettings,
    "admittance": AdmittanceSettings,
    "skill": PolicySettings,
    "look_ahead": BeliefSettings,
    "privileged": PrivilegedSettings,
}
"""Settings of each kind of controller."""


class EvaluationSettings(Settings):
    """The file as a whole, but for the controllers: what is valid there depends on their kind."""

    plants: PlantChoice
    tuning: TuningSettings
    trial: TrialSettings
    bootstrap: BootstrapSettings
    figures: FigureSettings
