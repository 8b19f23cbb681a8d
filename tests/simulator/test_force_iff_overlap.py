"""The force is zero exactly when the solids do not overlap, judged by sections through the walls.

In a plane z = const a tilted cylinder shows an ellipse, cut off along straight lines where the
plane passes an end face. The solids overlap if such a section reaches out of the hole at any depth
in a wall. The sections here know nothing of rims, edges or deepest points.
"""

import numpy as np
import pytest

from simulator.checks import FloatArray
from simulator.contact import solve
from simulator.geometry import Hole, Part, Shaft, shaft_axis

SHAFT = Shaft(1e-3, 4e-3)
TWO_WALLS = Part((Hole(1.01e-3, 5e-4), Hole(1.01e-3, 5e-4, 1.5e-3)))
THIN_WALL = Part((Hole(1.01e-3, 3e-5),))
THINNER_THAN_THE_SLOPE = Part((Hole(1.01e-3, 2e-6),))
TIGHT_FIT = Part((Hole(1.001e-3, 3e-5),))
STILL = np.zeros(3)
SECTIONS = 60
AROUND = np.linspace(0.0, 2.0 * np.pi, 240, endpoint=False)


def poses_at_rim_planes(part: Part, tilt: float, n: int, seed: int) -> FloatArray:
    """Poses with the slanted face of one end about a rim's plane, and an overlap there or not."""
    rng = np.random.default_rng(seed)
    size, turn = tilt * np.sqrt(rng.random(n)), rng.uniform(0.0, 2.0 * np.pi, n)
    poses = np.zeros((n, 5))
    poses[:, 3], poses[:, 4] = size * np.cos(turn), size * np.sin(turn)
    clearance = part.wall_radii_m[0] - SHAFT.radius_m
    away, where = rng.uniform(0.0, 2.5 * clearance, n), rng.uniform(0.0, 2.0 * np.pi, n)
    poses[:, 0], poses[:, 1] = away * np.cos(where), away * np.sin(where)
    slope = SHAFT.radius_m * np.sin(size) + 2e-7
    poses[:, 2] = rng.choice(part.rim_depths_m, n) + rng.uniform(-1.2, 1.2, n) * slope
    trailing = rng.random(n) < 0.5
    poses[:, :3] += np.where(trailing, SHAFT.length_m, 0.0)[:, np.newaxis] * shaft_axis(poses)
    return poses


def overlap(part: Part, pose: FloatArray, grown: float) -> bool:
    """Whether a section of the shaft, its surface moved out by `grown`, reaches out of a hole."""
    u = shaft_axis(pose)
    level = np.array([-u[1], u[0], 0.0]) / np.hypot(u[0], u[1])
    upright = np.cross(level, u)
    radius, ends = SHAFT.radius_m + grown, (-grown, SHAFT.length_m + grown)
    for entry, leave, hole in zip(
        part.wall_entries_m, part.wall_exits_m, part.wall_radii_m, strict=True
    ):
        depths = [entry, leave]
        for end in ends:
            centre, reach = pose[2] - end * u[2], radius * abs(upright[2])
            low, high = max(entry, centre - reach), min(leave, centre + reach)
            if low < high:
                depths.extend(np.linspace(low, high, SECTIONS))
        z = np.array(depths)[:, np.newaxis]
        # The corners of a section: where an end face cuts the plane.
        cosines = [(z + end * u[2] - pose[2]) / (radius * upright[2]) for end in ends]
        corners = [np.arccos(np.clip(cosine, -1.0, 1.0)) for cosine in cosines]
        angle = np.concatenate(
            [np.broadcast_to(AROUND, (len(z), len(AROUND))), *corners, *(-c for c in corners)],
            axis=1,
        )
        across, along = radius * np.sin(angle), radius * np.cos(angle)
        behind = (pose[2] + along * upright[2] - z) / u[2]
        x = pose[0] + across * level[0] + along * upright[0] - behind * u[0]
        y = pose[1] + across * level[1] + along * upright[1] - behind * u[1]
        rounding = 1e-15
        inside = (behind >= ends[0] - rounding) & (behind <= ends[1] + rounding)
        if (inside & (np.hypot(x, y) > hole)).any():
            return True
    return False


def touch_at_the_deepest_points(
    part: Part, pose: FloatArray, point: FloatArray, depth: FloatArray
) -> bool:
    """Whether any circle's deepest point alone, without the rest of the circle, is in contact."""
    walls = len(part.holes)
    rims, edges = point[: 2 * walls], point[2 * walls :]
    behind = (pose[:3] - rims) @ shaft_axis(pose)
    z = edges[:, 2].reshape(2, walls)
    below, above = z - part.wall_entries_m, part.wall_exits_m - z
    entered = np.concatenate([np.minimum(behind, SHAFT.length_m - behind), below[0], above[1]])
    passed = np.concatenate([np.zeros(2 * walls), -above[0], -below[1]])
    return bool((np.minimum(depth, entered) - np.maximum(passed, 0.0) > 0.0).any())


@pytest.mark.parametrize(
    ("part", "tilt", "band"),
    [
        (TWO_WALLS, 5.2e-3, 3e-8),
        (TWO_WALLS, 0.052, 1e-7),
        (THIN_WALL, 5.2e-3, 3e-8),
        (THIN_WALL, 0.052, 1e-7),
        (THINNER_THAN_THE_SLOPE, 0.052, 1e-7),
        (TIGHT_FIT, 0.052, 3e-8),
    ],
    ids=["0.3 degrees", "3 degrees", "thin wall, 0.3", "thin wall, 3", "wall under slope", "tight"],
)
def test_force_is_zero_exactly_when_the_solids_do_not_overlap(
    part: Part, tilt: float, band: float
) -> None:
    """Poses whose overlap depends on moving the shaft's surface by `band` [m] are left out."""
    counts = {"apart": 0, "overlapping": 0, "left out": 0, "missed by the deepest points": 0}
    poses = poses_at_rim_planes(part, tilt, 300, seed=10)
    found = solve(part, SHAFT, poses, STILL)
    for pose, force, point, depth in zip(
        poses, found.force, found.point, found.overlap, strict=True
    ):
        if not overlap(part, pose, band):
            counts["apart"] += 1
            np.testing.assert_array_equal(force, 0.0, err_msg=str(pose))
        elif overlap(part, pose, -band):
            counts["overlapping"] += 1
            assert np.linalg.norm(force, axis=-1).max() > 0.0, str(pose)
            missed = not touch_at_the_deepest_points(part, pose, point, depth)
            counts["missed by the deepest points"] += missed
        else:
            counts["left out"] += 1
    assert counts["apart"] >= 30
    assert counts["overlapping"] >= 100
    assert counts["left out"] <= 15
    assert counts["missed by the deepest points"] >= 5
