"""Chamfers, roundings and other profiles: best points and penetrations, and closed forms by hand.

The reference knows meridians only: distances from an axis and along it, and a dense optimiser.
"""

from collections.abc import Callable, Iterator
from itertools import pairwise

import numpy as np
import pytest

from simulator.candidates import Kind, candidates
from simulator.checks import FloatArray
from simulator.circle import Circles
from simulator.contact import ContactLaw, Contacts, solve
from simulator.extremum import discretised_search
from simulator.geometry import Hole, Part, Shaft, shaft_axis
from simulator.profile import Chamfer, Rounding
from tests.simulator.dense import greatest
from tests.simulator.shapes import PARTS, SHAFTS, pressing_poses

STILL, DOWN = np.zeros(3), np.array([0.0, 0.0, 1.0])
SMOOTH = ContactLaw(friction=0.0)
GRID_POINTS = 4001
Around = Callable[[FloatArray], tuple[FloatArray, FloatArray]]


def shaft_depth(shaft: Shaft, rho: FloatArray, s: FloatArray) -> FloatArray:
    """Depth below the lateral surface of the shaft, from its corners."""
    corners = np.stack([shaft.edge_stations_m, shaft.edge_radii_m], axis=-1)
    t = shaft.rounding_m
    if t > 0.0:
        corners[0] = 0.0, shaft.radius_m
    depths = []
    for (s0, r0), (s1, r1) in pairwise(corners):
        depths.append(((r0 - rho) * (s1 - s0) + (r1 - r0) * (s - s0)) / np.hypot(s1 - s0, r1 - r0))
    if t > 0.0:
        out, ahead = rho - (shaft.radius_m - t), t - s
        arc = np.where(out > 0.0, np.hypot(np.maximum(out, 0.0), np.maximum(ahead, 0.0)), ahead)
        depths.append(t - np.where((out < 0.0) & (ahead < 0.0), np.maximum(out, ahead), arc))
    return np.minimum.reduce(depths)


def wall_depth(hole: Hole, rho: FloatArray, z: FloatArray) -> FloatArray:
    """Depth in the material of a wall, z from its mouth's plane."""
    bore = rho - 0.5 * hole.diameter_m
    if hole.entry is None:
        return bore
    w, h = hole.entry.width_m, hole.entry.height_m
    return np.minimum(bore, (bore * h + (z - h) * w) / np.hypot(h, w))


def circles(part: Part, shaft: Shaft, pose: FloatArray) -> Iterator[Around]:
    """Of each candidate, depth and effective penetration over the angle around its circle."""
    tip, u, length = pose[:3], shaft_axis(pose), shaft.length_m
    first = np.cross(u, [0.3, 0.9, 0.1])
    first /= np.linalg.norm(first)
    second = np.cross(u, first)
    table = candidates(part, shaft)

    def rim(angle: FloatArray, number: int) -> tuple[FloatArray, FloatArray]:
        radius, depth = part.rim_radii_m[number], part.rim_depths_m[number]
        ring = np.stack([np.cos(angle), np.sin(angle), np.zeros_like(angle)], axis=-1)
        arm = radius * ring + [0.0, 0.0, depth] - tip
        s = -(arm @ u)
        f = shaft_depth(shaft, np.linalg.norm(arm + s[..., np.newaxis] * u, axis=-1), s)
        return f, np.minimum.reduce([f, s, length - s])

    def edge(angle: FloatArray, number: int, wall: int, leading: bool) -> tuple[FloatArray, ...]:
        ring = np.multiply.outer(np.cos(angle), first) + np.multiply.outer(np.sin(angle), second)
        at = tip - shaft.edge_stations_m[number] * u + shaft.edge_radii_m[number] * ring
        hole, z = part.holes[wall], at[..., 2] - part.wall_entries_m[wall]
        f = wall_depth(hole, np.hypot(at[..., 0], at[..., 1]), z) + shaft.edge_tubes_m[number]
        g = z if leading else hole.thickness_m - z
        return f, np.minimum(f, g) - np.maximum(g - hole.thickness_m, 0.0)

    for kind, wall, number in zip(table.kind, table.hole, table.circle, strict=True):
        if kind == Kind.RIM:
            yield lambda angle, n=number: rim(angle, n)
        else:
            yield lambda angle, n=number, w=wall, k=kind: edge(angle, n, w, k == Kind.LEADING_EDGE)


@pytest.mark.slow
@pytest.mark.parametrize(("part", "tilt"), [("two chamfered", 5e-3), ("three", 0.05)])
@pytest.mark.parametrize("shaft", SHAFTS)
def test_depth_and_penetration_are_the_greatest_on_the_circle(
    shaft: str, part: str, tilt: float
) -> None:
    solid, wall = SHAFTS[shaft], PARTS[part]
    poses = pressing_poses(wall, 4, seed=3, tilt=tilt)
    found, touching = solve(wall, solid, poses, STILL), 0
    for pose, penetration, overlap in zip(poses, found.penetration, found.overlap, strict=True):
        for c, around in enumerate(circles(wall, solid, pose)):
            expected = greatest(lambda angle, around=around: around(angle)[1], GRID_POINTS)
            assert penetration[c] == pytest.approx(max(0.0, expected), abs=1e-12), (pose, c)
            if expected > 0.0:
                touching += 1
                deepest = greatest(lambda angle, around=around: around(angle)[0], GRID_POINTS)
                assert overlap[c] == pytest.approx(deepest, abs=1e-12), (pose, c)
    assert touching >= 2


@pytest.mark.parametrize("shaft", ["chamfered", "rounded", "barrel"])
def test_the_discretised_search_converges_from_below(shaft: str) -> None:
    part, solid = PARTS["two chamfered"], SHAFTS[shaft]
    poses = pressing_poses(part, 200, seed=4, tilt=5e-3)
    exact = solve(part, solid, poses, STILL).penetration
    errors = []
    for n in (100, 200, 400):
        searched = solve(part, solid, poses, STILL, search=discretised_search(n)).penetration
        assert (searched <= exact + 1e-16).all()
        errors.append((exact - searched).max())
    assert errors[2] < 0.6 * errors[0] < 1e-7


def untilted(part: Part, shaft: Shaft, x: float, depth: float, law: ContactLaw) -> Contacts:
    return solve(part, shaft, [x, 0.0, depth, 0.0, 0.0], DOWN, law)


def test_a_chamfered_nose_on_a_sharp_rim_has_the_force_of_the_inclined_face() -> None:
    """The rim lies 20 um behind the nose, where the cone is 12 um wider than the nose."""
    part, shaft = PARTS["one hole"], Shaft(1e-3, 4e-3, Chamfer(3e-5, 5e-5))
    face = np.hypot(3e-5, 5e-5)
    into = (0.470e-3 + 1.2e-5 + 2.5e-5 - 0.505e-3) * 5e-5 / face
    found = untilted(part, shaft, 2.5e-5, 2e-5, SMOOTH)
    expected = 4e3 * into * np.array([5e-5, 0.0, 3e-5]) / face
    np.testing.assert_allclose(found.wrench[:3], expected, rtol=1e-9, atol=1e-15)
    assert found.wrench[2] / found.wrench[0] == pytest.approx(0.6)
    np.testing.assert_allclose(found.point[0], [0.505e-3, 0.0, 0.0], atol=1e-15)


def test_a_sharp_nose_in_a_chamfer_has_the_force_of_the_inclined_face() -> None:
    part = Part((Hole(1.01e-3, 5e-4, entry=Chamfer(4e-5, 6e-5)),))
    shaft, face = Shaft(1e-3, 4e-3), np.hypot(4e-5, 6e-5)
    # At 30 um below the mouth the cone's radius is 525 um; the edge reaches 500 + 27 um.
    found = untilted(part, shaft, 2.7e-5, 3e-5, SMOOTH)
    expected = 4e3 * 2e-6 * 6e-5 / face * np.array([6e-5, 0.0, 4e-5]) / face
    np.testing.assert_allclose(found.wrench[:3], expected, rtol=1e-9, atol=1e-15)
    np.testing.assert_allclose(found.point[3], [0.527e-3, 0.0, 3e-5], atol=1e-15)


def test_a_rounded_nose_on_a_sharp_rim_pushes_along_the_line_to_its_centre() -> None:
    part, shaft = PARTS["one hole"], Shaft(1e-3, 4e-3, Rounding(8e-5))
    found = untilted(part, shaft, 4e-5, 2e-5, SMOOTH)
    arm = np.array([0.505e-3 - (0.42e-3 + 4e-5), 0.0, 8e-5 - 2e-5])
    into = 8e-5 - np.hypot(arm[0], arm[2])
    assert into > 0.0
    expected = 4e3 * into * arm / np.hypot(arm[0], arm[2])
    np.testing.assert_allclose(found.wrench[:3], expected, rtol=1e-9, atol=1e-15)


def test_a_rounded_nose_in_a_bore_touches_with_the_side_of_its_tube() -> None:
    part, shaft = PARTS["one hole"], Shaft(1e-3, 4e-3, Rounding(8e-5))
    found = untilted(part, shaft, 8e-6, 2e-4, SMOOTH)
    np.testing.assert_allclose(found.penetration, [3e-6, 0.0, 3e-6, 0.0], atol=1e-18)
    np.testing.assert_allclose(found.point[2], [0.508e-3, 0.0, 1.2e-4], atol=1e-15)
    np.testing.assert_allclose(found.wrench[:3], [0.024, 0.0, 0.0], atol=1e-15)


def test_a_rounded_nose_on_a_cone_touches_where_their_normals_meet() -> None:
    """The centre of the arc is 30 um below the mouth, where the cone's radius is 525 um."""
    part = Part((Hole(1.01e-3, 5e-4, entry=Chamfer(4e-5, 6e-5)),))
    found = untilted(part, Shaft(1e-3, 4e-3, Rounding(8e-5)), 1.1e-5, 1.1e-4, SMOOTH)
    normal = np.array([6.0, 0.0, 4.0]) / np.hypot(6.0, 4.0)
    into = (0.431e-3 - 0.525e-3) * normal[0] + 8e-5
    assert found.penetration[3] == pytest.approx(into, rel=1e-9)
    np.testing.assert_allclose(found.normal[3], normal, atol=1e-12)
    np.testing.assert_allclose(found.point[3], [0.431e-3, 0, 3e-5] + 8e-5 * normal, atol=1e-15)


def test_an_overlap_greater_than_the_rounding_is_that_of_the_sharp_end() -> None:
    part, shaft = PARTS["one hole"], Shaft(1e-3, 4e-3, Rounding(2e-6))
    found = untilted(part, shaft, 9e-6, 1e-4, SMOOTH)
    np.testing.assert_allclose(found.penetration, [4e-6, 0.0, 4e-6, 0.0], atol=1e-18)
    np.testing.assert_allclose(found.wrench[:3], [0.032, 0.0, 0.0], atol=1e-15)


@pytest.mark.slow
def test_a_half_circle_is_cut_at_the_valleys_of_all_faces() -> None:
    """On no arc the depth below a cylinder and a cone falls first and rises then."""
    rng, n = np.random.default_rng(2), 400
    sin = rng.uniform(0.02, 0.3, n)
    offset = rng.uniform(-0.6, 0.6, (2, n)) * sin**2
    normals = np.stack([np.full((2, n), 1.0), np.zeros((2, n))])
    normals[:, 1] = np.array([[0.8], [-0.6]]) * rng.choice([-1.0, 1.0], n) ** [[0], [1]]
    cone = normals[:, 1]
    along = np.where(rng.random(n) < 0.5, offset[0], 0.75 * sin * np.sign(cone[1]) + offset[0])
    circles = Circles(
        is_rim=np.ones(n, dtype=np.bool_),
        is_trailing=np.zeros(n, dtype=np.bool_),
        radius=np.ones(n),
        shortened=np.sqrt(1.0 - sin * sin),
        along=along,
        across=offset[1],
        axial=np.zeros(n),
        slope=-sin,
        length=np.full(n, 1e3),
        tube=np.zeros(n),
        normals=normals,
        offsets=np.stack([np.ones(n), cone[0] + rng.uniform(-0.1, 0.1, n) * sin]),
        rounding=(0.0, 1.0),
        frame=np.zeros((3, n)),
        tilt=np.stack([np.sqrt(1.0 - sin * sin), sin]),
    )
    ends = circles.arc_ends()
    assert ((ends > 0.0) & (ends < np.pi)).any(axis=0).sum() > 200
    shares = np.linspace(1e-6, 1.0 - 1e-6, 2001)[:, np.newaxis, np.newaxis]
    angle = ends[:-1] + shares * np.diff(ends, axis=0)
    slope = circles.overlap(np.cos(angle), circles.side() * np.sin(angle))[1] * circles.side()
    rises_again = (np.maximum.accumulate(slope < -1e-12, axis=0) & (slope > 1e-12)).any(axis=0)
    assert not rises_again.any()


@pytest.mark.parametrize("part", PARTS)
@pytest.mark.parametrize("shaft", SHAFTS)
def test_a_batch_equals_its_poses_one_by_one_bit_for_bit(shaft: str, part: str) -> None:
    poses = pressing_poses(PARTS[part], 12, seed=6, tilt=0.02)
    batch = solve(PARTS[part], SHAFTS[shaft], poses, DOWN)
    for index, pose in enumerate(poses):
        single = solve(PARTS[part], SHAFTS[shaft], pose, DOWN)
        for name in ("overlap", "penetration", "point", "normal", "force", "wrench", "energy"):
            np.testing.assert_array_equal(getattr(single, name), getattr(batch, name)[index])
        for name in ("penetration", "point", "normal", "force"):
            found, expected = getattr(single.ring, name), getattr(batch.ring, name)[index]
            np.testing.assert_array_equal(found, expected)


def test_a_fine_polygon_is_the_rounded_end() -> None:
    t, n = 8e-5, 100
    angle = (np.arange(n) + 0.5) * (0.5 * np.pi / n)
    tangents = [
        (0.0, 0.5e-3 - t),
        *zip(t - t * np.cos(angle), 0.5e-3 - t + t * np.sin(angle), strict=True),
    ]
    profile = Shaft.of_profile((*tangents, (t, 0.5e-3), (4e-3, 0.5e-3)))
    part = PARTS["one hole"]
    poses = pressing_poses(part, 40, seed=7, tilt=5e-3)
    poses[:, 2] = np.random.default_rng(1).uniform(0.0, 7e-5, 40)
    rounded = solve(part, SHAFTS["rounded"], poses, STILL)
    upper_rim = solve(part, profile, poses, STILL).penetration[:, 0]
    assert (upper_rim > 1e-6).sum() > 10
    np.testing.assert_allclose(rounded.penetration[:, 0], upper_rim, rtol=0, atol=5e-9)


PATHS = [(0.0, 0.0), (5e-3, 0.0), (-3e-3, 4e-3)]


def insertion(part: Part, shaft: Shaft, tilt: tuple[float, float]) -> tuple[Contacts, float]:
    depths, step = np.linspace(-6e-5, part.wall_exits_m[-1] + 4.3e-3, 6_000, retstep=True)
    poses = np.zeros((len(depths), 5))
    poses[:, :2], poses[:, 2], poses[:, 3:] = (9e-6, -5e-6), depths, tilt
    return solve(part, shaft, poses, DOWN), float(step)


@pytest.mark.slow
@pytest.mark.parametrize("tilt", PATHS)
def test_no_jump_along_the_insertion_of_a_rounded_end(tilt: tuple[float, float]) -> None:
    found, step = insertion(PARTS["one hole"], SHAFTS["rounded"], tilt)
    assert np.linalg.norm(found.wrench[:, :3], axis=1).max() > 0.02
    assert not found.wrench[[0, -1]].any()
    assert np.abs(np.diff(found.wrench[:, :3], axis=0)).max() < 20 * 4e3 * step


@pytest.mark.slow
@pytest.mark.parametrize("tilt", PATHS)
@pytest.mark.parametrize("shaft", SHAFTS)
def test_no_penetration_jumps_along_an_insertion(shaft: str, tilt: tuple[float, float]) -> None:
    """A trailing edge that leaves through a cone loses depth and length at once: up to 1.71.

    The other points of a ring go around with the first one while an edge passes: up to 6.
    """
    found, step = insertion(PARTS["two chamfered"], SHAFTS[shaft], tilt)
    assert found.penetration.max() > 2e-6
    assert not found.wrench[[0, -1]].any()
    assert np.abs(np.diff(found.penetration, axis=0)).max() < 1.71 * step
    assert np.abs(np.diff(found.ring.penetration, axis=0)).max() < 6.0 * step


def test_the_force_turns_from_face_to_face_as_a_slanted_edge_goes_by() -> None:
    """The shoulder passes the rim, tilted across the offset: both faces carry, in turn less."""
    depths = np.linspace(3.8e-5, 6.2e-5, 24_001)
    poses = np.zeros((len(depths), 5))
    poses[:, 0], poses[:, 2], poses[:, 3] = 1.5e-5, depths, 5e-3
    found = solve(PARTS["one hole"], SHAFTS["chamfered"], poses, STILL)
    force, size = found.force[:, 0], 4e3 * found.penetration[:, 0]
    length = np.linalg.norm(force, axis=1) / size
    assert length[[0, -1]] == pytest.approx([1.0, 1.0], abs=1e-12)
    assert (length > np.cos(0.5 * np.arctan(0.6))).all()
    assert ((length < 0.999) & (length > 0.95)).sum() > 200
    assert np.abs(np.diff(force, axis=0)).max() < 40 * 4e3 * 1e-9
    assert found.normal[0, 0, 2] == pytest.approx(3 / np.hypot(3, 5), rel=1e-2)
    assert found.normal[-1, 0, 2] == pytest.approx(0.0, abs=6e-3)


@pytest.mark.parametrize("shaft", ["plain", "rounded"])
def test_no_jump_in_any_direction_about_a_mouth(shaft: str) -> None:
    part, solid, rng = PARTS["one hole"], SHAFTS[shaft], np.random.default_rng(11)
    starts = pressing_poses(part, 60, seed=12, tilt=6e-3, away=2e-5)
    ways = rng.normal(size=(60, 5))
    ways /= np.linalg.norm(ways, axis=1)[:, np.newaxis]
    ways[:, 3:] /= 5e-3
    for half, steps in ((4e-8, 80), (2e-5, 400)):
        t = np.linspace(-half, half, steps + 1)[:, np.newaxis, np.newaxis]
        wrenches = solve(part, solid, starts + t * ways, DOWN).wrench
        change = np.linalg.norm(np.diff(wrenches[..., :3], axis=0), axis=-1)
        assert change.max() < 60 * 4e3 * 2.0 * half / steps
