"""Rims of a part, and the shaft's axis as a function of its tilt."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from simulator.candidates import candidates
from simulator.geometry import Hole, Part, Shaft, shaft_axis, tilt_of
from simulator.profile import Chamfer, Rounding

tilts = st.floats(-1.5, 1.5)


def test_rims_of_two_unequal_holes() -> None:
    part = Part((Hole(1.01e-3, 5e-4), Hole(1.02e-3, 4e-4, 1.5e-3)))
    np.testing.assert_allclose(part.rim_depths_m, [0.0, 5e-4, 2e-3, 2.4e-3], rtol=1e-15)
    np.testing.assert_array_equal(part.rim_radii_m, [0.505e-3, 0.505e-3, 0.51e-3, 0.51e-3])
    np.testing.assert_array_equal(part.wall_entries_m, part.rim_depths_m[[0, 2]])
    np.testing.assert_array_equal(part.wall_exits_m, part.rim_depths_m[[1, 3]])
    np.testing.assert_array_equal(part.wall_radii_m, [0.505e-3, 0.51e-3])
    assert Shaft(1e-3, 4e-3).radius_m == 0.5e-3


def test_rims_and_faces_of_a_chamfered_hole() -> None:
    part = Part((Hole(1e-3, 1e-4), Hole(1e-3, 3e-4, 2e-4, Chamfer(3e-5, 4e-5))))
    np.testing.assert_allclose(part.rim_depths_m, [0.0, 1e-4, 3e-4, 3.4e-4, 6e-4], rtol=1e-15)
    np.testing.assert_allclose(part.rim_radii_m, [5e-4, 5e-4, 5.3e-4, 5e-4, 5e-4], rtol=1e-15)
    assert part.rim_holes.tolist() == [0, 0, 1, 1, 1]
    np.testing.assert_allclose(part.wall_mouths_m, [5e-4, 5.3e-4], rtol=1e-15)
    cone, bore = part.wall_faces[1].normals
    np.testing.assert_allclose(cone, [0.8, 0.6], rtol=1e-15)
    np.testing.assert_array_equal(bore, [1.0, 0.0])
    # A millimetre outside the mouth along the normal of the cone.
    depth = cone @ [5.3e-4 + 0.8e-3, 0.6e-3] - part.wall_faces[1].offsets_m[0]
    assert depth == pytest.approx(1e-3)
    assert part.rim_depths_m[2] == part.wall_entries_m[1]
    assert not part.is_plain


def test_edges_and_faces_of_worked_shafts() -> None:
    shaft = Shaft(1e-3, 4e-3, Chamfer(3e-5, 4e-5), Chamfer(5e-5, 1.2e-4))
    np.testing.assert_allclose(shaft.edge_stations_m, [0.0, 4e-5, 3.88e-3, 4e-3], rtol=1e-15)
    np.testing.assert_allclose(shaft.edge_radii_m, [4.7e-4, 5e-4, 5e-4, 4.5e-4], rtol=1e-15)
    assert shaft.leading_edges == 2
    expected = [[0.8, -0.6], [1.0, 0.0], [12 / 13, 5 / 13]]
    np.testing.assert_allclose(shaft.faces.normals, expected, rtol=1e-12, atol=1e-15)
    assert shaft != Shaft(1e-3, 4e-3)
    rounded = Shaft(1e-3, 4e-3, Rounding(1e-4))
    np.testing.assert_allclose(rounded.edge_stations_m, [1e-4, 4e-3], rtol=1e-15)
    np.testing.assert_allclose(rounded.edge_radii_m, [4e-4, 5e-4], rtol=1e-15)
    np.testing.assert_array_equal(rounded.edge_tubes_m, [1e-4, 0.0])
    assert rounded.leading_edges == 1
    assert [s.is_plain for s in (Shaft(1e-3, 4e-3), shaft, rounded)] == [True, False, False]


def test_a_profile_is_the_shaft_with_these_corners() -> None:
    corners = ((0.0, 4.7e-4), (4e-5, 5e-4), (4e-3, 5e-4))
    profile, chamfered = Shaft.of_profile(corners), Shaft(1e-3, 4e-3, Chamfer(3e-5, 4e-5))
    assert (profile.diameter_m, profile.length_m) == (1e-3, 4e-3)
    np.testing.assert_allclose(profile.faces.normals, chamfered.faces.normals, rtol=1e-12)
    np.testing.assert_allclose(profile.edge_radii_m, chamfered.edge_radii_m, rtol=1e-15)
    cone = Shaft.of_profile(((0.0, 4e-4), (4e-3, 5e-4)))
    assert not cone.is_plain
    assert cone.leading_edges == 2


def test_the_stations_of_all_candidates() -> None:
    part = Part((Hole(1e-3, 3e-4, entry=Chamfer(3e-5, 4e-5)),))
    table = candidates(part, Shaft(1e-3, 4e-3, Chamfer(3e-5, 4e-5), Chamfer(3e-5, 4e-5)))
    # mouth, throat, lower rim; nose, shoulder; the two trailing edges
    assert table.kind.tolist() == [0, 0, 0, 1, 1, 2, 2]
    assert table.station.tolist() == [0, 0, 1, 1, 1, 0, 0]
    assert table.circle.tolist() == [0, 1, 2, 0, 1, 2, 3]
    assert table.hole.tolist() == [0] * 7


def test_parts_compare_by_their_holes_and_are_locked() -> None:
    part = Part((Hole(1e-3, 1e-4),))
    assert part == Part((Hole(1e-3, 1e-4),))
    assert part != Part((Hole(1e-3, 2e-4),))
    assert len({part, Part((Hole(1e-3, 1e-4),))}) == 1
    with pytest.raises(ValueError, match="read-only"):
        part.rim_depths_m[0] = 1.0


def test_signs_and_order_of_the_tilt() -> None:
    """Turning +z about x by +rx leans it to -y; about y by +ry leans it to +x; x comes first."""
    poses = np.zeros((3, 5))
    poses[0, 3], poses[1, 4], poses[2, 3:] = 0.1, 0.1, (0.3, 0.4)
    axes = shaft_axis(poses)
    np.testing.assert_allclose(axes[0], [0.0, -np.sin(0.1), np.cos(0.1)])
    np.testing.assert_allclose(axes[1], [np.sin(0.1), 0.0, np.cos(0.1)])
    after_x = np.array([0.0, -np.sin(0.3), np.cos(0.3)])
    expected = [np.sin(0.4) * after_x[2], after_x[1], np.cos(0.4) * after_x[2]]
    np.testing.assert_allclose(axes[2], expected)


@given(tilts, tilts)
def test_tilt_of_inverts_the_axis(rx: float, ry: float) -> None:
    axis = shaft_axis([0.0, 0.0, 0.0, rx, ry])
    assert np.linalg.norm(axis) == pytest.approx(1.0, abs=1e-15)
    np.testing.assert_allclose(tilt_of(3.0 * axis), [rx, ry], rtol=1e-12, atol=1e-14)
