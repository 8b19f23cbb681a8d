"""Deepest points against an optimiser that knows only distances, and against a closed form."""

from collections.abc import Callable

import numpy as np
import pytest
from scipy.optimize import minimize_scalar

from simulator.checks import FloatArray
from simulator.contact import solve
from simulator.geometry import Hole, Part, Shaft

PART = Part((Hole(1.01e-3, 5e-4), Hole(1.03e-3, 3e-4, 1.5e-3)))
SHAFT = Shaft(1e-3, 4e-3)


def axis_of(rx: float, ry: float) -> FloatArray:
    turn_x = np.array(
        [[1, 0, 0], [0, np.cos(rx), -np.sin(rx)], [0, np.sin(rx), np.cos(rx)]], dtype=float
    )
    turn_y = np.array(
        [[np.cos(ry), 0, np.sin(ry)], [0, 1, 0], [-np.sin(ry), 0, np.cos(ry)]], dtype=float
    )
    return turn_y @ turn_x @ np.array([0.0, 0.0, 1.0])


def smallest(function: Callable[[float], float]) -> float:
    """Global minimum over an angle: a dense grid, then a bounded search around its best point."""
    grid = np.linspace(0.0, 2.0 * np.pi, 721)
    values = [function(angle) for angle in grid]
    best, step = grid[int(np.argmin(values))], grid[1]
    found = minimize_scalar(
        function, bounds=(best - step, best + step), method="bounded", options={"xatol": 1e-11}
    )
    return min(found.fun, min(values))


def rim_overlap(pose: FloatArray, radius: float, depth: float) -> float:
    p, u = pose[:3], axis_of(*pose[3:])

    def distance(angle: float) -> float:
        w = np.array([radius * np.cos(angle), radius * np.sin(angle), depth]) - p
        wx, wy, wz = w
        ux, uy, uz = u
        return np.hypot(np.hypot(wy * uz - wz * uy, wz * ux - wx * uz), wx * uy - wy * ux)

    return 0.5e-3 - smallest(distance)


def edge_distance(pose: FloatArray, back: float) -> float:
    u = axis_of(*pose[3:])
    centre = pose[:3] - back * u
    first = np.cross(u, [0.3, 0.9, 0.1])
    first /= np.linalg.norm(first)
    second = np.cross(u, first)

    def minus_distance(angle: float) -> float:
        q = centre + 0.5e-3 * (np.cos(angle) * first + np.sin(angle) * second)
        return -np.hypot(q[0], q[1])

    return -smallest(minus_distance)


@pytest.mark.parametrize("tilt", [0.0, 5e-3, 0.1, 1.0])
def test_overlap_agrees_with_a_dense_optimiser(tilt: float) -> None:
    rng = np.random.default_rng(int(1000 * tilt))
    poses = rng.uniform(-1, 1, (6, 5)) * [3e-5, 3e-5, 2e-3, tilt, tilt] + [0, 0, 1e-3, 0, 0]
    poses[0, :2] *= 20.0
    overlap = solve(PART, SHAFT, poses, np.zeros(3)).overlap
    rims = [(0.505e-3, 0.0), (0.505e-3, 0.5e-3), (0.515e-3, 2.0e-3), (0.515e-3, 2.3e-3)]
    for pose, row in zip(poses, overlap, strict=True):
        expected = [rim_overlap(pose, *rim) for rim in rims]
        for back in (0.0, 4e-3):
            expected += [edge_distance(pose, back) - radius for radius in (0.505e-3, 0.515e-3)]
        np.testing.assert_allclose(row, expected, rtol=0.0, atol=1e-12)


def test_points_lie_on_their_circles() -> None:
    rng = np.random.default_rng(5)
    poses = rng.uniform(-1, 1, (200, 5)) * [1e-4, 1e-4, 3e-3, 0.7, 0.7]
    found = solve(PART, SHAFT, poses, np.zeros(3))
    rims, edges = found.point[:, :4], found.point[:, 4:]
    radii = np.linalg.norm(rims[..., :2], axis=-1)
    np.testing.assert_allclose(radii, np.tile([0.505e-3, 0.505e-3, 0.515e-3, 0.515e-3], (200, 1)))
    np.testing.assert_array_equal(rims[..., 2], np.tile(PART.rim_depths_m, (200, 1)))
    axes = np.array([axis_of(*tilt) for tilt in poses[:, 3:]])
    for edge, back in ((edges[:, :2], 0.0), (edges[:, 2:], 4e-3)):
        arm = edge - (poses[:, :3] - back * axes)[:, np.newaxis]
        np.testing.assert_allclose(np.linalg.norm(arm, axis=-1), 0.5e-3, rtol=1e-12)
        assert np.abs((arm * axes[:, np.newaxis]).sum(axis=-1)).max() < 1e-15


def test_normals_are_radial_to_the_smooth_surface() -> None:
    poses = np.array([[4e-6, -3e-6, 2.2e-3, 0.02, -0.01], [9e-6, 2e-6, 1e-3, 0.0, 0.0]])
    found = solve(PART, SHAFT, poses, np.zeros(3))
    np.testing.assert_allclose(np.linalg.norm(found.normal, axis=-1), 1.0, rtol=1e-14)
    for pose, normals, points in zip(poses, found.normal, found.point, strict=True):
        u = axis_of(*pose[3:])
        arm = points - pose[:3]
        radial = arm - np.outer(arm @ u, u)
        np.testing.assert_allclose(
            normals[:4], radial[:4] / np.linalg.norm(radial[:4], axis=1)[:, np.newaxis], atol=1e-12
        )
        flat = points[4:] * [1.0, 1.0, 0.0]
        np.testing.assert_allclose(
            normals[4:], flat / np.linalg.norm(flat, axis=1)[:, np.newaxis], atol=1e-12
        )


@pytest.mark.parametrize("tilt", [0.021, 0.03, 0.06])
def test_wedged_shaft_has_the_closed_form_of_a_plane_figure(tilt: float) -> None:
    """A shaft tilted about y through the centre of one hole wedges between opposite rim points."""
    part = Part((Hole(1.01e-3, 5e-4),))
    axis = np.array([np.sin(tilt), 0.0, np.cos(tilt)])
    pose = [*(np.array([0.0, 0.0, 2.5e-4]) + 1e-3 * axis), 0.0, tilt]
    found = solve(part, SHAFT, pose, np.zeros(3))
    reach = 2.5e-4 * np.tan(tilt)
    overlap = 0.5e-3 - (0.505e-3 - reach) * np.cos(tilt)
    assert overlap > 0.0
    np.testing.assert_allclose(found.penetration, [overlap, overlap, 0.0, 0.0], atol=1e-15)
    np.testing.assert_allclose(found.point[0], [-0.505e-3, 0.0, 0.0], atol=1e-15)
    np.testing.assert_allclose(found.point[1], [0.505e-3, 0.0, 5e-4], atol=1e-15)
    np.testing.assert_allclose(found.wrench[:3], 0.0, atol=1e-12)
    arm = 5e-4 * np.cos(tilt) + 1.01e-3 * np.sin(tilt)
    np.testing.assert_allclose(found.wrench[3:], [0.0, 4e3 * overlap * arm, 0.0], atol=1e-14)
