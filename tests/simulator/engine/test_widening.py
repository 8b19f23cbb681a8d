"""A widened table is the table of the widened part."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from simulator.contact import ContactLaw
from simulator.contact import solve as reference
from simulator.engine.solve import solve
from simulator.engine.table import Table, tabulate
from simulator.engine.widening import widened
from simulator.geometry import Part, Shaft
from tests.simulator.shapes import PARTS, SHAFTS, pressing_poses

WIDENINGS = st.lists(st.floats(-1e-5, 2e-5), min_size=1, max_size=4)


def wider(part: Part, widening_m: float) -> Part:
    """The part drawn anew: a chamfer is a width beside the bore, so it moves out with it."""
    return Part(tuple(replace(h, diameter_m=h.diameter_m + widening_m) for h in part.holes))


def assert_same(found: Table, expected: Table) -> None:
    """To rounding of a radius, and of the offset of a face."""
    for name, one, other in zip(Table._fields, found, expected, strict=True):
        np.testing.assert_allclose(one, other, rtol=1e-12, atol=1e-18, err_msg=name)


@pytest.mark.parametrize("part", PARTS.values(), ids=PARTS)
@pytest.mark.parametrize("shaft", SHAFTS.values(), ids=SHAFTS)
@settings(max_examples=15)
@given(widenings_m=WIDENINGS)
def test_is_the_table_of_the_widened_parts(
    part: Part, shaft: Shaft, widenings_m: list[float]
) -> None:
    found = widened(tabulate([(part, shaft)]), np.array(widenings_m))
    assert_same(found, tabulate([(wider(part, w), shaft) for w in widenings_m]))


def test_a_literal() -> None:
    part, shaft = PARTS["two chamfered"], SHAFTS["plain"]
    row = widened(tabulate([(part, shaft)]), np.array([4e-6])).columns[0]
    # Seven numbers of the shaft, then z and radius of mouth, throat and lower rim of each hole.
    assert row[7:19:2].tolist() == pytest.approx([0.0, 6e-5, 5e-4, 2e-3, 2.02e-3, 2.3e-3])
    assert row[8:20:2].tolist() == pytest.approx(
        [5.47e-4, 5.07e-4, 5.07e-4, 5.25e-4, 5.05e-4, 5.05e-4], rel=1e-9
    )


def test_the_shaft_touches_it_as_it_touches_the_widened_part() -> None:
    part, shaft, down = PARTS["two chamfered"], SHAFTS["chamfered"], (1e-6, 0.0, 2e-5)
    poses, widenings_m = pressing_poses(part, 300, 5, 5e-3), [-3e-6, 0.0, 5e-6]
    table = widened(tabulate([(part, shaft)]), np.array(widenings_m))
    touched = 0
    for row, widening_m in enumerate(widenings_m):
        found = solve(table, poses, down, geometry=row).wrench
        expected = reference(wider(part, widening_m), shaft, poses, down, ContactLaw()).wrench
        np.testing.assert_allclose(found, expected, rtol=1e-8, atol=1e-10)
        touched += int((expected[:, 0] != 0.0).sum())
    assert touched > 300


def test_the_table_given_is_as_before_and_the_new_one_is_locked() -> None:
    table = tabulate([(PARTS["two chamfered"], SHAFTS["plain"])])
    before = [array.tobytes() for array in table]
    found = widened(table, np.array([1e-6, 2e-6]))
    assert [array.tobytes() for array in table] == before
    for array in (found.columns, found.shaft_faces, found.wall_faces):
        assert len(array) == 2
        with pytest.raises(ValueError, match="read-only"):
            array[:] = 0.0


def test_a_table_of_several_parts_is_refused() -> None:
    table = tabulate([(part, SHAFTS["plain"]) for part in PARTS.values()])
    with pytest.raises(ValueError, match="table has 3 rows; it must have 1"):
        widened(table, np.zeros(2))


@pytest.mark.parametrize("last", [-1.01e-3, -1.006e-3, np.nan, np.inf, -np.inf])
def test_a_widening_without_a_bore_is_refused(last: float) -> None:
    """The narrower bore, 1.006 mm, decides: at 0 it is gone."""
    table = tabulate([(PARTS["two chamfered"], SHAFTS["plain"])])
    with pytest.raises(ValueError, match=r"widening_m is from .*; it must leave a bore"):
        widened(table, np.array([0.0, last]))
