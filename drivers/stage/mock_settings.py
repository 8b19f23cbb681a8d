"""Settings of the mock stage, and the errors that they describe."""

from typing import Annotated

import numpy as np
from annotated_types import Ge, Le
from pydantic import Field

from drivers.contract.device_settings import StageSettings
from drivers.contract.settings import DEGREES, MICRO, MILLI
from simulator.checks import FloatArray
from simulator.effects.hysteresis import PrandtlIshlinskii
from simulator.effects.stage import StageEffects

_Length = Annotated[float, Ge(0), Le(1_000), MICRO]
_Angle = Annotated[float, Ge(0), Le(1), DEGREES]


class MockStageSettings(StageSettings):
    """What the mock's stage is like; an error that is not stated is off."""

    minimum_step_m: _Length = Field(0.0, alias="minimum_step_um")
    """It goes to multiples of this."""
    minimum_step_rad: _Angle = Field(0.0, alias="minimum_step_deg")
    backlash_m: _Length = Field(0.0, alias="backlash_um")
    """Free travel at each reversal."""
    backlash_rad: _Angle = Field(0.0, alias="backlash_deg")
    hysteresis_gap_m: _Length = Field(0.0, alias="hysteresis_gap_um")
    """Free travel of a play operator."""
    hysteresis_gap_rad: _Angle = Field(0.0, alias="hysteresis_gap_deg")
    hysteresis_weight: Annotated[float, Ge(0), Le(1)] = 0.0
    """Share of the motion that goes through that operator."""
    repeatability_m: _Length = Field(0.0, alias="repeatability_um")
    """Standard deviation of the place that a motion ends at."""
    repeatability_rad: _Angle = Field(0.0, alias="repeatability_deg")
    settling_time_constant_s: Annotated[float, Ge(0), Le(1_000), MILLI] = Field(
        0.0, alias="settling_time_constant_ms"
    )
    """In which what is left of a motion falls by the factor e."""

    def effects(self) -> StageEffects | None:
        """Return the errors as the simulator takes them; None where all are off."""
        minimum_step = _per_axis(self.minimum_step_m, self.minimum_step_rad)
        backlash = _per_axis(self.backlash_m, self.backlash_rad)
        gap = self.hysteresis_weight * _per_axis(self.hysteresis_gap_m, self.hysteresis_gap_rad)
        repeatability = _per_axis(self.repeatability_m, self.repeatability_rad)
        errors = (minimum_step, backlash, gap, repeatability)
        if not any(e.any() for e in errors) and self.settling_time_constant_s == 0.0:
            return None
        return StageEffects(
            minimum_step,
            backlash,
            PrandtlIshlinskii(
                _per_axis(self.hysteresis_gap_m, self.hysteresis_gap_rad)[np.newaxis],
                np.full((1, 6), self.hysteresis_weight),
            ),
            repeatability,
            self.settling_time_constant_s,
        )


def _per_axis(linear_m: float, angular_rad: float) -> FloatArray:
    return np.repeat([linear_m, angular_rad], 3)
