"""Distributions of everything about a plant, and batches of plants drawn from them."""

from dataclasses import dataclass, field

import numpy as np

from simulator.checks import FloatArray, read_only
from simulator.contact import ContactLaw
from simulator.effects.arm import ArmEffects
from simulator.effects.sensor import SensorEffects
from simulator.effects.stage import StageEffects
from simulator.geometry import POSE_SIZE, Hole, Part, Shaft
from simulator.initial_pose import unit_disc
from simulator.randomisation.distributions import NONE, Distribution, Uniform, drawn
from simulator.randomisation.rig import (
    ArmDistribution,
    Generators,
    SensorDistribution,
    StageDistribution,
)

_ALL = Uniform(0.0, 1.0)


@dataclass(frozen=True, slots=True)
class HoleDistribution:
    """A hole [m]; `clearance_m` is its diameter less the shaft's, below zero for interference."""

    clearance_m: Distribution
    thickness_m: Distribution
    gap_m: Distribution = NONE
    """Free space after the hole before; always 0 before the first."""


@dataclass(frozen=True, slots=True)
class PlantDistribution:
    """What plants are drawn from, each parameter independently of the others; SI units."""

    stiffness_N_m: Distribution
    friction: Distribution
    shaft_diameter_m: Distribution
    shaft_length_m: Distribution
    holes: tuple[HoleDistribution, ...]
    position_error_m: Distribution
    """Radius of the disc in which alignment leaves the shaft."""
    tilt_error_rad: Distribution
    """Radius of the disc in which alignment leaves its tilt."""
    sensor: SensorDistribution
    stage: StageDistribution = field(default_factory=StageDistribution)
    arm: ArmDistribution = field(default_factory=ArmDistribution)
    position_noise_m: Distribution = NONE
    """Standard deviation of what the stage reports, for each of x, y, z."""

    def __post_init__(self) -> None:
        """Raise `ValueError` where there is no hole, or a gap before the first one."""
        if not self.holes or self.holes[0].gap_m != NONE:
            raise ValueError(
                f"PlantDistribution.holes is {self.holes!r}; it must be a tuple of at least one "
                "HoleDistribution, the first without a gap"
            )


@dataclass(frozen=True, slots=True, eq=False)
class Plants:
    """n plants with N holes each, one per environment; read-only arrays, SI units."""

    stiffness_N_m: FloatArray
    """Shape (n,)."""
    friction: FloatArray
    """Shape (n,)."""
    shaft_diameter_m: FloatArray
    """Shape (n,)."""
    shaft_length_m: FloatArray
    """Shape (n,)."""
    hole_diameter_m: FloatArray
    """Shape (n, N)."""
    hole_thickness_m: FloatArray
    """Shape (n, N)."""
    hole_gap_m: FloatArray
    """Shape (n, N): before each hole, 0 before the first."""
    misalignment: FloatArray
    """Shape (n, 5): what alignment leaves, a pose in M with z = 0 [m, rad]."""
    position_noise_m: FloatArray
    """Shape (n, 3)."""
    sensor: SensorEffects
    """Of a batch of n, as are stage and arm."""
    stage: StageEffects
    arm: ArmEffects

    def shaft(self, index: int) -> Shaft:
        """The shaft of one plant."""
        return Shaft(float(self.shaft_diameter_m[index]), float(self.shaft_length_m[index]))

    def part(self, index: int) -> Part:
        """The part of one plant."""
        sizes = np.stack([self.hole_diameter_m, self.hole_thickness_m, self.hole_gap_m], axis=-1)
        return Part(tuple(Hole(*size) for size in sizes[index].tolist()))

    def law(self, index: int) -> ContactLaw:
        """The contact law of one plant."""
        return ContactLaw(float(self.stiffness_N_m[index]), float(self.friction[index]))


def draw_plants(distribution: PlantDistribution, generators: Generators) -> Plants:
    """One plant per generator; plant i depends on generator i alone.

    Raises `ValueError` for parameters that no plant can have.
    """
    d = distribution

    def one(parameter: Distribution) -> FloatArray:
        return drawn(parameter, 1, generators)

    stiffness, friction = one(d.stiffness_N_m), one(d.friction)
    diameter, length = one(d.shaft_diameter_m), one(d.shaft_length_m)
    holes = [(one(h.clearance_m), one(h.thickness_m), one(h.gap_m)) for h in d.holes]
    clearance, thickness, gap = (np.hstack(column) for column in zip(*holes, strict=True))
    misalignment = np.zeros((len(generators), POSE_SIZE))
    for columns, radius in (
        (slice(0, 2), one(d.position_error_m)),
        (slice(3, 5), one(d.tilt_error_rad)),
    ):
        misalignment[:, columns] = radius * unit_disc(drawn(_ALL, 2, generators))
    return Plants(
        stiffness_N_m=read_only(stiffness[:, 0]),
        friction=read_only(friction[:, 0]),
        shaft_diameter_m=read_only(diameter[:, 0]),
        shaft_length_m=read_only(length[:, 0]),
        hole_diameter_m=read_only(diameter + clearance),
        hole_thickness_m=read_only(thickness),
        hole_gap_m=read_only(gap),
        misalignment=read_only(misalignment),
        position_noise_m=read_only(drawn(d.position_noise_m, 3, generators)),
        sensor=d.sensor.drawn(generators),
        stage=d.stage.drawn(generators),
        arm=d.arm.drawn(generators),
    )
