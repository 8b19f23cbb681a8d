"""Response of a stage axis: motion along a path under a speed and an acceleration limit."""

import math
from dataclasses import dataclass, field

from simulator.checks import non_negative, positive

_ROUNDING = 1e-12


@dataclass(frozen=True, slots=True)
class Trapezoid:
    """Fastest motion over `distance_m` that ends at rest, in three legs of constant acceleration.

    The speed goes from the start speed to the peak speed, stays there, and falls to zero. The peak
    is the speed limit, or less where the distance is too short to reach it (the profile is then a
    triangle); a start speed above the limit is braked down to it first. Distance and speeds are
    along the path and at least 0.
    """

    distance_m: float
    start_speed_m_s: float
    speed_limit_m_s: float
    acceleration_m_s2: float
    peak_speed_m_s: float = field(init=False)
    leg_times_s: tuple[float, float, float] = field(init=False)
    """Durations of the three legs: to the peak speed, at it, and to rest."""

    def __post_init__(self) -> None:
        """Raise `ValueError` for invalid numbers, or a start too fast to stop in the distance."""
        distance = non_negative("distance_m", self.distance_m)
        start = non_negative("start_speed_m_s", self.start_speed_m_s)
        limit = positive("speed_limit_m_s", self.speed_limit_m_s)
        a = positive("acceleration_m_s2", self.acceleration_m_s2)
        stopping = 0.5 * start * start / a
        if stopping > distance * (1.0 + _ROUNDING):
            raise ValueError(
                f"start_speed_m_s is {start!r}, which takes {stopping!r} m to stop at {a!r} m/s^2; "
                f"distance_m is {distance!r} and must be at least that"
            )
        peak = min(limit, max(start, math.sqrt(a * distance + 0.5 * start * start)))
        spent = (abs(peak * peak - start * start) + peak * peak) / (2.0 * a)
        cruise = max(0.0, distance - spent) / peak if peak > 0.0 else 0.0
        object.__setattr__(self, "peak_speed_m_s", peak)
        object.__setattr__(self, "leg_times_s", (abs(peak - start) / a, cruise, peak / a))

    @property
    def duration_s(self) -> float:
        """Time until rest [s]."""
        return sum(self.leg_times_s)

    def at(self, time_s: float) -> tuple[float, float]:
        """Return distance covered [m] and speed [m/s] at `time_s` [s] after the start.

        Raises `ValueError` for a time that is negative or not a number.
        """
        if not time_s >= 0.0:
            raise ValueError(f"time_s is {time_s!r}; it must be at least 0")
        to_peak, cruise, to_rest = self.leg_times_s
        a, start, peak = self.acceleration_m_s2, self.start_speed_m_s, self.peak_speed_m_s
        third = time_s - to_peak - cruise
        if third >= to_rest:
            return self.distance_m, 0.0
        slope = a if peak >= start else -a
        if time_s < to_peak:
            return (start + 0.5 * slope * time_s) * time_s, start + slope * time_s
        covered = (start + 0.5 * slope * to_peak) * to_peak + peak * min(time_s - to_peak, cruise)
        if third <= 0.0:
            return min(covered, self.distance_m), peak
        covered += (peak - 0.5 * a * third) * third
        return min(covered, self.distance_m), max(peak - a * third, 0.0)


def braking(start_speed_m_s: float, acceleration_m_s2: float) -> Trapezoid:
    """The profile that only brakes, from `start_speed_m_s` to rest."""
    v = non_negative("start_speed_m_s", start_speed_m_s)
    a = positive("acceleration_m_s2", acceleration_m_s2)
    return Trapezoid(0.5 * v * v / a, v, max(v, 1e-12), a)
