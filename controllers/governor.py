"""The graded governor: no faster than the stage can still brake before a force limit.

While the stage reacts it travels v*T, while it brakes v^2/(2a). Over that distance a force can grow
by its stiffness times the distance, and must stay within what is left of its limit.
"""

import math
from dataclasses import dataclass

from controllers.limits import Limits
from drivers.contract.messages import Vector3


@dataclass(frozen=True, slots=True)
class Travel:
    """How far a move takes the point of the shaft that it moves most [m]."""

    radial_m: float
    """Across the hole; a rotation counts with the longest lever."""
    axial_m: float
    """Along the hole."""
    linear_m: float
    """Path length of the leading end."""
    angle_rad: float

    @classmethod
    def of(cls, translation: Vector3, rotation: Vector3, lever_m: float) -> "Travel":
        angle = math.hypot(*rotation)
        radial = math.hypot(translation[0], translation[1]) + lever_m * angle
        return cls(radial, abs(translation[2]), math.hypot(*translation), angle)

    @property
    def length_m(self) -> float:
        return math.hypot(self.radial_m, self.axial_m)


def braking_speed(distance_m: float, reaction_s: float, deceleration_m_s2: float) -> float:
    """Return the highest speed [m/s] from which the stage comes to rest within `distance_m`."""
    if distance_m <= 0.0:
        return 0.0
    coasting = deceleration_m_s2 * reaction_s
    return math.sqrt(coasting * coasting + 2.0 * deceleration_m_s2 * distance_m) - coasting


def speed_cap(limits: Limits, force: Vector3, force_std: Vector3, travel: Travel) -> float:
    """Return the highest speed [m/s] along `travel` under the load `force` [N].

    The cap falls smoothly from the speed limit to the creep speed as the load, with its uncertainty
    `force_std` added, nears a limit.
    """
    if travel.length_m == 0.0:
        return limits.speed_m_s
    radial, axial = travel.radial_m / travel.length_m, travel.axial_m / travel.length_m
    cross = radial * limits.radial_stiffness_N_m + axial * limits.axial_stiffness_N_m
    growth = (cross, cross, limits.axial_stiffness_N_m)
    distance = min(
        (limit - abs(f) - limits.uncertainty_sigmas * std) / g
        for limit, f, std, g in zip(limits.force_N, force, force_std, growth, strict=True)
    )
    speed = braking_speed(distance, limits.reaction_s, limits.deceleration_m_s2)
    return min(limits.speed_m_s, max(limits.creep_speed_m_s, speed))
