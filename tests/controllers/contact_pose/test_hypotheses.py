"""The prior: what it draws, what it holds, and what it refuses."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.stats import kstest

from controllers.contact_pose.hypotheses import Parameter, Prior
from tests.controllers.contact_pose.cases import PRIOR

TILT = math.radians(0.3)
MIDDLE = np.array([0.0, 0.0, 0.0, 0.0, 7e3, 8e-6, 0.2])
DRAWN = PRIOR.drawn(20_000, np.random.default_rng(3))


@pytest.mark.parametrize(("columns", "radius"), [([0, 1], 10e-6), ([2, 3], TILT)])
def test_offset_and_tilt_are_uniform_in_their_discs(columns: list[int], radius: float) -> None:
    """Squared radius and direction of a point that is uniform in a disc are uniform, each."""
    x, y = DRAWN[:, columns].T / radius
    square = x * x + y * y
    assert square.max() <= 1.0 + 1e-12
    assert kstest(square, "uniform").pvalue > 0.01
    assert kstest((np.arctan2(y, x) / math.pi + 1.0) / 2.0, "uniform").pvalue > 0.01


@pytest.mark.parametrize(
    ("column", "low", "high"), [(4, 2e3, 12e3), (5, 2e-6, 14e-6), (6, 0.1, 0.3)]
)
def test_the_others_are_uniform_in_their_ranges(column: int, low: float, high: float) -> None:
    shares = (DRAWN[:, column] - low) / (high - low)
    assert shares.min() >= 0.0
    assert shares.max() <= 1.0
    assert kstest(shares, "uniform").pvalue > 0.01


def test_parameters_are_drawn_independently() -> None:
    correlation = np.corrcoef(DRAWN, rowvar=False)
    assert np.abs(correlation - np.eye(7)).max() < 0.03


def test_it_holds_what_it_draws() -> None:
    assert PRIOR.holds(DRAWN).all()


@pytest.mark.parametrize("turn", np.arange(0.0, 2.0 * math.pi, 0.3))
@pytest.mark.parametrize(("first", "radius"), [(0, 10e-6), (2, TILT)])
def test_discs_end_at_their_radius(turn: float, first: int, radius: float) -> None:
    rows = np.tile(MIDDLE, (2, 1))
    for row, share in zip(rows, (1.0 - 1e-9, 1.0 + 1e-9), strict=True):
        row[first : first + 2] = share * radius * np.array([math.cos(turn), math.sin(turn)])
    assert PRIOR.holds(rows).tolist() == [True, False]


@pytest.mark.parametrize(
    ("column", "low", "high"), [(4, 2e3, 12e3), (5, 2e-6, 14e-6), (6, 0.1, 0.3)]
)
def test_ranges_end_at_their_ends(column: int, low: float, high: float) -> None:
    rows = np.tile(MIDDLE, (4, 1))
    rows[:, column] = [np.nextafter(low, 0.0), low, high, np.nextafter(high, np.inf)]
    assert PRIOR.holds(rows).tolist() == [False, True, True, False]


def test_nothing_that_is_no_number_is_possible() -> None:
    rows = np.tile(MIDDLE, (7, 1))
    np.fill_diagonal(rows, np.nan)
    assert not PRIOR.holds(rows).any()


def test_widths() -> None:
    np.testing.assert_allclose(
        PRIOR.widths, [20e-6, 20e-6, 2.0 * TILT, 2.0 * TILT, 10e3, 12e-6, 0.2], rtol=1e-12
    )


def test_what_is_known_is_drawn_as_known() -> None:
    known = Prior(0.0, 0.0, (4e3, 4e3), (1e-5, 1e-5), (0.2, 0.2))
    drawn = known.drawn(3, np.random.default_rng(1))
    np.testing.assert_array_equal(drawn, np.tile([0, 0, 0, 0, 4e3, 1e-5, 0.2], (3, 1)))
    assert known.holds(drawn).all()


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"position_error_m": -1e-6}, r"Prior.position_error_m is -1e-06; .* at least 0"),
        ({"tilt_error_rad": math.nan}, r"Prior.tilt_error_rad is nan; .* at least 0"),
        ({"stiffness_N_m": (0.0, 1e3)}, r"Prior.stiffness_N_m \(low\) is 0.0; .* greater than 0"),
        ({"stiffness_N_m": (2e3, 1e3)}, r"Prior.stiffness_N_m is from 2000.0 to 1000.0; .* order"),
        ({"clearance_m": (2e-6, math.inf)}, r"Prior.clearance_m is from 2e-06 to inf; .* finite"),
        ({"clearance_m": (math.nan, 1e-6)}, r"Prior.clearance_m is from nan to 1e-06; .* finite"),
        ({"clearance_m": (-math.inf, 1e-6)}, r"Prior.clearance_m is from -inf to 1e-06; .* finite"),
        ({"friction": (-0.1, 0.3)}, r"Prior.friction \(low\) is -0.1; .* at least 0"),
        ({"friction": (0.4, 0.3)}, r"Prior.friction is from 0.4 to 0.3; .* in order"),
    ],
)
def test_ranges_that_cannot_be_are_refused(change: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        replace(PRIOR, **change)


def test_columns_are_as_written_here() -> None:
    assert [p.name for p in Parameter] == [
        "OFFSET_X",
        "OFFSET_Y",
        "TILT_X",
        "TILT_Y",
        "STIFFNESS",
        "CLEARANCE",
        "FRICTION",
    ]
