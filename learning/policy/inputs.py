"""Names and units of what a policy sees and answers, and where the cell reads each input.

Torques are taken about the origin of frame F, as the sensor reports them.
"""

from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import NamedTuple

from controllers.messages import Observation


class Input(NamedTuple):
    """A number that a policy sees."""

    name: str
    """One of `READINGS`."""
    scale: float
    """SI value that the network sees as 1."""


class Output(NamedTuple):
    """A number that a policy answers."""

    name: str
    """One of `OUTPUT_UNITS`."""
    scale: float
    """SI value of the network's largest answer."""


class Reading(NamedTuple):
    """Where an input comes from."""

    unit: str
    read: Callable[[Observation], float]


READINGS: Mapping[str, Reading] = MappingProxyType(
    {
        "force_x": Reading("N", lambda seen: seen.wrench[0]),
        "force_y": Reading("N", lambda seen: seen.wrench[1]),
        "force_z": Reading("N", lambda seen: seen.wrench[2]),
        "torque_x": Reading("N m", lambda seen: seen.wrench[3]),
        "torque_y": Reading("N m", lambda seen: seen.wrench[4]),
        "torque_z": Reading("N m", lambda seen: seen.wrench[5]),
        "depth": Reading("m", lambda seen: seen.pose.position[2]),
        "turn_x": Reading("rad", lambda seen: seen.pose.rotation[0]),
        "turn_y": Reading("rad", lambda seen: seen.pose.rotation[1]),
        "displacement_x": Reading("m", lambda seen: seen.displacement[0]),
        "displacement_y": Reading("m", lambda seen: seen.displacement[1]),
        "displacement_z": Reading("m", lambda seen: seen.displacement[2]),
    }
)
"""Every input by name."""

OUTPUT_UNITS: Mapping[str, str] = MappingProxyType(
    {"step_x": "m", "step_y": "m", "step_z": "m", "turn_x": "rad", "turn_y": "rad"}
)
"""Every output by name: translation along and rotation about the axes of frame M."""
