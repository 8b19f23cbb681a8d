"""Rims of a part, and the shaft's axis as a function of its tilt."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from simulator.geometry import Hole, Part, Shaft, shaft_axis, tilt_of

tilts = st.floats(-1.5, 1.5)


def test_rims_of_two_unequal_holes() -> None:
    part = Part((Hole(1.01e-3, 5e-4), Hole(1.02e-3, 4e-4, 1.5e-3)))
    np.testing.assert_allclose(part.rim_depths_m, [0.0, 5e-4, 2e-3, 2.4e-3], rtol=1e-15)
    np.testing.assert_array_equal(part.rim_radii_m, [0.505e-3, 0.505e-3, 0.51e-3, 0.51e-3])
    np.testing.assert_array_equal(part.wall_entries_m, part.rim_depths_m[[0, 2]])
    np.testing.assert_array_equal(part.wall_exits_m, part.rim_depths_m[[1, 3]])
    np.testing.assert_array_equal(part.wall_radii_m, [0.505e-3, 0.51e-3])
    assert Shaft(1e-3, 4e-3).radius_m == 0.5e-3


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
