"""Settings that every backend of a device class has; a backend adds its own by inheritance."""

from collections.abc import Iterator
from typing import Annotated

from annotated_types import Ge, Gt, Le
from pydantic import Field, model_validator

from drivers.contract.settings import DEGREES, MICRO, MILLI, Settings, written

_Place = Annotated[float, Ge(-1_000_000), Le(1_000_000)]
_Travel = Annotated[float, Gt(0), Le(100_000)]


class SampledSettings(Settings):
    """What every force sensor states, also one that no cell holds."""

    rate_Hz: Annotated[float, Ge(10), Le(20_000)]
    """Samples per second."""


class ForceSensorSettings(SampledSettings):
    """What every force sensor of a cell states."""

    origin_m: Annotated[tuple[_Place, _Place, _Place], MICRO] = Field(alias="origin_um")
    """Where the sensor is in frame M; torques are about it."""


class DriftBand(Settings):
    """Band in which a sensor's 1/f drift follows the law; it levels off below."""

    lowest_frequency_Hz: Annotated[float, Ge(1e-6), Le(100)]
    highest_frequency_Hz: Annotated[float, Ge(1e-6), Le(1_000)]

    @model_validator(mode="after")
    def _check(self) -> "DriftBand":
        if self.highest_frequency_Hz <= self.lowest_frequency_Hz:
            raise ValueError(
                f"{self._written('highest_frequency_Hz')} is not valid: must be greater than "
                f"{self._written('lowest_frequency_Hz')}"
            )
        return self

    def problems(self, rate_Hz: float) -> Iterator[str]:
        """Yield a line if the drift is too fast for a sample rate.

        Its model reaches ten times beyond the band, and must stay below half the rate.
        """
        highest_Hz = 0.05 * rate_Hz
        if self.highest_frequency_Hz > highest_Hz:
            yield (
                f"drift.{self._written('highest_frequency_Hz')} is not valid: must be at most "
                f"{highest_Hz:.12g}, a twentieth of rate_Hz = {rate_Hz:.12g}"
            )

    def _written(self, name: str) -> str:
        return written(type(self), name, getattr(self, name))


class TelemetrySettings(Settings):
    """What every device with a state to report states."""

    telemetry_rate_Hz: Annotated[float, Ge(1), Le(10_000)]
    """Reported states per second."""


class StageSettings(TelemetrySettings):
    """What every stage states; the speed limits are also set in the device itself."""

    speed_m_s: Annotated[float, Ge(0.01), Le(5), MILLI] = Field(alias="speed_limit_mm_s")
    angular_speed_rad_s: Annotated[float, Ge(0.001), Le(5), DEGREES] = Field(
        alias="angular_speed_limit_deg_s"
    )
    acceleration_m_s2: Annotated[float, Gt(0), Le(100_000), MILLI] = Field(
        alias="acceleration_mm_s2"
    )
    """With which it starts and brakes."""
    travel_m: Annotated[tuple[_Travel, _Travel, _Travel], MICRO] = Field(alias="travel_um")
    """Farthest from its centre along x, y, z, to either side."""
