"""The contact force is continuous in the pose, also where one edge hands a contact to another."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from simulator.checks import FloatArray
from simulator.contact import solve
from simulator.geometry import Hole, Part, Shaft

PART = Part((Hole(1.01e-3, 5e-4), Hole(1.01e-3, 5e-4, 1.5e-3)))
SHAFT = Shaft(1e-3, 4e-3)
DOWN = np.array([0.0, 0.0, 1.0])
RIMS = [0.0, 0.5e-3, 2.0e-3, 2.5e-3]
UPPER_RIM, LOWER_RIM, LEADING, TRAILING = 0, 1, 4, 6
LIPSCHITZ_N_m = 40 * 4e3
"""Bound of |change of force| per metre of motion (tilt counted with a lever of 5 mm)."""


def forces_along(pose: FloatArray, direction: FloatArray, half: float, steps: int) -> FloatArray:
    """Forces at evenly spaced poses from -half to +half metres along a direction (5,)."""
    scale = np.array([1.0, 1.0, 1.0, 1 / 5e-3, 1 / 5e-3])
    t = np.linspace(-half, half, steps + 1)[:, np.newaxis]
    return solve(PART, SHAFT, pose + t * direction * scale, DOWN).force.sum(axis=-2)


def assert_no_jump(forces: FloatArray, step: float) -> None:
    change = np.linalg.norm(np.diff(forces, axis=0), axis=1)
    assert change.max() <= LIPSCHITZ_N_m * step


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
    forces = forces_along(pose, np.array([0, 0, 1.0, 0, 0]), 3.6e-3, 72_000)
    assert np.linalg.norm(forces, axis=1).max() > 0.02
    assert (forces[0] == 0.0).all()
    assert (forces[-1] == 0.0).all()
    assert_no_jump(forces, 1e-7)


@settings(deadline=None, max_examples=150)
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
    assert_no_jump(forces_along(pose, unit, 4e-8, 80), 1e-9)
    assert_no_jump(forces_along(pose, unit, 2e-5, 400), 1e-7)


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
