"""Written units to SI and back."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from controllers.limits import Limits, PartLimits
from drivers.contract.settings import DEGREES, KILO, MICRO, MILLI, NANO, PERCENT, Scale, written


@pytest.mark.parametrize(
    ("scale", "value", "si"),
    [
        (NANO, 223.6, 2.236e-7),
        (MICRO, 35.0, 3.5e-5),
        (MILLI, 44.0, 0.044),
        (PERCENT, 25.0, 0.25),
        (KILO, 16.0, 16_000.0),
        (DEGREES, 180.0, math.pi),
    ],
)
def test_to_si_is_exact(scale: Scale, value: float, si: float) -> None:
    assert scale.to_si(value) == si
    assert scale.to_si((value, -value)) == (si, -si)
    assert scale.to_written(si) == value
    assert scale.to_written((si, 0.0)) == (value, 0.0)


@given(st.sampled_from([NANO, MICRO, MILLI, PERCENT, KILO, DEGREES]), st.floats(-1e9, 1e9))
def test_there_and_back(scale: Scale, value: float) -> None:
    assert scale.to_written(scale.to_si(value)) == pytest.approx(value, rel=1e-15, abs=1e-300)


@pytest.mark.parametrize(
    ("attribute", "value", "expected"),
    [
        ("speed_m_s", 0.005, "speed_limit_mm_s = 5"),
        ("tilt_rad", math.radians(0.6), "tilt_limit_deg = 0.6"),
        ("step_m", (2e-5, 2e-5, 6e-5), "step_box_um = [20, 20, 60]"),
        ("uncertainty_sigmas", 3.0, "uncertainty_sigmas = 3"),
        ("lever_m", 1.0, "lever_um = 1000000"),
    ],
)
def test_written(attribute: str, value: float | tuple[float, ...], expected: str) -> None:
    assert written(Limits, attribute, value) == expected


@pytest.mark.parametrize(
    ("attribute", "value", "expected"),
    [
        ("angular_speed_rad_s", math.radians(0.5), "angular_speed_limit_deg_s = 0.5"),
        ("step_m", (2e-5, 2e-5, 6e-5), "step_box_um = [20, 20, 60]"),
        ("force_rate_N_s", 40.0, "force_rate_limit_N_s = 40"),
    ],
)
def test_written_what_may_be_left_out(
    attribute: str, value: float | tuple[float, ...], expected: str
) -> None:
    assert written(PartLimits, attribute, value) == expected
