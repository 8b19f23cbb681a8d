"""A shaft thicker than its hole touches along a ring: closed forms, and no jump anywhere."""

import numpy as np
import pytest

from simulator import ring
from simulator.checks import FloatArray
from simulator.contact import ContactLaw, solve
from simulator.geometry import Hole, Part, Shaft, shaft_axis, tilt_of
from simulator.profile import Chamfer, Rounding
from simulator.states import ContactState, contact_state, phase_codes, touching_stations

PART = Part((Hole(1.01e-3, 5e-4), Hole(1.01e-3, 5e-4, 1.5e-3)))
TIGHT = Shaft(1.02e-3, 4e-3)
STILL, DOWN = np.zeros(3), np.array([0.0, 0.0, 1.0])
SMOOTH = ContactLaw(friction=0.0)
INSIDE = np.array([0.0, 0.0, 1.2e-3, 0.0, 0.0])
DELTA = 5e-6


def test_a_coaxial_ring_has_no_resultant_but_the_friction_of_its_normal_load() -> None:
    """Two rims of the upper wall, each with the normal load 4 k delta."""
    found = solve(PART, TIGHT, INSIDE, DOWN)
    np.testing.assert_allclose(found.penetration, [DELTA, DELTA] + [0.0] * 6, atol=1e-18)
    np.testing.assert_allclose(found.ring.penetration[:2], DELTA, rtol=1e-12)
    normal_load = 2 * 4 * 4e3 * DELTA
    expected = [0.0, 0.0, 0.2 * normal_load, 0.0, 0.0, 0.0]
    np.testing.assert_allclose(found.wrench, expected, rtol=1e-12, atol=1e-16)
    np.testing.assert_allclose(solve(PART, TIGHT, INSIDE, STILL).wrench, 0.0, atol=1e-16)


@pytest.mark.parametrize("angle", [0.0, 0.3, 0.785, 2.0])
def test_the_lateral_stiffness_of_a_ring_is_twice_that_of_a_point(angle: float) -> None:
    """2k of each rim, less 2k delta/R: offset by e, the points aside are pushed e/R outwards."""
    away = 1e-7 * np.array([np.cos(angle), np.sin(angle)])
    found = solve(PART, TIGHT, INSIDE + np.array([*away, 0.0, 0.0, 0.0]), STILL, SMOOTH)
    stiffness = 2 * 2 * 4e3 * (1.0 - DELTA / 0.505e-3)
    np.testing.assert_allclose(found.wrench[:2], stiffness * away, rtol=1e-6, atol=1e-12)
    expected = 2 * 4e3 * 2 * DELTA**2 + 0.5 * stiffness * 1e-14
    assert found.energy == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize("shaft", [TIGHT, Shaft(1.02e-3, 4e-3, Rounding(2e-5))])
@pytest.mark.parametrize("tilt", [0.0, 5e-3])
def test_no_jump_through_the_centre(shaft: Shaft, tilt: float) -> None:
    steps = np.linspace(-2e-8, 2e-8, 201)
    for direction in ([1.0, 0.0], [0.6, 0.8], [0.0, 1.0]):
        poses = np.tile(INSIDE + np.array([0.0, 0.0, 0.0, 0.0, tilt]), (201, 1))
        poses[:, :3] += 0.95e-3 * shaft_axis(poses) - [0.0, 0.0, 0.95e-3]
        poses[:, :2] += np.outer(steps, direction)
        force = solve(PART, shaft, poses, DOWN).wrench[:, :3]
        assert np.abs(np.diff(force, axis=0)).max() < 40 * 4e3 * 2e-10
        assert force[:, 2].min() > 0.03


@pytest.mark.parametrize("centre", [1e-9, -1e-9])
def test_no_jump_where_a_wedged_shaft_turns_from_one_side_to_the_other(centre: float) -> None:
    """Beyond arccos(d/D) the shaft touches a rim on two sides; the greater one changes at 0."""
    part, shaft, tilt = Part((Hole(1.001e-3, 5e-4),)), Shaft(1e-3, 4e-3), 0.05
    offsets = np.linspace(-1e-7, 1e-7, 401) + centre
    poses = np.zeros((401, 5))
    poses[:, 4] = tilt
    poses[:, :3] = 1e-3 * shaft_axis(poses)
    poses[:, 0] += offsets
    found = solve(part, shaft, poses, STILL)
    upper = found.force[:, 0] + found.ring.force[:, 0].sum(axis=1)
    assert ((found.ring.penetration[:, 0] > 0.0).sum(axis=1) == 1).all()
    assert np.sign(found.point[[0, -1], 0, 0]).sum() == 0
    assert np.abs(np.diff(upper, axis=0)).max() < 4 * 4e3 * 5e-10
    assert np.abs(np.diff(found.wrench[:, :3], axis=0)).max() < 8 * 4e3 * 5e-10


def random_poses(n: int, seed: int) -> FloatArray:
    scale = [6e-6, 6e-6, 1.6e-3, 5e-3, 5e-3]
    return np.random.default_rng(seed).uniform(-1, 1, (n, 5)) * scale + [0, 0, 1.5e-3, 0, 0]


def test_turning_and_mirroring_turns_and_mirrors_the_wrench() -> None:
    part = Part((Hole(1.01e-3, 5e-4, entry=Chamfer(3e-5, 4e-5)), PART.holes[1]))
    shaft = Shaft(1.016e-3, 4e-3, Rounding(6e-5))
    poses, angle, sliding = random_poses(300, 3), 0.7, np.array([0.3, -0.2, 1.0])
    turn = np.array(
        [[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1]]
    )
    turned = np.concatenate([poses[:, :3] @ turn.T, tilt_of(shaft_axis(poses) @ turn.T)], axis=1)
    before = solve(part, shaft, poses, sliding)
    assert (before.ring.penetration > 0.0).any(axis=-1).sum() > 500
    after = solve(part, shaft, turned, turn @ sliding).wrench
    np.testing.assert_allclose(after[:, :3], before.wrench[:, :3] @ turn.T, rtol=0, atol=1e-10)
    np.testing.assert_allclose(after[:, 3:], before.wrench[:, 3:] @ turn.T, rtol=0, atol=1e-13)
    mirrored = solve(part, shaft, poses * [-1, 1, 1, 1, -1], sliding * [-1, 1, 1])
    expected = before.wrench * [-1, 1, 1, 1, -1, -1]
    np.testing.assert_allclose(mirrored.wrench, expected, rtol=0, atol=1e-12)


def test_with_clearance_only_one_point_of_a_circle_touches() -> None:
    loose = solve(PART, Shaft(1e-3, 4e-3), random_poses(500, 4) * [3, 3, 1, 1, 1], DOWN)
    assert (loose.penetration > 0.0).any(axis=1).sum() > 200
    assert not loose.ring.penetration.any()
    assert not loose.ring.force.any()


def test_a_ring_counts_as_one_station_and_the_wrench_as_the_sum_of_all_points() -> None:
    poses = random_poses(50, 5)
    found = solve(PART, TIGHT, poses, DOWN)
    points = np.concatenate([found.point[..., np.newaxis, :], found.ring.point], axis=-2)
    forces = np.concatenate([found.force[..., np.newaxis, :], found.ring.force], axis=-2)
    torque = np.cross(points, forces).sum(axis=(1, 2))
    np.testing.assert_allclose(found.wrench[:, :3], forces.sum(axis=(1, 2)), atol=1e-14)
    np.testing.assert_allclose(found.wrench[:, 3:], torque, atol=1e-17)
    coaxial = solve(PART, TIGHT, INSIDE, DOWN)
    assert touching_stations(coaxial).tolist() == [[True, True], [False, False]]
    assert contact_state(coaxial, int(phase_codes(PART, INSIDE[2]))) is ContactState.E


def test_other_points_are_left_out_only_where_they_cannot_touch(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Tilts and offsets up to where three points touch, for clearances of 10 um and 0.2 um."""
    rng, asked = np.random.default_rng(8), ring._may_touch
    answers: list[bool] = []
    monkeypatch.setattr(ring, "_may_touch", lambda *a: answers.append(asked(*a)) or True)
    for _ in range(250):
        hole = rng.choice([1.01e-3, 1.0002e-3])
        part, shaft = Part((Hole(hole, 5e-4),)), Shaft(1e-3, 4e-3)
        tilt, away = 10.0 ** rng.uniform(-3, -0.5), 10.0 ** rng.uniform(-6, -3.5)
        pose = rng.uniform(-1, 1, 5) * [away, away, 3e-3, tilt, tilt]
        found = solve(part, shaft, pose, STILL)
        assert answers[-1] or not found.ring.penetration.any()
    assert 50 < sum(answers) < 200
