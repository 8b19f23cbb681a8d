"""Settings of what plants are drawn from: the file as a whole."""

from collections.abc import Iterator
from typing import Annotated

from annotated_types import Ge, Gt, Le, MinLen
from pydantic import Field, model_validator

from drivers.contract.configuration.describe import Accepted
from drivers.contract.settings import DEGREES, KILO, MICRO, ONE, Settings
from learning.randomisation.distribution import OFF, DistributionSettings, Spread
from learning.randomisation.geometry import (
    Clearance,
    HoleDistributionSettings,
    ShaftDistributionSettings,
)
from learning.randomisation.holder import HolderDistributionSettings
from learning.randomisation.rig import (
    ArmDistributionSettings,
    SensorDistributionSettings,
    StageDistributionSettings,
)
from simulator.randomisation.plants import STIFFNESS_RATIO, PlantDistribution


class ContactDistributionSettings(Settings):
    """How walls and shaft answer to contact."""

    stiffness_N_m: Annotated[DistributionSettings, Spread(Gt(0), Le(1_000), KILO)] = Field(
        alias="stiffness_mN_um"
    )
    friction: Annotated[DistributionSettings, Spread(Ge(0), Le(2), ONE)]
    tangential_stiffness_ratio: Annotated[DistributionSettings, Spread(Gt(0), Le(2), ONE)] = (
        DistributionSettings(constant=STIFFNESS_RATIO.value)
    )
    """Of a contact that sticks, over its normal stiffness."""


class AlignmentDistributionSettings(Settings):
    """Radii of the discs in which alignment leaves the shaft and its tilt."""

    position_error_m: Annotated[DistributionSettings, Spread(Ge(0), Le(1_000), MICRO)] = Field(
        alias="position_error_um"
    )
    tilt_error_rad: Annotated[DistributionSettings, Spread(Ge(0), Le(5), DEGREES)] = Field(
        alias="tilt_error_deg"
    )


class PlantSettings(Settings):
    """All that plants are drawn from, each parameter independently of the others."""

    contact: ContactDistributionSettings
    shaft: ShaftDistributionSettings
    common_clearance_m: Clearance = Field(OFF, alias="common_clearance_um")
    """Of all holes of a part; each hole's own clearance is added to it."""
    holes: Annotated[tuple[HoleDistributionSettings, ...], MinLen(1)]
    """From the one entered first."""
    alignment: AlignmentDistributionSettings
    force_sensor: SensorDistributionSettings
    stage: StageDistributionSettings = StageDistributionSettings()
    arm: ArmDistributionSettings = ArmDistributionSettings()
    holder: HolderDistributionSettings = HolderDistributionSettings()

    @model_validator(mode="after")
    def _check(self) -> "PlantSettings":
        if problems := [*self._problems()]:
            raise ValueError("\n".join(problems))
        return self

    def _problems(self) -> Iterator[str]:
        if self.holes[0].gap_m is not None:
            yield "holes[0].gap_um is not a key: there is no hole before the first"
        least_m = self.shaft.diameter_m.ends[0] + self.common_clearance_m.ends[0]
        for number, hole in enumerate(self.holes):
            if number > 0 and hole.gap_m is None:
                valid = Accepted.of(DistributionSettings).description
                yield f"holes[{number}].gap_um is missing: must be {valid}, in um"
            tightest_m, _ = hole.clearance_m.ends
            if least_m + tightest_m <= 0.0:
                yield (
                    f"holes[{number}].clearance_um reaches {tightest_m * 1e6:.12g}: must be above "
                    f"{-least_m * 1e6:.12g} throughout, where the thinnest shaft has no hole"
                )

    def distribution(self) -> PlantDistribution:
        """Return the plant as the simulator takes it."""
        return PlantDistribution(
            stiffness_N_m=self.contact.stiffness_N_m.distribution(),
            friction=self.contact.friction.distribution(),
            shaft=self.shaft.distribution(),
            holes=tuple(hole.distribution() for hole in self.holes),
            position_error_m=self.alignment.position_error_m.distribution(),
            tilt_error_rad=self.alignment.tilt_error_rad.distribution(),
            sensor=self.force_sensor.distribution(),
            stage=self.stage.distribution(),
            arm=self.arm.distribution(),
            holder=self.holder.distribution(),
            position_noise_m=self.stage.position_noise_m.distribution(),
            common_clearance_m=self.common_clearance_m.distribution(),
            stiffness_ratio=self.contact.tangential_stiffness_ratio.distribution(),
        )
