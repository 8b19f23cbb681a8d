"""Metrics against numbers worked out by hand."""

import numpy as np
import pytest

from learning.evaluation.metrics import (
    QUANTITIES,
    Measured,
    Thresholds,
    gap_closed,
    measured,
    spread,
    success_rate,
)
from tests.learning.evaluation.records import radial_record, record

THRESHOLDS = Thresholds(step_s=0.1, gentle_N=0.044)


def test_an_insertion_by_hand() -> None:
    made = record(
        # Free air; 5 mN; exactly gentle; 50 mN pulling; in the last hole.
        [(0, 0, 0), (3, 4, 1), (0, -44, 2), (30, 40, -7), (6, -8, 0)],
        [-10, 50, 1000, 2000, 2060],
        [(0, 0), (30, 40), (0, 10), (5, 0), (-300, 400)],
    )
    values = {name: v[0] for name, v in measured([made], THRESHOLDS).values.items()}
    assert values.pop("steps") == 5
    expected = {
        "radial_mean": (0 + 5 + 44 + 50 + 10) / 5 * 1e-3,
        "radial_peak": 50e-3,
        "radial_contact_mean": (5 + 44 + 50 + 10) / 4 * 1e-3,
        # The step at 2000 um ends on the rim, not below it.
        "last_hole_peak": 10e-3,
        "axial_mean": (0 + 1 + 2 + 7 + 0) / 5 * 1e-3,
        "axial_peak": 7e-3,
        "torque_peak": 500e-6,
        "impulse": (5 + 44 + 50 + 10) * 1e-3 * 0.1,
        "hard_time": 0.1,
        "hard_share": 0.2,
    }
    assert values == pytest.approx(expected, rel=1e-12)
    assert {"steps", *expected} == set(QUANTITIES)


def test_axial_force_alone_is_contact() -> None:
    made = record([(0, 0, 0), (0, 0, 1), (2, 0, 0)], [10, 20, 30])
    assert measured([made], THRESHOLDS).values["radial_contact_mean"] == pytest.approx([1e-3])


def test_no_contact_at_all_and_no_step_in_the_last_hole() -> None:
    values = measured([record([(0, 0, 0)], [10], is_inserted=False)], THRESHOLDS).values
    assert values["radial_contact_mean"] == 0.0
    assert np.isnan(values["last_hole_peak"][0])


@pytest.mark.parametrize(
    ("force_mN", "is_inserted", "is_success"),
    [
        ((70, 100, 1000), True, 1),
        ((-70.001, 0, 0), True, 0),
        ((0, 100.001, 0), True, 0),
        ((0, 0, -1000.1), True, 0),
        ((0, 0, 0), False, 0),
    ],
)
def test_success(force_mN: tuple[float, float, float], is_inserted: bool, is_success: int) -> None:
    made = record([force_mN, (0, 0, 0)], [10, 20], is_inserted=is_inserted)
    assert measured([made], THRESHOLDS).is_success == [is_success]


@pytest.mark.parametrize(
    ("successes", "n", "low", "high"),
    # Wilson: (p + z2/2n -+ z sqrt(p(1-p)/n + z2/4n2)) / (1 + z2/n), z = 1.959964.
    [(30, 30, 0.886487, 1.0), (8, 20, 0.218807, 0.613418), (0, 10, 0.0, 0.277533)],
)
def test_success_rate_has_wilsons_interval(successes: int, n: int, low: float, high: float) -> None:
    found = success_rate(np.repeat([1.0, 0.0], [successes, n - successes]))
    assert found == pytest.approx((successes / n, low, high), abs=1e-6)


def test_spread_leaves_out_what_is_not_known() -> None:
    values = np.array([np.nan, *np.arange(101.0)])
    found = spread(values, 500, np.random.default_rng(0))
    assert (found.mean.value, found.p50, found.p95, found.largest) == (50.0, 50.0, 95.0, 100.0)
    # The mean of 101 values of standard deviation 29.15 has one of 2.90.
    assert found.mean.low == pytest.approx(50 - 1.96 * 2.9, abs=0.8)
    assert found.mean.high == pytest.approx(50 + 1.96 * 2.9, abs=0.8)
    assert np.isnan(spread(np.array([np.nan]), 100, np.random.default_rng(0)).mean).all()


def test_intervals_depend_on_the_generator_alone() -> None:
    values = np.arange(20.0)
    first = spread(values, 300, np.random.default_rng(3))
    assert first == spread(values, 300, np.random.default_rng(3))
    assert first.mean != spread(values, 300, np.random.default_rng(4)).mean


def _measured(*means_mN: float) -> Measured:
    return measured([radial_record(mN, mN) for mN in means_mN], THRESHOLDS)


def test_gap_is_closed_from_the_tuned_to_the_bound() -> None:
    tuned, bound = _measured(10, 20, 30), _measured(2, 4, 6)
    for of, share in ((tuned, 0.0), (bound, 1.0), (_measured(6, 12, 18), 0.5)):
        gap = gap_closed(of, tuned, bound, 200, np.random.default_rng(0))
        # In proportion on every plant: however plants are drawn, the share is the same.
        assert gap.radial_mean == pytest.approx((share, share, share), abs=1e-12)
        assert gap.last_hole_p95 == pytest.approx((share, share, share), abs=1e-12)


def test_gap_below_zero_is_worse_than_tuned() -> None:
    gap = gap_closed(
        _measured(14, 14), _measured(10, 10), _measured(2, 2), 100, np.random.default_rng(0)
    )
    assert gap.radial_mean.value == pytest.approx(-0.5)
