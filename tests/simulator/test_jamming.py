"""The jamming diagram of a peg in one hole, recovered from the simulator's contacts.

Whitney 1982; the frame's signs are worked out in `docs/figures_of/jamming.py`. Tolerances: the
closed form leaves out the tilt t, up to 3 clearance/depth, which turns the leading edge's force
against the shaft by t and so moves F_x/F_z by t/mu of itself.
"""

import numpy as np
import pytest

from docs.figures_of.jamming import CLEARANCE_M, combinations, draw, slope_and_reach

CASES = pytest.mark.parametrize(
    ("depth", "friction"), [(6e-4, 0.2), (1e-4, 0.2), (3e-4, 0.1), (4e-4, 0.5)]
)
"""lambda = 3, 0.5, 3 and 0.8; the second and fourth can wedge."""


@CASES
def test_sliding_in_is_driven_from_the_border_of_the_parallelogram(
    depth: float, friction: float
) -> None:
    found = combinations(depth, friction, 2000, seed=3)
    slope, reach = slope_and_reach(depth, friction)
    tolerance = 4.0 * CLEARANCE_M / depth / friction
    assert tolerance < 0.025
    skew = (found.moment + slope * found.lateral) / reach
    border = np.maximum(np.abs(found.lateral), np.abs(skew))
    one_side = found.sides == 1
    assert one_side.sum() > 200
    assert (~one_side).sum() > 200
    np.testing.assert_allclose(np.abs(found.lateral)[one_side], 1.0, rtol=0, atol=tolerance)
    np.testing.assert_allclose(
        np.abs(skew)[~one_side], 1.0, rtol=0, atol=tolerance * slope / min(reach, 1.0)
    )
    np.testing.assert_allclose(border, 1.0, rtol=0, atol=tolerance * slope / min(reach, 1.0))


@CASES
def test_one_point_is_a_corner_with_the_sign_of_this_frame(depth: float, friction: float) -> None:
    """Leading edge: moment/lateral = -1. Upper rim: -(2 lambda + 1). Force on the part, M about +y.

    At +x the shaft pushes the part with (N, mu N), the edge at (r, 0) and the rim at (r, -l) from
    the tip: the moments z F_x - x F_z are -r mu N and -(l + r mu) N.
    """
    found = combinations(depth, friction, 2000, seed=4)
    one = found.points == 1
    ratio = found.moment[one] / found.lateral[one]
    _, reach = slope_and_reach(depth, friction)
    tolerance = 4.0 * CLEARANCE_M / depth / friction
    edge = np.abs(ratio + 1.0) < tolerance
    rim = np.abs(ratio + 2.0 * reach + 1.0) < tolerance * (2.0 * reach + 1.0)
    assert (edge ^ rim).all()
    for kind in (edge, rim):
        for sign in (1.0, -1.0):
            assert (kind & (np.sign(found.lateral[one]) == sign)).sum() > 20


@CASES
def test_the_corners_and_all_four_sides_are_reached(depth: float, friction: float) -> None:
    found = combinations(depth, friction, 2000, seed=5)
    slope, reach = slope_and_reach(depth, friction)
    skew = (found.moment + slope * found.lateral) / reach
    lines = found.points > 1
    for value in (found.lateral, skew):
        for sign in (1.0, -1.0):
            assert (lines & (np.abs(sign * value - 1.0) < 0.05)).sum() > 20


def test_the_figure_draws_the_border_and_the_three_kinds_of_contact() -> None:
    drawn = draw()
    for name in ("closed form", "one point", "two points at one side", "two points at both sides"):
        assert name in drawn
