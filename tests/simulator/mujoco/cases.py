"""Parts, shafts and random poses at which the analytic contact and MuJoCo's are compared.

No friction: both sides find depths, points and normals, and the force is stiffness times depth.
"""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from simulator.checks import FloatArray
from simulator.contact import ContactLaw, Contacts, solve
from simulator.geometry import Hole, Part, Shaft, shaft_axis

BoolArray = npt.NDArray[np.bool_]

LAW = ContactLaw(4e3, 0.0)
OFFSET_M, TILT_RAD, OUTSIDE_M = 1e-5, float(np.radians(0.3)), 5e-5
ROUNDING_M = 1e-10
CROSSING_M = 2.5e-5
"""An end counts as crossing a rim's plane within this: more than any depth plus the end's slope."""
AT_RIM_M = 5e-6


@dataclass(frozen=True, slots=True)
class Case:
    """A part and a shaft."""

    name: str
    part: Part
    shaft: Shaft

    def poses(self, count: int, seed: int = 0) -> FloatArray:
        """Offset and tilt uniform in discs, depth uniform up to 50 um outside the part."""
        rng = np.random.default_rng(seed)
        reach = np.sqrt(rng.random((2, count))) * np.array([[OFFSET_M], [TILT_RAD]])
        angle = rng.uniform(0.0, 2.0 * np.pi, (2, count))
        (x, rx), (y, ry) = reach * np.cos(angle), reach * np.sin(angle)
        z = rng.uniform(-OUTSIDE_M, self.part.rim_depths_m[-1] + OUTSIDE_M, count)
        return np.stack([x, y, z, rx, ry], axis=-1)

    def poses_at_rims(self, count: int, seed: int = 0) -> FloatArray:
        """The same, but with the centre of either end within 5 um of a rim's plane."""
        poses, rng = self.poses(count, seed), np.random.default_rng(seed + 1)
        poses[:, 2] = rng.choice(self.part.rim_depths_m, count)
        poses[:, 2] += rng.uniform(-AT_RIM_M, AT_RIM_M, count)
        behind = rng.choice([0.0, self.shaft.length_m], count)
        poses[:, :3] += behind[:, np.newaxis] * shaft_axis(poses)
        return poses

    def crossing(self, poses: FloatArray) -> BoolArray:
        """Where an end of the shaft is close to a rim's plane."""
        ends = poses[:, 2, np.newaxis] - np.array([0.0, self.shaft.length_m])
        gaps = np.abs(ends[..., np.newaxis] - self.part.rim_depths_m)
        return np.asarray(gaps.min(axis=(1, 2)) < CROSSING_M)

    def solve(self, poses: FloatArray, grown_m: float = 0.0) -> Contacts:
        """The analytic contacts of a shaft that is larger by `grown_m` on all sides."""
        shaft = Shaft(self.shaft.diameter_m + 2 * grown_m, self.shaft.length_m + 2 * grown_m)
        forward = np.array([0.0, 0.0, grown_m, 0.0, 0.0])
        return solve(self.part, shaft, poses + forward, np.zeros(3), LAW)

    def band_m(self, sides: int) -> float:
        """Bound of how far a polygon of n sides moves the boundary of contact [m].

        Along the normal of a side, polygon and circle are equally far from the axis. The deepest
        direction lies within pi/n of such a normal, so of the shaft's displacement D the polygon
        feels at least D cos(pi/n). D is at most the offset plus the lean over the whole depth. This
        supposes that no end cuts the deepest point off.
        """
        displaced = OFFSET_M + TILT_RAD * (self.part.rim_depths_m[-1] + OUTSIDE_M)
        return float(displaced * (1.0 - np.cos(np.pi / sides))) + ROUNDING_M

    def sagitta_m(self, sides: int) -> float:
        """How much farther from the axis than the circle a corner of the polygon is [m]."""
        return float(self.part.wall_radii_m.max() * (1.0 / np.cos(np.pi / sides) - 1.0))


CASES = (
    Case("two holes", Part((Hole(1.01e-3, 5e-4), Hole(1.01e-3, 5e-4, 1.5e-3))), Shaft(1e-3, 4e-3)),
    Case(
        "short shaft, three unequal holes",
        Part((Hole(1.012e-3, 3e-4), Hole(1.01e-3, 5e-4, 8e-4), Hole(1.015e-3, 2e-4, 6e-4))),
        Shaft(1e-3, 1.2e-3),
    ),
)
