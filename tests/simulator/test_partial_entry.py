"""Penetration of circles that have partly entered: its greatest value, symmetries, discretisation.

Wherever a slanted end face cuts a rim's plane, the best point of a circle is not the deepest one.
"""

from collections.abc import Iterator

import numpy as np
import pytest

from simulator.checks import FloatArray
from simulator.circle import Circles
from simulator.contact import solve
from simulator.extremum import discretised_search
from simulator.geometry import Hole, Part, Shaft, shaft_axis, tilt_of
from tests.simulator.dense import Height, greatest

PART = Part((Hole(1.01e-3, 5e-4), Hole(1.01e-3, 5e-4, 1.5e-3)))
SHAFT = Shaft(1e-3, 4e-3)
STILL = np.zeros(3)
DOWN = np.array([0.0, 0.0, 1.0])
GRID = np.linspace(0.0, 2.0 * np.pi, 20_001)


def poses_cut_by(part: Part, shaft: Shaft, tilt: float, away: float, n: int) -> FloatArray:
    """Poses with an end's slanted face in a rim's plane, its centre up to `away` [m] off the axis.

    The tilt is up to `tilt` [rad].
    """
    rng = np.random.default_rng(int(1e6 * tilt))
    poses = np.zeros((n, 5))
    poses[:, :2] = rng.uniform(-away, away, (n, 2))
    poses[:, 3:] = rng.uniform(-tilt, tilt, (n, 2))
    slope = shaft.radius_m * np.hypot(poses[:, 3], poses[:, 4]) + 1e-7
    poses[:, 2] = rng.choice(part.rim_depths_m, n) + rng.uniform(-1.0, 1.0, n) * slope
    trailing = rng.random(n) < 0.5
    poses[:, :3] += np.where(trailing, shaft.length_m, 0.0)[:, np.newaxis] * shaft_axis(poses)
    return poses


def heights(part: Part, shaft: Shaft, pose: FloatArray) -> Iterator[Height]:
    """Effective penetration over the angle of each circle, from distances in space alone."""
    tip, u, radius, length = pose[:3], shaft_axis(pose), shaft.radius_m, shaft.length_m
    first = np.cross(u, [0.3, 0.9, 0.1])
    first /= np.linalg.norm(first)
    second = np.cross(u, first)

    def rim(angle: FloatArray, hole: float, depth: float) -> FloatArray:
        ring = np.stack([np.cos(angle), np.sin(angle), np.zeros_like(angle)], axis=-1)
        arm = hole * ring + [0.0, 0.0, depth] - tip
        behind = -(arm @ u)
        overlap = radius - np.linalg.norm(arm + behind[..., np.newaxis] * u, axis=-1)
        return np.minimum.reduce([overlap, behind, length - behind])

    def edge(angle: FloatArray, hole: float, entry: float, leave: float, back: float) -> FloatArray:
        ring = np.multiply.outer(np.cos(angle), first) + np.multiply.outer(np.sin(angle), second)
        x, y, z = np.moveaxis(tip - back * u + radius * ring, -1, 0)
        entered, passed = (z - entry, z - leave) if back == 0.0 else (leave - z, entry - z)
        return np.minimum(np.hypot(x, y) - hole, entered) - np.maximum(passed, 0.0)

    for hole, depth in zip(part.rim_radii_m, part.rim_depths_m, strict=True):
        yield lambda angle, hole=hole, depth=depth: rim(angle, hole, depth)
    walls = list(zip(part.wall_radii_m, part.wall_entries_m, part.wall_exits_m, strict=True))
    for back in (0.0, length):
        for wall in walls:
            yield lambda angle, wall=wall, back=back: edge(angle, *wall, back)


@pytest.mark.parametrize(
    ("part", "shaft", "tilt", "away"),
    [
        (PART, SHAFT, 5e-3, 1.2e-5),
        (PART, SHAFT, 0.05, 3e-5),
        (Part((Hole(1.01e-3, 5e-6), Hole(1.01e-3, 2e-5, 1.5e-3))), SHAFT, 0.05, 6e-5),
        (Part((Hole(1e-3, 5e-4),)), Shaft(1.004e-3, 4e-3), 0.05, 1e-5),
        (Part((Hole(1.01e-3, 5e-5),)), Shaft(1e-3, 1e-4), 0.3, 4e-5),
    ],
    ids=["0.3 degrees", "3 degrees", "walls thinner than the slope", "interference", "coin"],
)
def test_penetration_is_the_greatest_on_the_circle(
    part: Part, shaft: Shaft, tilt: float, away: float
) -> None:
    poses = poses_cut_by(part, shaft, tilt, away, 25)
    found, cut = solve(part, shaft, poses, STILL), 0
    for pose, penetration, overlap in zip(poses, found.penetration, found.overlap, strict=True):
        expected = [max(0.0, greatest(height, len(GRID))) for height in heights(part, shaft, pose)]
        np.testing.assert_allclose(penetration, expected, rtol=0.0, atol=1e-12, err_msg=str(pose))
        cut += int(((penetration > 0.0) & (penetration < overlap - 1e-9)).sum())
    assert cut >= 10


@pytest.mark.slow
def test_penetration_is_the_greatest_where_a_rim_overlaps_on_both_sides() -> None:
    """A shaft wedged in a tight hole overlaps a rim on two sides; one or both may have entered."""
    part, rng, n = Part((Hole(1.001e-3, 5e-4),)), np.random.default_rng(3), 5000
    poses = np.zeros((n, 5))
    turn = rng.uniform(0.0, 2.0 * np.pi, n)
    poses[:, 3:] = (rng.uniform(0.03, 0.3, n) * [np.cos(turn), np.sin(turn)]).T
    u = shaft_axis(poses)
    square = 1.0 - u[:, 2] ** 2
    poses[:, :2] = rng.uniform(-0.4, 0.4, (n, 2)) * (part.rim_radii_m[0] * square)[:, np.newaxis]
    behind = rng.uniform(-1.0, 1.0, n) * part.rim_radii_m[0] * np.sqrt(square) / u[:, 2]
    poses[:, :3] += behind[:, np.newaxis] * u
    exact = solve(part, SHAFT, poses, STILL).penetration
    points = solve(part, SHAFT, poses, STILL, search=discretised_search(720)).penetration
    assert (points <= exact + 1e-16).all()
    two_sided = 0
    for pose, value in zip(poses[:100], exact[:100, 0], strict=True):
        height = next(heights(part, SHAFT, pose))
        assert value == pytest.approx(max(0.0, greatest(height, len(GRID))), abs=1e-12), str(pose)
        values = height(GRID[:-1])
        peaks = (values > np.roll(values, 1)) & (values > np.roll(values, -1)) & (values > 0.0)
        two_sided += int(peaks.sum() > 1)
    assert two_sided >= 10


def test_a_half_circle_is_divided_where_the_overlap_of_a_rim_is_least_between_two_peaks() -> None:
    rng, n, far = np.random.default_rng(2), 500, np.full(500, 1e3)
    sin = rng.uniform(0.02, 0.3, n)
    along, across = rng.uniform(-0.3, 0.3, (2, n)) * sin**2
    circles = Circles(
        is_rim=np.ones(n, dtype=np.bool_),
        is_trailing=np.zeros(n, dtype=np.bool_),
        radius=np.ones(n),
        shortened=np.sqrt(1.0 - sin * sin),
        along=along,
        across=across,
        axial=far,
        slope=-sin,
        length=2.0 * far,
        tube=np.zeros(n),
        normals=np.stack([np.ones((1, n)), np.zeros((1, n))]),
        offsets=np.ones((1, n)),
        rounding=(0.0, 1.0),
        frame=np.zeros((3, n)),
        tilt=np.stack([np.sqrt(1.0 - sin * sin), sin]),
    )
    low, crest, high = circles.arc_ends()
    np.testing.assert_array_equal(low, 0.0)
    np.testing.assert_array_equal(high, np.pi)
    divided = crest < np.pi
    assert divided.sum() > 300

    def overlap(angle: FloatArray) -> FloatArray:
        return circles.penetration(np.cos(angle), circles.side() * np.sin(angle))[0]

    least = overlap(crest)[divided]
    for step in (-1e-4, 1e-4):
        assert (overlap(crest + step)[divided] > least).all()


def test_an_upright_end_enters_a_rim_plane_all_at_once() -> None:
    """Without a tilt the entered distance is the same all around: the least of the two counts."""
    for entered in (0.0, 1e-6, 2e-6, 3e-6, 4e-6):
        penetration = solve(PART, SHAFT, [8e-6, 0.0, entered, 0.0, 0.0], STILL).penetration
        np.testing.assert_allclose(penetration[[0, 4]], min(entered, 3e-6), atol=1e-18)


def test_penetration_of_a_wall_never_exceeds_its_thickness() -> None:
    part = Part((Hole(1.01e-3, 2e-6),))
    poses = poses_cut_by(part, SHAFT, 0.05, 6e-5, 2000)
    edges = solve(part, SHAFT, poses, STILL).penetration[:, 2:]
    assert edges.max() == pytest.approx(2e-6, abs=1e-17)
    assert ((edges > 1.999e-6).sum(axis=0) > 50).all()


@pytest.mark.parametrize("tilt", [5e-3, 0.05])
def test_turning_and_mirroring_a_cut_pose_turns_and_mirrors_the_wrench(tilt: float) -> None:
    poses, angle = poses_cut_by(PART, SHAFT, tilt, 1.5e-5, 400), 0.7
    sliding = np.array([0.3, -0.2, 1.0])
    before = solve(PART, SHAFT, poses, sliding)
    assert ((before.penetration > 0.0) & (before.penetration < before.overlap)).sum() > 200
    turn = np.array(
        [[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1]]
    )
    turned = np.concatenate([poses[:, :3] @ turn.T, tilt_of(shaft_axis(poses) @ turn.T)], axis=1)
    after = solve(PART, SHAFT, turned, turn @ sliding)
    np.testing.assert_allclose(after.penetration, before.penetration, rtol=0, atol=1e-16)
    np.testing.assert_allclose(after.wrench[:, :3], before.wrench[:, :3] @ turn.T, atol=1e-11)
    np.testing.assert_allclose(after.wrench[:, 3:], before.wrench[:, 3:] @ turn.T, atol=1e-13)
    mirrored = solve(PART, SHAFT, poses * [-1, 1, 1, 1, -1], sliding * [-1, 1, 1])
    np.testing.assert_allclose(mirrored.penetration, before.penetration, rtol=0, atol=1e-18)
    expected = before.wrench * [-1, 1, 1, 1, -1, -1]
    np.testing.assert_allclose(mirrored.wrench, expected, rtol=0, atol=1e-13)


def test_a_batch_of_cut_poses_equals_its_poses_one_by_one_bit_for_bit() -> None:
    poses = poses_cut_by(PART, SHAFT, 5e-3, 1.2e-5, 60)
    batch = solve(PART, SHAFT, poses, DOWN)
    for index, pose in enumerate(poses):
        single = solve(PART, SHAFT, pose, DOWN)
        for name in ("overlap", "penetration", "point", "normal", "force", "wrench"):
            np.testing.assert_array_equal(getattr(single, name), getattr(batch, name)[index])


def test_the_discretised_search_converges_to_the_greatest_penetration_at_first_order() -> None:
    """The best point is mostly a kink, where the overlap falls and the entered distance rises."""
    poses = poses_cut_by(PART, SHAFT, 5e-3, 1.2e-5, 600)
    exact = solve(PART, SHAFT, poses, STILL)
    cut = (exact.penetration > 0.0) & (exact.penetration < exact.overlap)
    assert cut.sum() > 300
    points, errors = np.array([48, 96, 192, 384, 768]), []
    for n in points:
        searched = solve(PART, SHAFT, poses, STILL, search=discretised_search(int(n))).penetration
        # The best of some points of the circle is not above the best of all.
        assert (searched <= exact.penetration + 1e-16).all()
        errors.append((exact.penetration - searched)[cut].mean())
    slope = np.polyfit(np.log(points), np.log(errors), 1)[0]
    assert slope == pytest.approx(-1.0, abs=0.15)
    assert errors[-1] < 1e-8
