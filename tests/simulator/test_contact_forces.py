"""Forces and torques: closed forms, signs, friction, symmetries, energy."""

import numpy as np
import pytest

from simulator.candidates import candidates
from simulator.checks import FloatArray
from simulator.contact import ContactLaw, solve
from simulator.geometry import Hole, Part, Shaft, shaft_axis, tilt_of
from simulator.wrench import move_torque

PART = Part((Hole(1.01e-3, 5e-4), Hole(1.01e-3, 5e-4, 1.5e-3)))
SHAFT = Shaft(1e-3, 4e-3)
SMOOTH = ContactLaw(friction=0.0)
STILL = np.zeros(3)
DOWN = np.array([0.0, 0.0, 1.0])


def random_poses(n: int, seed: int, tilt: float = 0.02) -> FloatArray:
    rng = np.random.default_rng(seed)
    return rng.uniform(-1, 1, (n, 5)) * [2e-5, 2e-5, 1.6e-3, tilt, tilt] + [0, 0, 1.5e-3, 0, 0]


@pytest.mark.parametrize(
    ("depth", "stations"),
    [(0.25e-3, 2), (1.2e-3, 2), (2.25e-3, 4), (3.5e-3, 4)],
    ids=["in the upper wall", "between the walls", "in the lower wall", "through both"],
)
def test_untilted_offset_loads_two_stations_per_hole(depth: float, stations: int) -> None:
    wrench = solve(PART, SHAFT, [8e-6, 0.0, depth, 0.0, 0.0], DOWN).wrench
    each = 4e3 * 3e-6
    np.testing.assert_allclose(
        wrench[:3], [stations * each, 0.0, stations * 0.2 * each], rtol=1e-9, atol=1e-15
    )


def test_torque_of_an_untilted_offset_is_force_times_height() -> None:
    """In the upper wall the rim A1 and the edge B2 each push +x: torque about y is F times z."""
    wrench = solve(PART, SHAFT, [8e-6, 0.0, 0.3e-3, 0.0, 0.0], DOWN).wrench
    each, rim_x, edge_x = 0.012, 0.505e-3, 0.508e-3
    torque_y = each * (0.0 + 0.3e-3) - 0.2 * each * (rim_x + edge_x)
    np.testing.assert_allclose(wrench[3:], [0.0, torque_y, 0.0], rtol=1e-9, atol=1e-18)


@pytest.mark.parametrize("side", [(1, 0), (-1, 0), (0, 1), (0, -1)])
def test_a_shaft_against_one_side_pushes_the_part_to_that_side(side: tuple[int, int]) -> None:
    wrench = solve(PART, SHAFT, [8e-6 * side[0], 8e-6 * side[1], 1e-3, 0.0, 0.0], STILL).wrench
    np.testing.assert_allclose(wrench[:2], np.array(side) * 0.024, rtol=1e-9, atol=1e-15)
    # Moving against the measured force relieves the contact.
    back = np.array([8e-6 * side[0], 8e-6 * side[1], 1e-3, 0.0, 0.0])
    back[:2] -= 1e-4 * wrench[:2]
    relieved = solve(PART, SHAFT, back, STILL).wrench
    assert np.linalg.norm(relieved[:2]) < np.linalg.norm(wrench[:2])


@pytest.mark.parametrize(
    ("sliding", "friction"),
    [
        ((0, 0, 1), (0, 0, 1)),
        ((0, 0, 1e-9), (0, 0, 1)),
        ((0, 0, -5), (0, 0, -1)),
        ((0, 2, 0), (0, 1, 0)),
        ((7, 3, 4), (0, 0.6, 0.8)),
        ((1, 0, 0), (0, 0, 0)),
        ((0, 0, 0), (0, 0, 0)),
    ],
)
def test_friction_drags_the_part_along_the_tangential_motion(
    sliding: tuple[float, float, float], friction: tuple[float, float, float]
) -> None:
    wrench = solve(PART, SHAFT, [8e-6, 0.0, 1e-3, 0.0, 0.0], np.array(sliding, float)).wrench
    expected = 0.024 * (np.array([1.0, 0.0, 0.0]) + 0.2 * np.array(friction))
    np.testing.assert_allclose(wrench[:3], expected, rtol=1e-9, atol=1e-15)


def test_inserting_never_reads_a_negative_axial_force() -> None:
    wrench = solve(PART, SHAFT, random_poses(5000, 2, tilt=6e-3), DOWN).wrench
    assert (wrench[:, 2] >= 0.0).all()
    assert (wrench[:, 2] > 0.0).sum() > 1000


def test_force_is_the_gradient_of_the_elastic_energy() -> None:
    """Frictionless and away from the edges: wrench on the part = gradient over the pose."""
    pose = np.array([6e-6, -4e-6, 2.25e-3, 2e-3, -3e-3])

    def energy(p: FloatArray) -> FloatArray:
        return 0.5 * 4e3 * (solve(PART, SHAFT, p, STILL, SMOOTH).penetration ** 2).sum(axis=-1)

    found = solve(PART, SHAFT, pose, STILL, SMOOTH)
    assert (found.penetration > 0.0).sum() >= 3
    steps = np.array([1e-9, 1e-9, 1e-9, 1e-6, 1e-6])
    gradient = np.array([energy(pose + s) - energy(pose - s) for s in np.diag(steps)]) / (2 * steps)
    at_tip = move_torque(found.wrench, pose[:3])
    turned_x = np.array([np.cos(pose[4]), 0.0, -np.sin(pose[4])])
    expected = [*at_tip[:3], at_tip[3:] @ turned_x, at_tip[4]]
    np.testing.assert_allclose(gradient, expected, rtol=1e-6, atol=1e-9)
    # Turning the shaft about its own axis changes nothing, so no torque acts about it.
    assert abs(at_tip[3:] @ shaft_axis(pose)) < 1e-15


def test_turning_the_pose_about_the_hole_turns_the_wrench() -> None:
    poses, angle = random_poses(300, 3), 0.7
    turn = np.array(
        [[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1]]
    )
    turned = np.concatenate([poses[:, :3] @ turn.T, tilt_of(shaft_axis(poses) @ turn.T)], axis=1)
    sliding = np.array([0.3, -0.2, 1.0])
    before = solve(PART, SHAFT, poses, sliding).wrench
    after = solve(PART, SHAFT, turned, turn @ sliding).wrench
    assert np.abs(before[:, :3]).max() > 0.05
    np.testing.assert_allclose(after[:, :3], before[:, :3] @ turn.T, rtol=0, atol=1e-11)
    np.testing.assert_allclose(after[:, 3:], before[:, 3:] @ turn.T, rtol=0, atol=1e-14)


def test_mirroring_the_pose_mirrors_the_wrench() -> None:
    poses = random_poses(300, 4)
    mirrored = poses * [-1, 1, 1, 1, -1]
    before = solve(PART, SHAFT, poses, [0.3, -0.2, 1.0]).wrench
    after = solve(PART, SHAFT, mirrored, [-0.3, -0.2, 1.0]).wrench
    np.testing.assert_allclose(after, before * [-1, 1, 1, 1, -1, -1], rtol=0, atol=1e-13)


def test_wrench_is_the_sum_over_the_contacts() -> None:
    found = solve(PART, SHAFT, random_poses(50, 5), DOWN)
    torque = np.cross(found.point, found.force).sum(axis=-2)
    np.testing.assert_allclose(found.wrench[:, :3], found.force.sum(axis=-2), atol=1e-15)
    np.testing.assert_allclose(found.wrench[:, 3:], torque, atol=1e-18)


def test_moving_the_torque_keeps_the_power_of_any_motion() -> None:
    wrench = solve(PART, SHAFT, random_poses(20, 6), DOWN).wrench
    origin, spin, speed = np.array([1e-3, -2e-3, 5e-3]), np.array([3.0, 1.0, -2.0]), np.ones(3)
    moved = move_torque(wrench, origin)
    speed_there = speed + np.cross(spin, origin)
    power = wrench[:, :3] @ speed + wrench[:, 3:] @ spin
    np.testing.assert_allclose(moved[:, :3] @ speed_there + moved[:, 3:] @ spin, power, atol=1e-15)


@pytest.mark.parametrize("holes", [1, 2, 3])
def test_a_batch_equals_its_poses_one_by_one_bit_for_bit(holes: int) -> None:
    part = Part((Hole(1.01e-3, 5e-4), *(Hole(1.005e-3, 3e-4, 8e-4),) * (holes - 1)))
    poses = random_poses(64, 8).reshape(8, 8, 5)
    poses[0, 0] = [8e-6, 0.0, 1e-3, 0.0, 0.0]
    sliding = np.random.default_rng(1).normal(size=(8, 8, 3))
    batch = solve(part, SHAFT, poses, sliding)
    fields = ("overlap", "penetration", "point", "normal", "force", "wrench")
    assert batch.penetration.shape == (8, 8, 4 * holes)
    assert (batch.penetration > 0.0).any(axis=(0, 1)).sum() >= 2 * holes
    for index in np.ndindex(8, 8):
        single = solve(part, SHAFT, poses[index], sliding[index])
        for name in fields:
            np.testing.assert_array_equal(getattr(single, name), getattr(batch, name)[index])


def test_an_empty_batch_is_valid() -> None:
    assert solve(PART, SHAFT, np.empty((0, 5)), DOWN).wrench.shape == (0, 6)


def test_results_and_tables_are_read_only() -> None:
    found = solve(PART, SHAFT, random_poses(2, 9), DOWN)
    for array in (found.wrench, found.force, found.penetration, found.candidates.kind):
        with pytest.raises(ValueError, match="read-only"):
            array[...] = 0
    assert candidates(PART, SHAFT).kind.tolist() == [0, 0, 0, 0, 1, 1, 2, 2]
    assert candidates(PART, SHAFT).hole.tolist() == [0, 0, 1, 1, 0, 1, 0, 1]
    assert candidates(PART, SHAFT).station.tolist() == [0, 1, 0, 1, 1, 1, 0, 0]
