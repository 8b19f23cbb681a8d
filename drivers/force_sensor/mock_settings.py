"""Settings of the mock force sensor, and the sensor that they describe."""

from typing import Annotated

import numpy as np
from annotated_types import Ge, Gt, Le
from pydantic import Field, model_validator

from drivers.contract.device_settings import DriftBand, ForceSensorSettings
from drivers.contract.settings import MICRO, MILLI, NANO, PERCENT, Settings
from simulator.checks import FloatArray
from simulator.effects.flicker import Ladder, flicker
from simulator.effects.sensor import SensorEffects

_Bias = Annotated[float, Ge(-10_000), Le(10_000)]
_Share = Annotated[float, Ge(-20), Le(20)]
_Row = Annotated[tuple[_Share, _Share, _Share, _Share, _Share, _Share], PERCENT]


class DriftSettings(DriftBand):
    """1/f drift: in the band the amplitude density falls with the root of the frequency."""

    force_N_rtHz: Annotated[float, Ge(0), Le(100_000), MICRO] = Field(alias="force_uN_rtHz")
    """At 1 Hz."""
    torque_Nm_rtHz: Annotated[float, Ge(0), Le(10_000_000), NANO] = Field(alias="torque_nNm_rtHz")
    """At 1 Hz."""


class CrosstalkSettings(Settings):
    """What each axis reads, as a share of its range, of a full load on each of the six.

    It comes on top of the load itself, so that the entry of an axis with itself is the error of its
    gain.
    """

    fx: _Row = Field(alias="fx_percent")
    fy: _Row = Field(alias="fy_percent")
    fz: _Row = Field(alias="fz_percent")
    tx: _Row = Field(alias="tx_percent")
    ty: _Row = Field(alias="ty_percent")
    tz: _Row = Field(alias="tz_percent")


class MockForceSensorSettings(ForceSensorSettings):
    """What the mock's sensor is like."""

    force_noise_N_rtHz: Annotated[float, Gt(0), Le(100_000), MICRO] = Field(
        alias="force_noise_uN_rtHz"
    )
    """Amplitude density of white noise, up to half the sample rate."""
    torque_noise_Nm_rtHz: Annotated[float, Gt(0), Le(10_000_000), NANO] = Field(
        alias="torque_noise_nNm_rtHz"
    )
    """Amplitude density of white noise, up to half the sample rate."""
    bias_N: Annotated[tuple[_Bias, _Bias, _Bias], MILLI] = Field(alias="bias_mN")
    """What the unloaded sensor reads."""
    force_resolution_N: Annotated[float, Gt(0), Le(1_000), MILLI] = Field(
        alias="force_resolution_mN"
    )
    torque_resolution_Nm: Annotated[float, Gt(0), Le(100_000), MICRO] = Field(
        alias="torque_resolution_uNm"
    )
    force_range_N: Annotated[float, Gt(0), Le(1_000_000), MILLI] = Field(alias="force_range_mN")
    """Largest force, to either side, before an axis saturates."""
    torque_range_Nm: Annotated[float, Gt(0), Le(100_000_000), MICRO] = Field(
        alias="torque_range_uNm"
    )
    """Largest torque, to either side, before an axis saturates."""
    latency_s: Annotated[float, Ge(0), Le(100), MILLI] = Field(0.0, alias="latency_ms")
    """From the load to the stamp of the sample that reports it."""
    drift: DriftSettings | None = None
    crosstalk: CrosstalkSettings | None = None

    @model_validator(mode="after")
    def _check(self) -> "MockForceSensorSettings":
        if self.drift is not None and (problems := [*self.drift.problems(self.rate_Hz)]):
            raise ValueError("\n".join(problems))
        return self

    def effects(self) -> SensorEffects:
        """Return the sensor as the simulator takes it."""
        ends = _per_axis(self.force_range_N, self.torque_range_Nm)
        return SensorEffects(
            self.rate_Hz,
            crosstalk=None if self.crosstalk is None else _response(self.crosstalk, ends),
            bias=np.array([*self.bias_N, 0.0, 0.0, 0.0]),
            drift=Ladder() if self.drift is None else _ladder(self.drift),
            noise_density=_per_axis(self.force_noise_N_rtHz, self.torque_noise_Nm_rtHz),
            range=ends,
            resolution=_per_axis(self.force_resolution_N, self.torque_resolution_Nm),
            latency_samples=self.latency_s * self.rate_Hz,
        )


def _ladder(drift: DriftSettings) -> Ladder:
    return flicker(
        _per_axis(drift.force_N_rtHz, drift.torque_Nm_rtHz),
        (drift.lowest_frequency_Hz, drift.highest_frequency_Hz),
    )


def _response(crosstalk: CrosstalkSettings, ends: FloatArray) -> FloatArray:
    c = crosstalk
    shares = np.array([c.fx, c.fy, c.fz, c.tx, c.ty, c.tz])
    return np.eye(6) + shares * ends[:, np.newaxis] / ends


def _per_axis(force: float, torque: float) -> FloatArray:
    return np.repeat([force, torque], 3)
