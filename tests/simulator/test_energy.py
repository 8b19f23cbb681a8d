"""Without friction the wrench is the gradient of the elastic energy, for all kinds of surfaces.

The shaft's force on the part is -grad(energy) with the part's motion, so +grad with the shaft's.
This holds wherever the depth below the faces alone decides and the circles' ends do not. A ring's
other points follow the deepest one around. Upright that changes nothing; a tilted ring's wrench
differs from the gradient by about stiffness * r sin^2.
"""

import numpy as np
import pytest

from simulator.candidates import Kind
from simulator.checks import FloatArray
from simulator.contact import ContactLaw, Contacts, solve
from simulator.geometry import Part, Shaft, shaft_axis
from simulator.wrench import move_torque
from tests.simulator.shapes import PARTS, SHAFTS, pressing_poses

STILL, SMOOTH = np.zeros(3), ContactLaw(friction=0.0)
STEPS = np.array([2e-9, 2e-9, 2e-9, 2e-6, 2e-6])


def gradients(part: Part, shaft: Shaft, poses: FloatArray) -> FloatArray:
    """Central differences of fourth order of the energy over poses (P, 5) [N, N*m]."""
    steps = np.array([-2.0, -1.0, 1.0, 2.0])[:, np.newaxis, np.newaxis] * np.diag(STEPS)
    energy = solve(part, shaft, poses[:, np.newaxis, np.newaxis] + steps, STILL, SMOOTH).energy
    return np.asarray(np.einsum("psi,s->pi", energy, [1.0, -8.0, 8.0, -1.0]) / (12.0 * STEPS))


def generalised(poses: FloatArray, wrenches: FloatArray) -> FloatArray:
    """What the wrenches do along x, y, z, rx and ry: the tilt turns about the leading end."""
    at_tip = move_torque(wrenches, poses[:, :3])
    ry = poses[:, 4]
    about_x = at_tip[:, 3] * np.cos(ry) - at_tip[:, 5] * np.sin(ry)
    return np.stack([*at_tip[:, :3].T, about_x, at_tip[:, 4]], axis=-1)


def smooth_poses(part: Part, shaft: Shaft, poses: FloatArray) -> FloatArray:
    """Poses about which no contact begins, ends, or is cut by an end."""
    around = np.vstack([np.zeros(5), np.diag(3.0 * STEPS), -np.diag(3.0 * STEPS)])
    found = solve(part, shaft, poses[:, np.newaxis] + around, STILL, SMOOTH)
    touching = found.penetration > 0.0
    cut = touching & (found.penetration != found.overlap)
    ring = found.ring.penetration > 0.0
    smooth = (touching == touching[:, :1]).all(axis=(1, 2)) & touching[:, 0].any(axis=1)
    smooth &= (ring == ring[:, :1]).all(axis=(1, 2, 3)) & ~cut.any(axis=(1, 2))
    return np.asarray(poses[smooth])


def errors(part: Part, shaft: Shaft, poses: FloatArray, found: Contacts) -> FloatArray:
    """Largest ones of the wrenches against the gradients (P,) [N], torques per millimetre."""
    off = np.abs(gradients(part, shaft, poses) - generalised(poses, found.wrench))
    return np.asarray((off / [1.0, 1.0, 1.0, 1e-3, 1e-3]).max(axis=1))


def loads(found: Contacts) -> FloatArray:
    """Sums (P,) of the sizes of all forces at the deepest points [N]."""
    return np.asarray(np.linalg.norm(found.force, axis=-1).sum(axis=-1))


@pytest.mark.slow
@pytest.mark.parametrize("tilt", [4e-3, 0.03])
@pytest.mark.parametrize("part", PARTS)
@pytest.mark.parametrize("shaft", ["plain", "chamfered", "rounded", "barrel"])
def test_the_wrench_is_the_gradient_of_the_energy(shaft: str, part: str, tilt: float) -> None:
    solid, wall = SHAFTS[shaft], PARTS[part]
    poses = smooth_poses(wall, solid, pressing_poses(wall, 150, seed=9, tilt=tilt))
    ring = solve(wall, solid, poses, STILL, SMOOTH).ring.penetration
    poses = poses[~ring.any(axis=(1, 2))]
    assert len(poses) >= 10
    found = solve(wall, solid, poses, STILL, SMOOTH)
    assert (errors(wall, solid, poses, found) < 1e-6 * loads(found)).all()
    about_tip = move_torque(found.wrench, poses[:, :3])[:, 3:]
    about_itself = (about_tip * shaft_axis(poses)).sum(axis=1)
    assert (np.abs(about_itself) < 1e-12 * loads(found)).all()


@pytest.mark.parametrize("part", PARTS)
def test_the_wrench_of_an_upright_ring_is_the_gradient_of_the_energy(part: str) -> None:
    solid, wall = SHAFTS["interference"], PARTS[part]
    poses = smooth_poses(wall, solid, pressing_poses(wall, 60, seed=10, tilt=0.0, away=4e-6))
    assert len(poses) >= 10
    found = solve(wall, solid, poses, STILL, SMOOTH)
    assert found.ring.penetration.any(axis=(1, 2)).mean() > 0.8
    assert (errors(wall, solid, poses, found) < 1e-6 * loads(found)).all()


def test_the_wrench_of_a_tilted_ring_is_the_gradient_but_for_the_tilt_squared() -> None:
    solid, wall = Shaft(1.02e-3, 4e-3), PARTS["one hole"]
    poses = smooth_poses(wall, solid, pressing_poses(wall, 100, seed=10, tilt=4e-3, away=4e-6))
    assert len(poses) >= 10
    found = solve(wall, solid, poses, STILL, SMOOTH)
    points = (found.ring.penetration > 0.0).sum(axis=(1, 2))
    assert (points >= 3).all()
    allowed = points * 4e3 * solid.radius_m * (1.0 - shaft_axis(poses)[:, 2] ** 2)
    assert (errors(wall, solid, poses, found) < allowed).all()


def test_the_energy_is_half_of_stiffness_times_penetration_squared() -> None:
    pose = [8e-6, 0.0, 2.5e-4, 0.0, 0.0]
    found = solve(PARTS["one hole"], SHAFTS["plain"], pose, STILL)
    assert found.energy == pytest.approx(2 * 0.5 * 4e3 * 3e-6**2)
    assert (found.candidates.kind[found.penetration > 0.0] != Kind.TRAILING_EDGE).all()
    tight = solve(PARTS["one hole"], Shaft(1.02e-3, 4e-3), [0, 0, 1e-3, 0, 0], STILL)
    assert tight.energy == pytest.approx(2 * 4 * 0.5 * 4e3 * 5e-6**2)
