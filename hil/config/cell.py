"""The settings of a cell: which files, which devices, and how they are used."""

from typing import Annotated, Literal

from annotated_types import Ge, Le, MaxLen, MinLen
from pydantic import ConfigDict, Field

from controllers.settings import FilterSettings, SkillSettings
from drivers.contract.settings import MICRO, Settings

_Name = Annotated[str, MinLen(1), MaxLen(80)]
_FileName = Annotated[str, MinLen(1), MaxLen(1_000)]
_Coordinate = Annotated[float, Ge(-10_000_000), Le(10_000_000)]
_Position = Annotated[tuple[_Coordinate, _Coordinate, _Coordinate], MICRO]


class BackendChoice(Settings):
    """A device: the name of its backend; the other keys are the backend's own."""

    model_config = ConfigDict(extra="allow")

    backend: str


class ControllerChoice(Settings):
    """A controller: its kind; the other keys are the kind's own."""

    model_config = ConfigDict(extra="allow")

    kind: Literal["proportional", "skill", "look_ahead"]


class PolicySettings(Settings):
    """A trained policy on top of the expert that it was trained with."""

    kind: Literal["skill"]
    policy: _FileName
    """File of the policy, relative to the cell's."""


class ArmPoses(Settings):
    """Where the arm goes, in the cell's frame."""

    hold_m: _Position = Field(alias="hold_um")
    """Where the part is held while the shaft is inserted."""
    tray_m: _Position = Field(alias="tray_um")
    """Where parts are picked up and put down."""


class CellSettings(Settings):
    """The file of a cell, except for what belongs to the devices' backends."""

    limits: _FileName
    """File of the machine's limits, relative to the cell's."""
    part: _FileName
    """File of the part, relative to the cell's."""
    force_sensor: BackendChoice
    stage: BackendChoice
    arm: BackendChoice
    gripper: BackendChoice
    arm_poses: ArmPoses
    filter: FilterSettings
    skill: SkillSettings
    controllers: Annotated[dict[_Name, ControllerChoice], MinLen(1)]
