"""A file is refused exactly where the geometry refuses the worst plant of its ranges."""

from collections.abc import Callable
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import ValidationError

from learning.randomisation.geometry import HoleDistributionSettings, ShaftDistributionSettings
from simulator.geometry import Hole, Shaft
from simulator.profile import Chamfer, Rounding

Ends = tuple[float, float]
small = st.integers(1, 40).map(lambda high: (0.5 * high, high))
large = st.integers(20, 80).map(lambda low: (low, 2 * low))
"""Low and high end [um]."""


def is_refused(call: Callable[[], object], error: type[ValueError]) -> bool:
    try:
        call()
    except error:
        return True
    return False


def uniform(ends: Ends) -> dict[str, Any]:
    return {"uniform": ends}


def chamfer(width: Ends, height: Ends) -> dict[str, Any]:
    return {"width_um": uniform(width), "height_um": uniform(height)}


@pytest.mark.slow
@pytest.mark.parametrize("rounded", [False, True])
@given(st.tuples(large, large, small, small, small, small))
def test_ends_of_the_shaft(rounded: bool, sizes: tuple[Ends, ...]) -> None:
    diameter, length, width, height, back_width, back_height = sizes
    leading = {"leading_chamfer": chamfer(width, height)}
    written: dict[str, Any] = {
        "diameter_um": uniform(diameter),
        "length_um": uniform(length),
        "trailing_chamfer": chamfer(back_width, back_height),
        **({"leading_rounding_um": uniform(width)} if rounded else leading),
    }
    worst = Rounding(width[1] / 1e6) if rounded else Chamfer(width[1] / 1e6, height[1] / 1e6)
    trailing = Chamfer(back_width[1] / 1e6, back_height[1] / 1e6)
    assert is_refused(
        lambda: ShaftDistributionSettings.model_validate(written), ValidationError
    ) == is_refused(lambda: Shaft(diameter[0] / 1e6, length[0] / 1e6, worst, trailing), ValueError)


@given(small, small, small)
def test_mouth_of_a_hole(thickness: Ends, width: Ends, height: Ends) -> None:
    written = {
        "clearance_um": uniform((1, 2)),
        "thickness_um": uniform(thickness),
        "entry_chamfer": chamfer(width, height),
    }
    worst = Chamfer(width[1] / 1e6, height[1] / 1e6)
    assert is_refused(
        lambda: HoleDistributionSettings.model_validate(written), ValidationError
    ) == is_refused(lambda: Hole(1e-3, thickness[0] / 1e6, entry=worst), ValueError)
