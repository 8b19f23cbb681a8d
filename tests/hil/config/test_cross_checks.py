"""Files that are valid one by one but do not fit together."""

import math

import pytest

from tests.hil.config.cell_files import Files, Load, Refuse, parent, shipped
from tests.hil.config.key_table import CELL, LIMITS, PART


def changed(*changes: tuple[str, str, object]) -> Files:
    files = shipped()
    for file, path, value in changes:
        group, last = parent(files, file, path)
        group[last] = value
    return files


@pytest.mark.parametrize(
    ("key", "value", "shown", "machine"),
    [
        ("speed_limit_mm_s", 5.001, "5.001", "5"),
        ("angular_speed_limit_deg_s", 1.1, "1.1", "1"),
        ("step_box_um", [21, 20, 60], "[21, 20, 60]", "[20, 20, 60]"),
        ("step_box_um", [20, 20, 61], "[20, 20, 61]", "[20, 20, 60]"),
        ("force_limit_mN", [71, 100, 1000], "[71, 100, 1000]", "[70, 100, 1000]"),
        ("force_limit_mN", [10, 101, 10], "[10, 101, 10]", "[70, 100, 1000]"),
        ("force_rate_limit_N_s", 41, "41", "40"),
        ("gentle_force_mN", 45, "45", "44"),
        ("impulse_limit_mN_s", 10.5, "10.5", "10"),
    ],
)
def test_part_looser_than_machine(
    key: str, value: object, shown: str, machine: str, refuse: Refuse
) -> None:
    assert refuse(changed((PART, f"limits.{key}", value))) == (
        f"config/parts/paper_online.yaml: limits.{key} = {shown} is not valid: "
        f"a part may only tighten the machine's {key} = {machine}"
    )


def test_every_looser_limit_is_told(refuse: Refuse) -> None:
    files = changed((PART, "limits.gentle_force_mN", 50), (PART, "limits.impulse_limit_mN_s", 11))
    assert refuse(files).splitlines() == [
        "config/parts/paper_online.yaml: limits.gentle_force_mN = 50 is not valid: "
        "a part may only tighten the machine's gentle_force_mN = 44",
        "config/parts/paper_online.yaml: limits.impulse_limit_mN_s = 11 is not valid: "
        "a part may only tighten the machine's impulse_limit_mN_s = 10",
    ]


@pytest.mark.parametrize(
    ("file", "path", "value", "expected"),
    [
        (
            LIMITS,
            "workspace_min_um",
            [-200, 200, -1000],
            "workspace_min_um = [-200, 200, -1000] is not valid: "
            "must be below workspace_max_um = [200, 200, 3600] along y",
        ),
        (
            LIMITS,
            "creep_speed_mm_s",
            0.5,
            None,
        ),
        (
            PART,
            "holes[0].gap_um",
            5,
            "holes[0].gap_um = 5 is not valid: must be 0, there is no hole before the first",
        ),
        (
            PART,
            "holes[1].gap_um",
            0,
            "holes[1].gap_um = 0 is not valid: must be greater than 0 and at most 100000",
        ),
        (
            PART,
            "insertion.stroke_um",
            3000,
            "insertion.stroke_um = 3000 is not valid: "
            "must be greater than 3000, the depth at which the last hole begins",
        ),
        (
            LIMITS,
            "gentle_force_mN",
            70.1,
            "gentle_force_mN = 70.1 is not valid: "
            "must not exceed force_limit_mN = [70, 100, 1000] along x or y",
        ),
        (
            LIMITS,
            "force_limit_mN",
            [100, 43, 1000],
            "gentle_force_mN = 44 is not valid: "
            "must not exceed force_limit_mN = [100, 43, 1000] along x or y",
        ),
        (LIMITS, "gentle_force_mN", 70, None),
        (
            PART,
            "contact.stiffness_mN_um",
            8.1,
            "contact.stiffness_mN_um = 8.1 is not valid: "
            "must not exceed the limit axial_stiffness_mN_um = 8",
        ),
        (PART, "contact.stiffness_mN_um", 8, None),
        (
            CELL,
            "stage.acceleration_mm_s2",
            999,
            "stage.acceleration_mm_s2 = 999 is not valid: "
            "must not be below the limit deceleration_mm_s2 = 1000",
        ),
        (PART, "insertion.stroke_um", 3000.1, None),
        (PART, "insertion.stroke_um", 3600, None),
        (
            PART,
            "insertion.stroke_um",
            3600.5,
            "insertion.stroke_um = 3600.5 is not valid: "
            "must not exceed the limit workspace_max_um = [200, 200, 3600] along z",
        ),
        (
            PART,
            "shaft.length_um",
            3199,
            "insertion.stroke_um = 3200 is not valid: must not exceed shaft.length_um = 3199",
        ),
        (PART, "shaft.length_um", 3200, None),
        (PART, "shaft.diameter_um", 1011, None),
        (
            PART,
            "insertion.axial_step_um",
            61,
            "insertion.axial_step_um = 61 is not valid: "
            "must not exceed the limit step_box_um = [20, 20, 60] along z",
        ),
        (
            PART,
            "insertion.finish_force_mN",
            1001,
            "insertion.finish_force_mN = 1001 is not valid: "
            "must not exceed the limit force_limit_mN = [70, 100, 1000] along z",
        ),
        (
            CELL,
            "skill.start_depth_um",
            -99,
            "skill.start_depth_um = -99 is not valid: "
            "must not exceed the limit clear_depth_um = -100",
        ),
        (CELL, "skill.start_depth_um", -100, None),
        (CELL, "skill.start_depth_um", -1000, None),
        (
            CELL,
            "skill.start_depth_um",
            -1001,
            "skill.start_depth_um = -1001 is not valid: "
            "must not be below the limit workspace_min_um = [-200, -200, -1000] along z",
        ),
        (
            CELL,
            "skill.contact_force_mN",
            71,
            "skill.contact_force_mN = 71 is not valid: "
            "must not exceed any of the limit force_limit_mN = [70, 100, 1000]",
        ),
        (CELL, "skill.contact_force_mN", 70, None),
        (
            CELL,
            "stage.angular_speed_limit_deg_s",
            1.5,
            "stage.angular_speed_limit_deg_s = 1.5 is not valid: "
            "must not exceed the limit angular_speed_limit_deg_s = 1",
        ),
        (
            CELL,
            "stage.travel_um",
            [500, 199, 4000],
            "stage.travel_um = [500, 199, 4000] is not valid: "
            "must reach the limit workspace_min_um = [-200, -200, -1000] and "
            "the limit workspace_max_um = [200, 200, 3600]",
        ),
        (
            CELL,
            "force_sensor.rate_Hz",
            199,
            "force_sensor.rate_Hz = 199 is not valid: "
            "must be at least 200, the rate that the limit sample_age_limit_ms = 5 asks for",
        ),
        (CELL, "force_sensor.rate_Hz", 200, None),
        *(
            (
                CELL,
                f"{device}.telemetry_rate_Hz",
                33,
                f"{device}.telemetry_rate_Hz = 33 is not valid: must be at least 33.3333333333, "
                "the rate that the limit device_age_limit_ms = 30 asks for",
            )
            for device in ("stage", "arm", "gripper")
        ),
        (
            CELL,
            "stage.backend",
            "hexapod",
            "stage.backend = 'hexapod' is not valid: must be one of mock",
        ),
    ],
)
def test_cross_check(
    file: str, path: str, value: object, expected: str | None, load: Load, refuse: Refuse
) -> None:
    files = changed((file, path, value))
    if expected is None:
        load(files)
    else:
        assert refuse(files) == f"{file}: {expected}"


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("stiffness_mN_um", [4, 3.9]),
        ("clearance_um", [10, -10]),
        ("friction", [0.2, 0.1]),
        ("axial_step_um", [60, 5]),
    ],
)
def test_a_pair_in_the_wrong_order(key: str, value: list[float], refuse: Refuse) -> None:
    path = f"controllers.look_ahead.{key}"
    assert refuse(changed((CELL, path, value))) == (
        f"config/mock_cell.yaml: {path} = {value} is not valid: the lowest value must come first"
    )


def test_limits_that_the_stage_would_exceed(refuse: Refuse) -> None:
    files = changed((LIMITS, "speed_limit_mm_s", 4), (PART, "limits.speed_limit_mm_s", 3))
    assert refuse(files) == (
        "config/mock_cell.yaml: stage.speed_limit_mm_s = 5 is not valid: "
        "must not exceed the limit speed_limit_mm_s = 4"
    )


def test_a_part_may_be_slower_than_the_stage_and_the_creep_speed(load: Load) -> None:
    assert load(changed((PART, "limits.speed_limit_mm_s", 0.05))).limits.speed_m_s == 5e-5


def test_creep_faster_than_a_tenth_of_the_speed_limit(refuse: Refuse) -> None:
    files = changed(
        (LIMITS, "speed_limit_mm_s", 2),
        (LIMITS, "creep_speed_mm_s", 0.21),
        (PART, "limits.speed_limit_mm_s", 2),
        (CELL, "stage.speed_limit_mm_s", 2),
    )
    assert refuse(files) == (
        "config/limits.yaml: creep_speed_mm_s = 0.21 is not valid: "
        "must not exceed a tenth of speed_limit_mm_s = 2"
    )


@pytest.mark.parametrize(
    ("key", "value", "shown", "valid"),
    [
        ("workspace_min_um", [1, -200, -1000], "[1, -200, -1000]", "must not exceed 0 along x"),
        ("workspace_min_um", [-200, 1, -1000], "[-200, 1, -1000]", "must not exceed 0 along y"),
        ("workspace_max_um", [-1, 200, 3600], "[-1, 200, 3600]", "must not be below 0 along x"),
        ("workspace_max_um", [200, -1, 3600], "[200, -1, 3600]", "must not be below 0 along y"),
    ],
)
def test_workspace_without_the_place_of_the_part(
    key: str, value: object, shown: str, valid: str, refuse: Refuse
) -> None:
    assert refuse(changed((LIMITS, key, value))) == (
        f"config/limits.yaml: {key} = {shown} is not valid: {valid}"
    )


def test_the_lowest_of_all_speed_limits_is_in_force(load: Load) -> None:
    own = load(
        changed(
            (CELL, "stage.speed_limit_mm_s", 2),
            (CELL, "stage.angular_speed_limit_deg_s", 0.5),
        )
    ).limits
    assert (own.speed_m_s, own.angular_speed_rad_s) == (0.002, math.radians(0.5))
    parts = load(
        changed((CELL, "stage.speed_limit_mm_s", 2), (PART, "limits.speed_limit_mm_s", 1))
    ).limits
    assert parts.speed_m_s == 0.001


@pytest.mark.parametrize("key", ["limits", "part"])
def test_file_that_is_not_there(key: str, refuse: Refuse) -> None:
    assert refuse(changed((CELL, key, "parts/nowhere.yaml"))) == (
        "config/parts/nowhere.yaml: cannot be read: No such file or directory"
    )


@pytest.mark.parametrize("key", ["limits", "part"])
def test_file_whose_name_no_file_can_have(key: str, refuse: Refuse) -> None:
    assert refuse(changed((CELL, key, "parts/a\0b.yaml"))) == (
        "'config/parts/a\\x00b.yaml': cannot be read: embedded null byte"
    )


def test_heartbeat_faster_than_the_sensor(refuse: Refuse) -> None:
    assert refuse(changed((LIMITS, "heartbeat_limit_ms", 0.5))) == (
        "config/mock_cell.yaml: force_sensor.rate_Hz = 1000 is not valid: "
        "must be at least 2000, the rate that the limit heartbeat_limit_ms = 0.5 asks for"
    )


def test_tightened_limits_hold_for_part_and_cell(refuse: Refuse) -> None:
    assert refuse(changed((PART, "limits.step_box_um", [20, 20, 50]))).splitlines() == [
        "config/parts/paper_online.yaml: insertion.axial_step_um = 60 is not valid: "
        "must not exceed the limit step_box_um = [20, 20, 50] along z",
    ]


@pytest.mark.parametrize(
    ("key", "value", "expected"),
    [
        (
            "drift.highest_frequency_Hz",
            0.001,
            "drift.highest_frequency_Hz = 0.001 is not valid: must be greater than "
            "lowest_frequency_Hz = 0.001",
        ),
        (
            "drift.highest_frequency_Hz",
            50.1,
            "drift.highest_frequency_Hz = 50.1 is not valid: must be at most 50, "
            "a twentieth of rate_Hz = 1000",
        ),
    ],
)
def test_drift_that_does_not_fit(key: str, value: float, expected: str, refuse: Refuse) -> None:
    changes = changed((CELL, f"force_sensor.{key}", value))
    assert refuse(changes) == f"config/mock_cell.yaml: force_sensor.{expected}"
