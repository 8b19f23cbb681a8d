"""A part may tighten each of the machine's limits, and loosen none."""

from typing import Any

import pytest
from pydantic import ValidationError

from controllers.limits import Limits, PartLimits, tighten
from drivers.contract.errors import ConfigurationError

MACHINE: dict[str, Any] = {
    "speed_limit_mm_s": 4.0,
    "angular_speed_limit_deg_s": 1.0,
    "arm_speed_limit_mm_s": 50.0,
    "step_box_um": (20.0, 30.0, 60.0),
    "rotation_step_limit_deg": 0.05,
    "workspace_min_um": (-200.0, -200.0, -1000.0),
    "workspace_max_um": (200.0, 200.0, 3600.0),
    "tilt_limit_deg": 0.6,
    "clear_depth_um": -100.0,
    "arm_tolerance_um": 5.0,
    "force_limit_mN": (70.0, 100.0, 1000.0),
    "force_rate_limit_N_s": 100.0,
    "gentle_force_mN": 44.0,
    "impulse_limit_mN_s": 10.0,
    "sample_age_limit_ms": 5.0,
    "device_age_limit_ms": 30.0,
    "proposal_age_limit_ms": 50.0,
    "heartbeat_limit_ms": 20.0,
    "reaction_time_ms": 2.0,
    "deceleration_mm_s2": 1000.0,
    "radial_stiffness_mN_um": 16.0,
    "axial_stiffness_mN_um": 4.0,
    "lever_um": 4000.0,
    "creep_speed_mm_s": 0.1,
    "uncertainty_sigmas": 3.0,
}


def tightened(**part: object) -> Limits:
    return tighten(Limits.model_validate(MACHINE), PartLimits.model_validate(part))


def test_a_part_without_limits_takes_the_machines() -> None:
    assert tightened() == Limits.model_validate(MACHINE)


@pytest.mark.parametrize(
    "key",
    [
        "speed_limit_mm_s",
        "angular_speed_limit_deg_s",
        "step_box_um",
        "force_limit_mN",
        "force_rate_limit_N_s",
        "gentle_force_mN",
        "impulse_limit_mN_s",
    ],
)
def test_equal_is_allowed(key: str) -> None:
    assert tightened(**{key: MACHINE[key]}) == Limits.model_validate(MACHINE)


@pytest.mark.parametrize(
    ("key", "value", "attribute", "expected"),
    [
        ("speed_limit_mm_s", 3.9, "speed_m_s", 0.0039),
        ("angular_speed_limit_deg_s", 0.9, "angular_speed_rad_s", 0.015707963267948967),
        ("step_box_um", (19.0, 30.0, 60.0), "step_m", (1.9e-5, 3e-5, 6e-5)),
        ("step_box_um", (20.0, 29.0, 60.0), "step_m", (2e-5, 2.9e-5, 6e-5)),
        ("step_box_um", (20.0, 30.0, 59.0), "step_m", (2e-5, 3e-5, 5.9e-5)),
        ("force_limit_mN", (69.0, 100.0, 1000.0), "force_N", (0.069, 0.1, 1.0)),
        ("force_limit_mN", (70.0, 99.0, 1000.0), "force_N", (0.07, 0.099, 1.0)),
        ("force_limit_mN", (70.0, 100.0, 999.0), "force_N", (0.07, 0.1, 0.999)),
        ("force_rate_limit_N_s", 99.0, "force_rate_N_s", 99.0),
        ("gentle_force_mN", 43.0, "gentle_force_N", 0.043),
        ("impulse_limit_mN_s", 9.9, "impulse_N_s", 0.0099),
    ],
)
def test_tighter_is_taken_and_nothing_else_changes(
    key: str, value: object, attribute: str, expected: object
) -> None:
    before = Limits.model_validate(MACHINE).model_dump()
    assert tightened(**{key: value}).model_dump() == before | {attribute: expected}


@pytest.mark.parametrize(
    ("key", "value", "message"),
    [
        ("speed_limit_mm_s", 4.1, "speed_limit_mm_s = 4.1 is not valid: {} speed_limit_mm_s = 4"),
        (
            "angular_speed_limit_deg_s",
            1.1,
            "angular_speed_limit_deg_s = 1.1 is not valid: {} angular_speed_limit_deg_s = 1",
        ),
        (
            "step_box_um",
            (21.0, 1.0, 1.0),
            "step_box_um = [21, 1, 1] is not valid: {} step_box_um = [20, 30, 60]",
        ),
        (
            "step_box_um",
            (1.0, 31.0, 1.0),
            "step_box_um = [1, 31, 1] is not valid: {} step_box_um = [20, 30, 60]",
        ),
        (
            "step_box_um",
            (1.0, 1.0, 61.0),
            "step_box_um = [1, 1, 61] is not valid: {} step_box_um = [20, 30, 60]",
        ),
        (
            "force_limit_mN",
            (71.0, 1.0, 1.0),
            "force_limit_mN = [71, 1, 1] is not valid: {} force_limit_mN = [70, 100, 1000]",
        ),
        (
            "force_limit_mN",
            (1.0, 101.0, 1.0),
            "force_limit_mN = [1, 101, 1] is not valid: {} force_limit_mN = [70, 100, 1000]",
        ),
        (
            "force_limit_mN",
            (1.0, 1.0, 1000.5),
            "force_limit_mN = [1, 1, 1000.5] is not valid: {} force_limit_mN = [70, 100, 1000]",
        ),
        (
            "force_rate_limit_N_s",
            100.1,
            "force_rate_limit_N_s = 100.1 is not valid: {} force_rate_limit_N_s = 100",
        ),
        ("gentle_force_mN", 45.0, "gentle_force_mN = 45 is not valid: {} gentle_force_mN = 44"),
        (
            "impulse_limit_mN_s",
            10.1,
            "impulse_limit_mN_s = 10.1 is not valid: {} impulse_limit_mN_s = 10",
        ),
    ],
)
def test_looser_is_refused(key: str, value: object, message: str) -> None:
    with pytest.raises(ConfigurationError) as caught:
        tightened(**{key: value})
    assert str(caught.value) == message.format("a part may only tighten the machine's")


@pytest.mark.parametrize("key", sorted(MACHINE))
def test_no_limit_of_the_machine_can_be_left_out(key: str) -> None:
    stated = {k: v for k, v in MACHINE.items() if k != key}
    with pytest.raises(ValidationError, match=key):
        Limits.model_validate(stated)


def test_the_speed_limit_cannot_exceed_5_mm_s() -> None:
    with pytest.raises(ValidationError, match="speed_limit_mm_s"):
        Limits.model_validate(MACHINE | {"speed_limit_mm_s": 5.0000001})
