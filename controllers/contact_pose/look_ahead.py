"""Moves chosen by looking ahead: as far as the hypotheses agree that it stays gentle.

The shaft is turned upright and centred by the mean of the belief; how far it then goes into the
hole depends on the force that the contact model expects there.
"""

from dataclasses import dataclass

import numpy as np

from controllers.contact_pose.contact_model import ContactModel
from controllers.contact_pose.hypotheses import OFFSET, TILT
from controllers.messages import Move
from simulator.checks import FloatArray, non_negative


@dataclass(frozen=True, slots=True)
class LookAheadSettings:
    """How gently to go. Raises `ValueError`, naming the setting, for one that is out of range."""

    step_box_m: tuple[float, float, float]
    turn_rad: float
    """Largest turn about each axis in one step; 0 keeps the tilt."""
    axial_steps_m: tuple[float, ...]
    """To choose from, the longest first."""
    force_budget_N: float
    """Radial force that the step chosen may lead to; where all lead to more, as much as that of the
    shortest."""
    quantile: float
    """Share of the hypotheses that must stay within it."""
    samples: int
    """Hypotheses that are asked."""

    def __post_init__(self) -> None:
        for size in self.step_box_m:
            non_negative("LookAheadSettings.step_box_m", size)
        non_negative("LookAheadSettings.turn_rad", self.turn_rad)
        non_negative("LookAheadSettings.force_budget_N", self.force_budget_N)
        steps = np.array(self.axial_steps_m)
        if (
            not (steps.size and (np.abs(steps) <= self.step_box_m[2]).all())
            or (np.diff(steps) >= 0.0).any()
        ):
            raise ValueError(
                f"LookAheadSettings.axial_steps_m is {self.axial_steps_m}; it must hold steps in "
                f"the step box, {self.step_box_m[2]}, the longest first"
            )
        if not 0.0 <= self.quantile <= 1.0:
            raise ValueError(
                f"LookAheadSettings.quantile is {self.quantile}; it must be from 0 to 1"
            )
        if self.samples < 1:
            raise ValueError(f"LookAheadSettings.samples is {self.samples}; it must be at least 1")


def look_ahead(
    model: ContactModel,
    hypotheses: FloatArray,
    mean: FloatArray,
    pose: FloatArray,
    pivot_depth_m: float,
    settings: LookAheadSettings,
) -> Move:
    """The move from the reported `pose` (5,) for equally likely `hypotheses` (n, 7) of this `mean`.

    The point of the axis at `pivot_depth_m` is put on the hole's axis, and the turn leaves it
    there: what the shaft touches there is not moved by the turn. Beside the move stands
    what force the quantile expects on each axis at its end.
    """
    tilt = mean[TILT] + pose[3:]
    turn = np.clip(-tilt, -settings.turn_rad, settings.turn_rad)
    lever = max(pose[2] - pivot_depth_m, 0.0)
    turned = tilt + turn
    # The axis points along (ry, -rx, 1): B2 is beside the pivot by that times the lever.
    beside = lever * np.array([turned[1], -turned[0]])
    box = np.array(settings.step_box_m)
    sideways = np.clip(beside - mean[OFFSET] - pose[:2], -box[:2], box[:2])
    steps = np.zeros((len(settings.axial_steps_m), 5))
    steps[:, :2], steps[:, 3:] = sideways, turn
    steps[:, 2] = settings.axial_steps_m
    found = model.contacts(hypotheses, pose + steps, np.ascontiguousarray(steps[:, :3]))
    forces = np.abs(found.wrench[:, :3]).reshape(-1, len(steps), 3)
    radial = np.hypot(forces[..., 0], forces[..., 1])
    expected = np.quantile(radial, settings.quantile, axis=0)
    limit = max(settings.force_budget_N, float(expected[-1]))
    chosen = int(np.argmax(expected <= limit))
    fx, fy, fz = np.quantile(forces[:, chosen], settings.quantile, axis=0).tolist()
    return Move(
        (float(sideways[0]), float(sideways[1]), float(steps[chosen, 2])),
        (float(turn[0]), float(turn[1]), 0.0),
        (fx, fy, fz),
    )
