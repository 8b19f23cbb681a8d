"""A part, a prior and a filter of moderate size, and observations made by hand."""

import math
from collections.abc import Iterable

import numpy as np

from controllers.contact_pose.contact_model import ContactModel, Noise
from controllers.contact_pose.filter import ContactPoseFilter, FilterEffort
from controllers.contact_pose.hypotheses import Prior
from controllers.contact_pose.place import StageNoise
from controllers.messages import Observation
from drivers.contract.messages import Pose, Vector3, Wrench
from simulator.checks import FloatArray
from simulator.geometry import Hole, Part, Shaft

NO_LOAD: Wrench = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
SENSOR_M = (0.0, 0.0, 0.04)
SHAFT = Shaft(1e-3, 4e-3)
PRIOR = Prior(10e-6, math.radians(0.3), (2e3, 12e3), (2e-6, 14e-6), (0.1, 0.3))
NOISE = Noise(2e-3, 1e-5, 0.1e-6, 0.05)
STAGE = StageNoise(0.5e-6, 0.02e-6)


def part(clearance_m: float = 8e-6, gap_m: float = 2e-3) -> Part:
    bore = SHAFT.diameter_m + clearance_m
    return Part((Hole(bore, 5e-4), Hole(bore, 5e-4, gap_m)))


def contact_model() -> ContactModel:
    return ContactModel(part(), SHAFT, SENSOR_M)


def contact_pose_filter(
    seed: int, effort: FilterEffort = FilterEffort(256, 6), prior: Prior = PRIOR
) -> ContactPoseFilter:
    generator = np.random.default_rng(seed)
    return ContactPoseFilter(contact_model(), prior, NOISE, STAGE, generator, effort)


def seen(
    position: Iterable[float],
    wrench: Iterable[float] = NO_LOAD,
    commanded: Iterable[float] | None = None,
    rotation: Vector3 = (0.0, 0.0, 0.0),
    step: int = 0,
) -> Observation:
    place = _three(position)
    sent = place if commanded is None else _three(commanded)
    fx, fy, fz, tx, ty, tz = wrench
    return Observation(
        0,
        step,
        (fx, fy, fz, tx, ty, tz),
        NO_LOAD,
        Pose(place, rotation),
        (0.0, 0.0, 0.0),
        Pose(sent, rotation),
    )


def finish(work: Iterable[None]) -> None:
    for _ in work:
        pass


def pressing(seed: int, n: int) -> tuple[FloatArray, FloatArray]:
    """Poses (n, 5) about and in both holes, and small steps (n, 3) that led there."""
    rng = np.random.default_rng(seed)
    tilt = math.radians(0.3)
    poses = rng.uniform(-1.0, 1.0, (n, 5)) * [5e-6, 5e-6, 0.0, tilt, tilt]
    poses[:, 2] = rng.uniform(-2e-5, 3.3e-3, n)
    return poses, rng.uniform(-1.0, 1.0, (n, 3)) * [2e-5, 2e-5, 6e-5]


def _three(values: Iterable[float]) -> Vector3:
    x, y, z = (float(value) for value in values)
    return (x, y, z)
