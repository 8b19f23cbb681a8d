"""The contact force is continuous in the pose, also where one edge hands a contact to another."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from simulator.checks import FloatArray
from simulator.contact import solve
from simulator.geometry import Hole, Part, Shaft, shaft_axis

PART = Part((Hole(1.01e-3, 5e-4), Hole(1.01e-3, 5e-4, 1.5e-3)))
SHAFT = Shaft(1e-3, 4e-3)
DOWN = np.array([0.0, 0.0, 1.0])
RIMS = [0.0, 0.5e-3, 2.0e-3, 2.5e-3]
UPPER_RIM, LOWER_RIM, LEADING, TRAILING = 0, 1, 4, 6
LEVER_m = 5e-3
LIPSCHITZ_N_m = 40 * 4e3
"""Bound of |change of force| per metre of motion; tilt and torque count with the lever."""


def wrenches_along(pose: FloatArray, direction: FloatArray, half: float, steps: int) -> FloatArray:
    """Wrenches at evenly spaced poses from -half to +half metres along a direction (5,)."""
    scale = np.array([1.0, 1.0, 1.0, 1 / LEVER_m, 1 / LEVER_m])
    t = np.linspace(-half, half, steps + 1)[:, np.newaxis]
    return solve(PART, SHAFT, pose + t * direction * scale, DOWN).wrench


def assert_no_jump(wrenches: FloatArray, step: float) -> None:
    change = np.diff(wrenches, axis=0)
    assert np.linalg.norm(change[:, :3], axis=1).max() <= LIPSCHITZ_N_m * step
    assert np.linalg.norm(change[:, 3:], axis=1).max() <= LIPSCHITZ_N_m * LEVER_m * step


def slanted_pose(
    offset: tuple[float, float], tilt: tuple[float, float], depth: float, end: int, part: float
) -> FloatArray:
    """Pose with an end's centre at `offset`, `part` of the end's slope below the plane at `depth`.

    At -1 the face begins to cut the plane, at 1 all of it is below.
    """
    pose = np.array([*offset, depth + part * SHAFT.radius_m * np.sin(np.hypot(*tilt)), *tilt])
    pose[:3] += (SHAFT.length_m if end == TRAILING else 0.0) * shaft_axis(pose)
    return pose


def shifted_onto(pose: FloatArray, candidate: int, depth: float) -> FloatArray:
    """`pose`, moved along z until a shaft edge's deepest point is level with `depth`."""
    pose = pose.copy()
    for _ in range(4):
        pose[2] += depth - solve(PART, SHAFT, pose, DOWN).point[candidate, 2]
    return pose


@pytest.mark.parametrize("tilt", [(0.0, 0.0), (5e-3, 0.0), (-3e-3, 4e-3), (0.0, -5e-3)])
@pytest.mark.parametrize("offset", [(8e-6, 0.0), (-6e-6, 7e-6)])
def test_no_jump_on_the_way_through_every_rim_plane(
    offset: tuple[float, float], tilt: tuple[float, float]
) -> None:
    pose = np.array([*offset, 3.2e-3, *tilt])
    wrenches = wrenches_along(pose, np.array([0, 0, 1.0, 0, 0]), 3.6e-3, 72_000)
    assert np.linalg.norm(wrenches[:, :3], axis=1).max() > 0.02
    assert (wrenches[0] == 0.0).all()
    assert (wrenches[-1] == 0.0).all()
    assert_no_jump(wrenches, 1e-7)


@settings(max_examples=150)
@given(
    st.tuples(*[st.floats(-1.2e-5, 1.2e-5)] * 2),
    st.tuples(*[st.floats(-6e-3, 6e-3)] * 2),
    st.tuples(*[st.floats(-1, 1)] * 5).filter(lambda d: np.linalg.norm(d) > 0.1),
    st.sampled_from(RIMS),
    st.sampled_from([LEADING, TRAILING]),
)
def test_no_jump_in_any_direction_where_an_edge_meets_a_rim(
    offset: tuple[float, float],
    tilt: tuple[float, float],
    direction: tuple[float, ...],
    depth: float,
    edge: int,
) -> None:
    pose = shifted_onto(np.array([*offset, depth, *tilt]), edge, depth)
    unit = np.array(direction) / np.linalg.norm(direction)
    assert_no_jump(wrenches_along(pose, unit, 4e-8, 80), 1e-9)
    assert_no_jump(wrenches_along(pose, unit, 2e-5, 400), 1e-7)


@settings(max_examples=150)
@given(
    st.tuples(*[st.floats(-1.2e-5, 1.2e-5)] * 2),
    st.tuples(*[st.floats(-6e-3, 6e-3)] * 2),
    st.tuples(*[st.floats(-1, 1)] * 5).filter(lambda d: np.linalg.norm(d) > 0.1),
    st.sampled_from(RIMS),
    st.sampled_from([LEADING, TRAILING]),
    st.floats(-1, 1),
)
def test_no_jump_in_any_direction_while_a_slanted_end_cuts_a_rim_plane(
    offset: tuple[float, float],
    tilt: tuple[float, float],
    direction: tuple[float, ...],
    depth: float,
    end: int,
    part: float,
) -> None:
    pose = slanted_pose(offset, tilt, depth, end, part)
    unit = np.array(direction) / np.linalg.norm(direction)
    assert_no_jump(wrenches_along(pose, unit, 4e-8, 80), 1e-9)
    assert_no_jump(wrenches_along(pose, unit, 2e-5, 400), 1e-7)


@pytest.mark.parametrize("rim", range(4))
@pytest.mark.parametrize("end", [LEADING, TRAILING])
@pytest.mark.parametrize("tilt", [(0.0, -5e-3), (5e-3, 0.0), (3e-3, 4e-3), (0.0, 5e-3)])
def test_no_jump_while_a_slanted_end_passes_a_rim(
    rim: int, end: int, tilt: tuple[float, float]
) -> None:
    """The rim's contact begins, or ends, with the face low on any side of the contact."""
    pose = slanted_pose((8e-6, 0.0), tilt, RIMS[rim], end, 0.0)
    wrenches = wrenches_along(pose, np.array([0, 0, 1.0, 0, 0]), 8e-6, 8_000)
    assert_no_jump(wrenches, 2e-9)
    ends = solve(PART, SHAFT, pose + np.outer([-8e-6, 8e-6], [0, 0, 1, 0, 0]), DOWN)
    outside, inside = ends.penetration[:: 1 if end == LEADING else -1, rim]
    assert outside == 0.0
    assert inside > 2.9e-6


def test_a_tilt_of_nothing_does_not_swing_the_force() -> None:
    """Of an upright end that has just entered, many points are the best one."""
    pose = np.array([8e-6, 0.0, 1e-6, 0.0, 0.0])
    for direction in np.eye(5)[3:]:
        wrenches = wrenches_along(pose, direction, 1e-9, 100)
        assert_no_jump(wrenches, 2e-11)
        np.testing.assert_allclose(wrenches[:, 0], 2 * 4e-3, rtol=1e-3)
        np.testing.assert_allclose(wrenches[:, 1], 0.0, atol=1e-6)


def test_the_far_side_of_a_slanted_end_touches_at_two_points_without_a_jump() -> None:
    """The end is low opposite to the offset: two points, left and right, are then equally good."""
    pose = slanted_pose((8e-6, 0.0), (0.0, 5e-3), 0.0, LEADING, 0.64)
    wrenches = wrenches_along(pose, np.array([0, 1.0, 0, 0, 0]), 1e-8, 100)
    assert (wrenches[:, 0] > 1e-4).all()
    assert_no_jump(wrenches, 2e-10)


def test_the_leading_edge_hands_its_contact_to_the_lower_rim() -> None:
    """Below the upper wall, edge and rim together carry what the edge carried, all the way."""
    depths = 0.5e-3 + np.linspace(-2e-6, 8e-6, 101)
    poses = np.zeros((101, 5))
    poses[:, 0], poses[:, 2] = 8e-6, depths
    penetration = solve(PART, SHAFT, poses, DOWN).penetration
    edge, rim = penetration[:, LEADING], penetration[:, LOWER_RIM]
    np.testing.assert_allclose(edge + rim, 3e-6, atol=1e-15)
    assert edge[0] == pytest.approx(3e-6)
    assert rim[0] == 0.0
    assert edge[-1] == 0.0
    assert rim[-1] == pytest.approx(3e-6)
    shared = (edge > 0.0) & (rim > 0.0)
    assert 25 <= shared.sum() <= 31


def test_the_upper_rim_hands_its_contact_to_the_trailing_edge() -> None:
    poses = np.zeros((101, 5))
    poses[:, 0], poses[:, 2] = 8e-6, 4e-3 + np.linspace(-8e-6, 2e-6, 101)
    penetration = solve(PART, SHAFT, poses, DOWN).penetration
    rim, edge = penetration[:, UPPER_RIM], penetration[:, TRAILING]
    np.testing.assert_allclose(edge + rim, 3e-6, atol=1e-15)
    assert edge[0] == 0.0
    assert rim[0] == pytest.approx(3e-6)
    assert edge[-1] == pytest.approx(3e-6)
    assert rim[-1] == 0.0


def test_entering_and_leaving_start_and_end_at_zero() -> None:
    for depth, sign in ((0.0, 1.0), (6.5e-3, -1.0)):
        outside, inside = depth - sign * 1e-9, depth + sign * 1e-9
        poses = [[8e-6, 0.0, outside, 0.0, 0.0], [8e-6, 0.0, inside, 0.0, 0.0]]
        force = np.linalg.norm(solve(PART, SHAFT, poses, DOWN).wrench[:, :3], axis=1)
        assert force[0] == 0.0
        assert 0.0 < force[1] < 1e-4
