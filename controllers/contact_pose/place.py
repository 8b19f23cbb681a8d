"""Where the stage is: what it was told to do, and slowly what it reports."""

from dataclasses import dataclass

import numpy as np

from controllers.messages import Observation
from drivers.contract.messages import Pose
from simulator.checks import FloatArray, non_negative

_TRUSTED = 5.0
"""A report so many deviations off means that the stage did not go where it was sent."""


@dataclass(frozen=True, slots=True)
class StageNoise:
    """Standard deviations of translations; turns are taken as reported.

    Raises `ValueError`, naming the setting, for one that is negative or not finite.
    """

    report_m: float
    """Of a reported place."""
    step_m: float
    """Of what comes of a commanded step."""

    def __post_init__(self) -> None:
        non_negative("StageNoise.report_m", self.report_m)
        non_negative("StageNoise.step_m", self.step_m)


class PlaceFilter:
    """A Kalman filter of the stage's place on each axis, with its commands as input.

    It begins where the stage was last sent, not at its first report: all later reports would be off
    by the error of that one and would pull the place away in the course of an insertion.
    """

    def __init__(self, noise: StageNoise) -> None:
        self._noise = noise
        self._variance_m2 = 0.0
        """Of the place on each axis."""
        self._commanded: Pose | None = None
        self.pose: FloatArray | None = None
        """(5,), in M; None before the first observation."""

    def update(self, observation: Observation) -> FloatArray:
        """Take in an observation; return the pose (5,)."""
        before, self._commanded = self._commanded, observation.commanded
        reported = np.array([*observation.pose.position, *observation.pose.rotation[:2]])
        if before is None or self.pose is None:
            place = np.array(self._commanded.position)
        elif before != self._commanded:
            place = self.pose[:3] + np.subtract(self._commanded.position, before.position)
        else:
            return self.pose
        self.pose = np.concatenate([self._corrected(place, reported[:3]), reported[3:]])
        return self.pose

    def _corrected(self, place: FloatArray, reported: FloatArray) -> FloatArray:
        of_report = self._noise.report_m**2
        variance = self._variance_m2 + self._noise.step_m**2
        innovation = reported - place
        if (innovation**2 > _TRUSTED**2 * (variance + of_report)).any():
            self._variance_m2 = of_report
            return reported
        gain = variance / max(variance + of_report, np.finfo(float).tiny)
        self._variance_m2 = (1.0 - gain) * variance
        corrected: FloatArray = place + gain * innovation
        return corrected
