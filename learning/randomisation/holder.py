"""Settings of what the part's holder is drawn from, axis by axis."""

from typing import Annotated

from annotated_types import Ge, Gt, Le
from pydantic import Field

from drivers.contract.settings import MICRO, MILLI, ONE, Settings
from learning.randomisation.distribution import OFF, DistributionSettings, Spread
from simulator.randomisation.holder import HolderDistribution

_Shift = Annotated[DistributionSettings, Spread(Ge(0), Le(100), MILLI)]
_Turn = Annotated[DistributionSettings, Spread(Ge(0), Le(1_000), ONE)]
_Force = Annotated[DistributionSettings, Spread(Gt(0), Le(10_000), MILLI)]
_Torque = Annotated[DistributionSettings, Spread(Gt(0), Le(1_000_000), MICRO)]
_Place = Annotated[float, Ge(-1_000_000), Le(1_000_000)]


class HolderDistributionSettings(Settings):
    """The holder. An axis is rigid without its compliance, and never slips without its force."""

    compliance_x_m_N: _Shift = Field(OFF, alias="compliance_x_um_mN")
    compliance_y_m_N: _Shift = Field(OFF, alias="compliance_y_um_mN")
    compliance_z_m_N: _Shift = Field(OFF, alias="compliance_z_um_mN")
    compliance_rx_rad_Nm: _Turn = Field(OFF, alias="compliance_rx_urad_uNm")
    compliance_ry_rad_Nm: _Turn = Field(OFF, alias="compliance_ry_urad_uNm")
    holding_force_x_N: _Force | None = Field(None, alias="holding_force_x_mN")
    """What the axis bears before the part slips along it."""
    holding_force_y_N: _Force | None = Field(None, alias="holding_force_y_mN")
    holding_force_z_N: _Force | None = Field(None, alias="holding_force_z_mN")
    holding_torque_rx_Nm: _Torque | None = Field(None, alias="holding_torque_rx_uNm")
    holding_torque_ry_Nm: _Torque | None = Field(None, alias="holding_torque_ry_uNm")
    pivot_m: Annotated[tuple[_Place, _Place, _Place], MICRO] = Field(
        (0.0, 0.0, 0.0), alias="pivot_um"
    )
    """Place in frame M about which the part turns."""

    def distribution(self) -> HolderDistribution:
        """Return the holder as the simulator takes it."""
        compliance = (
            self.compliance_x_m_N,
            self.compliance_y_m_N,
            self.compliance_z_m_N,
            self.compliance_rx_rad_Nm,
            self.compliance_ry_rad_Nm,
        )
        holding_force = (
            self.holding_force_x_N,
            self.holding_force_y_N,
            self.holding_force_z_N,
            self.holding_torque_rx_Nm,
            self.holding_torque_ry_Nm,
        )
        return HolderDistribution(
            tuple(axis.distribution() for axis in compliance),
            tuple(None if axis is None else axis.distribution() for axis in holding_force),
            self.pivot_m,
        )
