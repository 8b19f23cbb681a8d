"""Distributions of everything about a plant, and batches of plants drawn from them."""

from dataclasses import dataclass, field

import numpy as np

from simulator.checks import FloatArray, read_only
from simulator.contact import ContactLaw
from simulator.effects.arm import ArmEffects
from simulator.effects.sensor import SensorEffects
from simulator.effects.stage import StageEffects
from simulator.geometry import POSE_SIZE, Hole, Part, Shaft
from simulator.holder import Holder
from simulator.initial_pose import unit_disc
from simulator.profile import Chamfer, Rounding
from simulator.randomisation.distributions import (
    NONE,
    Constant,
    Distribution,
    Generators,
    Uniform,
    drawn,
)
from simulator.randomisation.geometry import HoleDistribution, ShaftDistribution
from simulator.randomisation.holder import HolderDistribution
from simulator.randomisation.rig import ArmDistribution, SensorDistribution, StageDistribution
from simulator.stick import StickLaw

_ALL = Uniform(0.0, 1.0)
_NOMINAL = StickLaw()
STIFFNESS_RATIO = Constant(_NOMINAL.tangential_stiffness_N_m / _NOMINAL.contact.stiffness_N_m)
"""Tangential over normal stiffness of the nominal law."""


@dataclass(frozen=True, slots=True)
class PlantDistribution:
    """What plants are drawn from, each parameter independently of the others; SI units."""

    stiffness_N_m: Distribution
    friction: Distribution
    shaft: ShaftDistribution
    holes: tuple[HoleDistribution, ...]
    position_error_m: Distribution
    """Radius of the disc in which alignment leaves the shaft."""
    tilt_error_rad: Distribution
    """Radius of the disc in which alignment leaves its tilt."""
    sensor: SensorDistribution
    stage: StageDistribution = field(default_factory=StageDistribution)
    arm: ArmDistribution = field(default_factory=ArmDistribution)
    holder: HolderDistribution = field(default_factory=HolderDistribution)
    position_noise_m: Distribution = NONE
    """Standard deviation of what the stage reports, for each of x, y, z."""
    common_clearance_m: Distribution = NONE
    """Drawn once per part and added to the clearance of each of its holes."""
    stiffness_ratio: Distribution = STIFFNESS_RATIO
    """Tangential over normal stiffness of a contact that sticks."""

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
    tangential_stiffness_N_m: FloatArray
    """Shape (n,)."""
    shaft_diameter_m: FloatArray
    """Shape (n,)."""
    shaft_length_m: FloatArray
    """Shape (n,)."""
    shaft_leading_m: FloatArray
    """Shape (n, 2): width and height of the leading chamfer, 0 without one."""
    shaft_rounding_m: FloatArray
    """Shape (n,): radius of the leading end, 0 where it is not rounded."""
    shaft_trailing_m: FloatArray
    """Shape (n, 2): as the leading chamfer."""
    hole_diameter_m: FloatArray
    """Shape (n, N)."""
    hole_thickness_m: FloatArray
    """Shape (n, N)."""
    hole_gap_m: FloatArray
    """Shape (n, N): before each hole, 0 before the first."""
    hole_entry_m: FloatArray
    """Shape (n, N, 2): width and height of the chamfer at each mouth, 0 without one."""
    misalignment: FloatArray
    """Shape (n, 5): what alignment leaves, a pose in M with z = 0 [m, rad]."""
    position_noise_m: FloatArray
    """Shape (n, 3)."""
    sensor: SensorEffects
    """Of a batch of n, as are stage, arm and holders."""
    stage: StageEffects
    arm: ArmEffects
    holders: Holder

    def shaft(self, index: int) -> Shaft:
        """The shaft of one plant; raises `ValueError` for one that cannot be."""
        rounding = float(self.shaft_rounding_m[index])
        return Shaft(
            float(self.shaft_diameter_m[index]),
            float(self.shaft_length_m[index]),
            Rounding(rounding) if rounding else _chamfer(*self.shaft_leading_m[index].tolist()),
            _chamfer(*self.shaft_trailing_m[index].tolist()),
        )

    def part(self, index: int) -> Part:
        """The part of one plant; raises `ValueError` for one that cannot be."""
        sizes = (self.hole_diameter_m, self.hole_thickness_m, self.hole_gap_m, self.hole_entry_m)
        holes = zip(*(size[index].tolist() for size in sizes), strict=True)
        return Part(
            tuple(
                Hole(diameter, thickness, gap, _chamfer(*entry))
                for diameter, thickness, gap, entry in holes
            )
        )

    def law(self, index: int) -> ContactLaw:
        """The contact law of one plant."""
        return ContactLaw(float(self.stiffness_N_m[index]), float(self.friction[index]))

    def stick_law(self, index: int) -> StickLaw:
        """The contact law of one plant, with friction that sticks."""
        return StickLaw(self.law(index), float(self.tangential_stiffness_N_m[index]))

    def holder(self, index: int) -> Holder:
        """The holder of one plant."""
        h = self.holders
        return Holder(h.compliance[index], h.holding_force[index], h.pivot_m)


def draw_plants(distribution: PlantDistribution, generators: Generators) -> Plants:
    """One plant per generator; plant i depends on generator i alone.

    Raises `ValueError` for effects and holders that no plant can have.
    """
    d = distribution

    def one(parameter: Distribution) -> FloatArray:
        return drawn(parameter, 1, generators)[:, 0]

    stiffness, friction, ratio = one(d.stiffness_N_m), one(d.friction), one(d.stiffness_ratio)
    shaft = d.shaft.drawn(generators)
    common = one(d.common_clearance_m)
    holes = np.stack([hole.drawn(generators) for hole in d.holes], axis=1)
    misalignment = np.zeros((len(generators), POSE_SIZE))
    for columns, radius in (
        (slice(0, 2), one(d.position_error_m)),
        (slice(3, 5), one(d.tilt_error_rad)),
    ):
        misalignment[:, columns] = radius[:, np.newaxis] * unit_disc(drawn(_ALL, 2, generators))
    return Plants(
        stiffness_N_m=read_only(stiffness),
        friction=read_only(friction),
        tangential_stiffness_N_m=read_only(ratio * stiffness),
        shaft_diameter_m=read_only(shaft[:, 0]),
        shaft_length_m=read_only(shaft[:, 1]),
        shaft_leading_m=read_only(shaft[:, 2:4]),
        shaft_rounding_m=read_only(shaft[:, 4]),
        shaft_trailing_m=read_only(shaft[:, 5:7]),
        hole_diameter_m=read_only(shaft[:, :1] + (common[:, np.newaxis] + holes[..., 0])),
        hole_thickness_m=read_only(holes[..., 1]),
        hole_gap_m=read_only(holes[..., 2]),
        hole_entry_m=read_only(holes[..., 3:]),
        misalignment=read_only(misalignment),
        position_noise_m=read_only(drawn(d.position_noise_m, 3, generators)),
        sensor=d.sensor.drawn(generators),
        stage=d.stage.drawn(generators),
        arm=d.arm.drawn(generators),
        holders=d.holder.drawn(generators),
    )


def _chamfer(width_m: float, height_m: float) -> Chamfer | None:
    return Chamfer(width_m, height_m) if width_m or height_m else None
