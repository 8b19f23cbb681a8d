"""How far the analytic contact and MuJoCo's are apart, and how far the model of the part explains.

What MuJoCo found at some poses is held against `case` at `poses`: the same, or, to see that a
mistake is noticed, a wrong part or wrong poses.
"""

from dataclasses import dataclass

import numpy as np

from simulator.checks import FloatArray
from tests.simulator.mujoco.cases import LAW, ROUNDING_M, TILT_RAD, BoolArray, Case
from tests.simulator.mujoco.stations import Touches, of_simulator


@dataclass(frozen=True, slots=True)
class Verdicts:
    """Contact or no contact: arrays (P,)."""

    touching: BoolArray
    """In the analytic model."""
    differ: BoolArray
    outside_band: BoolArray
    """Analytically deeper than the band, or still free if the shaft grows by it."""
    crossing: BoolArray
    """An end of the shaft is close to a rim's plane."""
    missed: BoolArray
    """MuJoCo touches, and the analytic model is free even if the shaft grows by the rounding."""
    deep_alone: BoolArray
    """Analytically deeper than the sagitta, and MuJoCo does not touch."""


def verdicts(case: Case, poses: FloatArray, found: Touches, sides: int) -> Verdicts:
    """Compare which poses touch. The polygon lies outside the circle, so MuJoCo touches later."""
    band = case.band_m(sides)
    depth = case.solve(poses).penetration.max(axis=-1)
    theirs = found.depth.max(axis=(1, 2)) > 0.0
    free = case.solve(poses, grown_m=band).penetration.max(axis=-1) == 0.0
    surely_free = case.solve(poses, grown_m=ROUNDING_M).penetration.max(axis=-1) == 0.0
    return Verdicts(
        touching=depth > 0.0,
        differ=theirs != (depth > 0.0),
        outside_band=free | (depth > band),
        crossing=case.crossing(poses),
        missed=theirs & surely_free,
        deep_alone=(depth > case.sagitta_m(sides) + ROUNDING_M) & ~theirs,
    )


@dataclass(frozen=True, slots=True)
class Difference:
    """Absolute differences of one quantity, and what the polygon explains of each."""

    values: FloatArray
    bounds: FloatArray

    def share_of_bound(self) -> float:
        """The largest; at most 1 if all is explained."""
        return float((self.values / self.bounds).max())


@dataclass(frozen=True, slots=True)
class Differences:
    """Depth [m] and normal [rad] of stations, resultant force [N] and torque about M [N*m]."""

    depth: Difference
    """Where either side sees a contact."""
    normal: Difference
    """Where both see one."""
    force: Difference
    force_size_N: FloatArray
    """Of the analytic resultant, at the same poses."""
    torque: Difference


def differences(case: Case, poses: FloatArray, found: Touches, sides: int) -> Differences:
    """Compare poses of which no end crosses a rim; of wrenches those where anything touches.

    The depth of a station may differ by the band. Its normal: a side's misses the deepest direction
    by up to pi/n, and with several contacts to a pair MuJoCo turns it into the box's face, by up to
    the tilt. So its force may differ by stiffness * (depth * both angles together + band), and its
    torque by that times the arm, plus the force times the way of its point along the rim, R pi/n.
    """
    ours, wrench = of_simulator(case, poses), case.solve(poses).wrench
    seen, both = (ours.depth > 0.0) | (found.depth > 0.0), (ours.depth > 0.0) & (found.depth > 0.0)
    touching = seen.any(axis=(1, 2))
    turn, band = np.pi / sides, case.band_m(sides)
    angle = np.hypot(turn, TILT_RAD)
    across = np.linalg.norm(np.cross(found.normal[both], ours.normal[both]), axis=-1)
    along = np.einsum("ij,ij->i", found.normal[both], ours.normal[both])

    forces = LAW.stiffness_N_m * found.depth[..., np.newaxis] * found.normal
    force_off = np.linalg.norm(forces.sum(axis=(1, 2)) - wrench[:, :3], axis=-1)
    torque = np.cross(found.point, forces).sum(axis=(1, 2))
    torque_off = np.linalg.norm(torque - wrench[:, 3:], axis=-1)
    force_bound = LAW.stiffness_N_m * seen * (ours.depth * angle + band)
    arm = np.linalg.norm(np.maximum(np.abs(found.point), np.abs(ours.point)), axis=-1)
    moved = LAW.stiffness_N_m * ours.depth * case.part.wall_radii_m.max() * turn
    torque_bound = arm * force_bound + moved

    depth_off, angle_off = np.abs(found.depth - ours.depth)[seen], np.arctan2(across, along)
    return Differences(
        depth=Difference(depth_off, np.full(depth_off.shape, band)),
        normal=Difference(angle_off, np.full(angle_off.shape, angle)),
        force=Difference(force_off[touching], force_bound.sum(axis=(1, 2))[touching]),
        force_size_N=np.linalg.norm(wrench[touching, :3], axis=-1),
        torque=Difference(torque_off[touching], torque_bound.sum(axis=(1, 2))[touching]),
    )


def axial_normal_differences(
    case: Case, poses: FloatArray, found: Touches, sides: int
) -> Difference:
    """Axial part of the normal at each wall's deepest point, `found` with one contact to a pair.

    MuJoCo then leaves the normal as its collider finds it, perpendicular to the shaft's axis. A
    turn about that axis by pi/n moves the axial part by up to tilt * pi/n. Walls whose two stations
    are equally deep within the band are left out: either may be the deepest.
    """
    ours = of_simulator(case, poses)
    theirs_z, ours_z = (
        np.take_along_axis(t.normal[..., 2], t.depth.argmax(-1)[..., np.newaxis], -1)
        for t in (found, ours)
    )
    clear = np.abs(np.diff(ours.depth, axis=-1)) > 2.0 * case.band_m(sides)
    off = np.abs(theirs_z - ours_z)[clear]
    return Difference(off, np.full(off.shape, TILT_RAD * np.pi / sides))
