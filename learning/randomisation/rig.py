"""Settings of what the rig's errors are drawn from: force sensor, stage and arm.

What is left out is off. Each of the three axes is drawn on its own; rates, times and frequencies
are plain numbers, the same for all plants.
"""

import math
from collections.abc import Iterator
from typing import Annotated

from annotated_types import Ge, Gt, Le, Lt
from pydantic import Field, model_validator

from drivers.contract.device_settings import DriftBand, SampledSettings
from drivers.contract.settings import DEGREES, MICRO, MILLI, NANO, ONE, PERCENT, Settings
from learning.randomisation.distribution import OFF, DistributionSettings, Spread
from simulator.randomisation.rig import (
    ArmDistribution,
    Axes,
    DriftDistribution,
    ModeDistribution,
    SensorDistribution,
    StageDistribution,
    ThermalDistribution,
)

_ForceDensity = Annotated[DistributionSettings, Spread(Ge(0), Le(100_000), MICRO)]
_TorqueDensity = Annotated[DistributionSettings, Spread(Ge(0), Le(10_000_000), NANO)]
_Length = Annotated[DistributionSettings, Spread(Ge(0), Le(1_000), MICRO)]
_Angle = Annotated[DistributionSettings, Spread(Ge(0), Le(1), DEGREES)]


class DriftDistributionSettings(DriftBand):
    """1/f drift of the sensor."""

    force_N_rtHz: _ForceDensity = Field(alias="force_uN_rtHz")
    """At 1 Hz."""
    torque_Nm_rtHz: _TorqueDensity = Field(alias="torque_nNm_rtHz")
    """At 1 Hz."""

    def distribution(self) -> DriftDistribution:
        """Return the drift as the simulator takes it."""
        return DriftDistribution(
            _axes(self.force_N_rtHz, self.torque_Nm_rtHz),
            (self.lowest_frequency_Hz, self.highest_frequency_Hz),
        )


class SensorDistributionSettings(SampledSettings):
    """The force sensor."""

    force_noise_N_rtHz: _ForceDensity = Field(OFF, alias="force_noise_uN_rtHz")
    torque_noise_Nm_rtHz: _TorqueDensity = Field(OFF, alias="torque_noise_nNm_rtHz")
    force_bias_N: Annotated[DistributionSettings, Spread(Ge(-10_000), Le(10_000), MILLI)] = Field(
        OFF, alias="force_bias_mN"
    )
    torque_bias_Nm: Annotated[
        DistributionSettings, Spread(Ge(-1_000_000), Le(1_000_000), MICRO)
    ] = Field(OFF, alias="torque_bias_uNm")
    latency_s: Annotated[float, Ge(0), Le(100), MILLI] = Field(0.0, alias="latency_ms")
    force_resolution_N: Annotated[float, Ge(0), Le(1_000), MILLI] = Field(
        0.0, alias="force_resolution_mN"
    )
    torque_resolution_Nm: Annotated[float, Ge(0), Le(100_000), MICRO] = Field(
        0.0, alias="torque_resolution_uNm"
    )
    force_range_N: Annotated[float, Gt(0), Le(1_000_000), MILLI] | None = Field(
        None, alias="force_range_mN"
    )
    """Largest force, to either side, before an axis saturates; without it none does."""
    torque_range_Nm: Annotated[float, Gt(0), Le(100_000_000), MICRO] | None = Field(
        None, alias="torque_range_uNm"
    )
    """Largest torque, to either side, before an axis saturates; without it none does."""
    crosstalk: Annotated[DistributionSettings, Spread(Ge(-20), Le(20), PERCENT)] = Field(
        OFF, alias="crosstalk_percent"
    )
    """What an axis reads, as a share of its range, of a full load on another. On itself: the error
    of its gain."""
    drift: DriftDistributionSettings | None = None

    @model_validator(mode="after")
    def _check(self) -> "SensorDistributionSettings":
        if problems := [*self._problems()]:
            raise ValueError("\n".join(problems))
        return self

    def _problems(self) -> Iterator[str]:
        if "crosstalk" in self.model_fields_set:
            for key, end in (
                ("force_range_mN", self.force_range_N),
                ("torque_range_uNm", self.torque_range_Nm),
            ):
                if end is None:
                    yield f"{key} is missing: crosstalk_percent is a share of it"
        if self.drift is not None:
            yield from self.drift.problems(self.rate_Hz)

    def distribution(self) -> SensorDistribution:
        """Return the sensor as the simulator takes it."""
        return SensorDistribution(
            self.rate_Hz,
            noise_density=_axes(self.force_noise_N_rtHz, self.torque_noise_Nm_rtHz),
            bias=_axes(self.force_bias_N, self.torque_bias_Nm),
            drift=None if self.drift is None else self.drift.distribution(),
            latency_s=self.latency_s,
            crosstalk=self.crosstalk.distribution(),
            range=(self.force_range_N or math.inf, self.torque_range_Nm or math.inf),
            resolution=(self.force_resolution_N, self.torque_resolution_Nm),
        )


class StageDistributionSettings(Settings):
    """The stage."""

    position_noise_m: _Length = Field(OFF, alias="position_noise_um")
    """Of what it reports along x, y, z: standard deviation."""
    minimum_step_m: _Length = Field(OFF, alias="minimum_step_um")
    minimum_step_rad: _Angle = Field(OFF, alias="minimum_step_deg")
    backlash_m: _Length = Field(OFF, alias="backlash_um")
    backlash_rad: _Angle = Field(OFF, alias="backlash_deg")
    hysteresis_gap_m: _Length = Field(OFF, alias="hysteresis_gap_um")
    hysteresis_gap_rad: _Angle = Field(OFF, alias="hysteresis_gap_deg")
    hysteresis_weight: Annotated[DistributionSettings, Spread(Ge(0), Le(1), ONE)] = OFF
    """Share of the way that follows late, by the gap."""
    repeatability_m: _Length = Field(OFF, alias="repeatability_um")
    repeatability_rad: _Angle = Field(OFF, alias="repeatability_deg")
    settling_time_constant_s: Annotated[float, Ge(0), Le(10_000), MILLI] = Field(
        0.0, alias="settling_time_constant_ms"
    )

    def distribution(self) -> StageDistribution:
        """Return the stage as the simulator takes it."""
        return StageDistribution(
            minimum_step=_axes(self.minimum_step_m, self.minimum_step_rad),
            backlash=_axes(self.backlash_m, self.backlash_rad),
            hysteresis_gap=_axes(self.hysteresis_gap_m, self.hysteresis_gap_rad),
            hysteresis_weight=self.hysteresis_weight.distribution(),
            repeatability=_axes(self.repeatability_m, self.repeatability_rad),
            settling_time_constant_s=self.settling_time_constant_s,
        )


class ThermalDistributionSettings(Settings):
    """A thermal drift of the arm."""

    end_m: Annotated[DistributionSettings, Spread(Ge(-1_000), Le(1_000), MICRO)] = Field(
        alias="end_um"
    )
    """How far the arm moves in the end."""
    end_rad: Annotated[DistributionSettings, Spread(Ge(-1), Le(1), DEGREES)] = Field(
        OFF, alias="end_deg"
    )
    time_constant_s: Annotated[float, Gt(0), Le(100_000)]

    def distribution(self) -> ThermalDistribution:
        """Return the drift as the simulator takes it."""
        return ThermalDistribution(_axes(self.end_m, self.end_rad), self.time_constant_s)


class ModeDistributionSettings(Settings):
    """A mode of vibration of the arm."""

    frequency_Hz: Annotated[float, Gt(0), Le(1_000)]
    damping_ratio: Annotated[float, Gt(0), Lt(1)]
    rms_m: _Length = Field(alias="rms_um")
    rms_rad: _Angle = Field(OFF, alias="rms_deg")

    def distribution(self) -> ModeDistribution:
        """Return the mode as the simulator takes it."""
        return ModeDistribution(
            _axes(self.rms_m, self.rms_rad), self.frequency_Hz, self.damping_ratio
        )


class ArmDistributionSettings(Settings):
    """The arm that holds the part."""

    thermal: tuple[ThermalDistributionSettings, ...] = ()
    vibration: tuple[ModeDistributionSettings, ...] = ()
    walk_m_rts: _Length = Field(OFF, alias="walk_um_rts")
    """Standard deviation of a random walk after 1 s."""
    walk_rad_rts: _Angle = Field(OFF, alias="walk_deg_rts")
    """Standard deviation of a random walk after 1 s."""

    def distribution(self) -> ArmDistribution:
        """Return the arm as the simulator takes it."""
        return ArmDistribution(
            tuple(drift.distribution() for drift in self.thermal),
            _axes(self.walk_m_rts, self.walk_rad_rts),
            tuple(mode.distribution() for mode in self.vibration),
        )


def _axes(linear: DistributionSettings, angular: DistributionSettings) -> Axes:
    return Axes(linear.distribution(), angular.distribution())
