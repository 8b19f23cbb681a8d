"""Settings that every backend of a device class has; a backend adds its own by inheritance."""

from typing import Annotated

from annotated_types import Ge, Gt, Le
from pydantic import Field

from drivers.contract.settings import DEGREES, MICRO, MILLI, Settings

_Travel = Annotated[float, Gt(0), Le(100_000)]


class ForceSensorSettings(Settings):
    """What every force sensor states."""

    rate_Hz: Annotated[float, Ge(10), Le(20_000)]
    """Samples per second."""


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
