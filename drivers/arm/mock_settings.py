"""Settings of the mock arm, and the sway that they describe."""

from typing import Annotated

import numpy as np
from annotated_types import Ge, Gt, Le, Lt
from pydantic import Field

from drivers.contract.device_settings import TelemetrySettings
from drivers.contract.settings import DEGREES, MICRO, MILLI, Settings
from simulator.effects.arm import ArmEffects, ThermalDrift
from simulator.effects.vibration import VibrationMode

_Way = Annotated[float, Ge(-1_000), Le(1_000)]
_Turn = Annotated[float, Ge(-1), Le(1)]
_Ways = Annotated[tuple[_Way, _Way, _Way], MICRO]
_Turns = Annotated[tuple[_Turn, _Turn, _Turn], DEGREES]
_NONE = (0.0, 0.0, 0.0)


class ThermalSettings(Settings):
    """A thermal drift: an exponential approach, from 0 when the arm is connected."""

    end_m: _Ways = Field(alias="end_um")
    """How far the arm moves in the end."""
    end_rad: _Turns = Field(_NONE, alias="end_deg")
    time_constant_s: Annotated[float, Gt(0), Le(100_000)]


class VibrationSettings(Settings):
    """A mode of vibration; axes of different signs move against each other."""

    frequency_Hz: Annotated[float, Gt(0), Le(100)]
    damping_ratio: Annotated[float, Gt(0), Lt(1)]
    rms_m: _Ways = Field(alias="rms_um")
    rms_rad: _Turns = Field(_NONE, alias="rms_deg")


class MockArmSettings(TelemetrySettings):
    """What the mock's arm is like; it stands still where no sway is stated."""

    acceleration_m_s2: Annotated[float, Gt(0), Le(10_000), MILLI] = Field(
        alias="acceleration_mm_s2"
    )
    """With which it starts and brakes."""
    walk_m_rts: Annotated[float, Ge(0), Le(1_000), MICRO] = Field(0.0, alias="walk_um_rts")
    """Standard deviation of a random walk along each axis after 1 s."""
    walk_rad_rts: Annotated[float, Ge(0), Le(1), DEGREES] = Field(0.0, alias="walk_deg_rts")
    """Standard deviation of a random walk about each axis after 1 s."""
    thermal: tuple[ThermalSettings, ...] = ()
    vibration: tuple[VibrationSettings, ...] = ()

    def effects(self) -> ArmEffects | None:
        """Return the sway as the simulator takes it; None where there is none."""
        if not (self.walk_m_rts or self.walk_rad_rts or self.thermal or self.vibration):
            return None
        return ArmEffects(
            tuple(
                ThermalDrift(t.time_constant_s, np.array([*t.end_m, *t.end_rad]))
                for t in self.thermal
            ),
            np.repeat([self.walk_m_rts, self.walk_rad_rts], 3),
            tuple(
                VibrationMode(v.frequency_Hz, v.damping_ratio, np.array([*v.rms_m, *v.rms_rad]))
                for v in self.vibration
            ),
        )
