"""Every key of a randomisation file, spoiled, and the exact line that follows."""

from typing import Any

import pytest

from tests.learning.randomisation.plant_files import (
    FILE,
    KINDS,
    NUMBERS,
    REQUIRED,
    ROUNDING,
    SPREADS,
    Number,
    Refuse,
    Spread,
    drop,
    full,
    put,
)

pytestmark = pytest.mark.slow

ROWS = (*SPREADS, *NUMBERS)
WRONG_UNITS = {
    "um": ("um", "mm"),
    "deg": ("deg", "rad"),
    "mN/um": ("mN_um", "N_mm"),
    "mN": ("mN", "N"),
    "um/mN": ("um_mN", "mm_N"),
    "urad/(uN m)": ("urad_uNm", "deg_Nm"),
    "%": ("percent", "permille"),
    "uN m": ("uNm", "Nm"),
    "uN/sqrt(Hz)": ("uN_rtHz", "mN_rtHz"),
    "nN m/sqrt(Hz)": ("nNm_rtHz", "uNm_rtHz"),
    "um/sqrt(s)": ("um_rts", "mm_rts"),
    "deg/sqrt(s)": ("deg_rts", "rad_rts"),
    "Hz": ("Hz", "kHz"),
    "ms": ("ms", "s"),
    "s": ("s", "ms"),
}


def every(rows: tuple[Any, ...]) -> pytest.MarkDecorator:
    return pytest.mark.parametrize("row", rows, ids=lambda row: row.path)


def with_value(path: str, value: object) -> dict[str, Any]:
    file = full(path)
    put(file, path, value)
    return file


@every(SPREADS)
def test_a_distribution_that_reaches_too_low(row: Spread, refuse: Refuse) -> None:
    middle = 0.5 * (row.low + row.high)
    spoiled = with_value(row.path, {"uniform": [row.low, middle]})
    assert refuse(spoiled) == (
        f"{FILE}: {row.path} = {{uniform: [{row.low!r}, {middle!r}]}} is not valid: "
        f"must be {row.range} throughout"
    )


@every(SPREADS)
def test_a_distribution_that_reaches_too_high(row: Spread, refuse: Refuse) -> None:
    spoiled = with_value(row.path, {"choice": [row.high, 0.5]})
    assert refuse(spoiled) == (
        f"{FILE}: {row.path} = {{choice: [{row.high!r}, 0.5]}} is not valid: "
        f"must be {row.range} throughout"
    )


@every(NUMBERS)
def test_a_number_out_of_range(row: Number, refuse: Refuse) -> None:
    for value in (row.low, row.high):
        assert refuse(with_value(row.path, value)) == (
            f"{FILE}: {row.path} = {value!r} is not valid: must be {row.range}"
        )


@every(tuple(row for row in ROWS if row.path in REQUIRED))
def test_missing(row: Spread | Number, refuse: Refuse) -> None:
    file = full(row.path)
    drop(file, row.path)
    valid = f"a group of keys: {KINDS}" if isinstance(row, Spread) else f"a number {row.range}"
    unit = f", in {row.unit}" if row.unit else ""
    assert refuse(file) == f"{FILE}: {row.path} is missing: must be {valid}{unit}"


@every(tuple(row for row in ROWS if row.unit))
def test_wrong_unit(row: Spread | Number, refuse: Refuse) -> None:
    file = full(row.path)
    right, wrong = WRONG_UNITS[row.unit]
    stated = row.path.removesuffix("[1]") if isinstance(row, Number) else row.path
    path = stated.removesuffix(right) + wrong
    put(file, path, drop(file, stated))
    key = stated.split(".")[-1]
    assert refuse(file) == (
        f"{FILE}: {path} is not a key: did you mean {key}? Its unit is {row.unit}"
    )


FRICTION = "contact.friction"
DISTRIBUTIONS: list[tuple[object, str]] = [
    (0.2, f"{FRICTION} = 0.2 is not valid: must be a group of keys: {KINDS}"),
    ([0.1, 0.3], f"{FRICTION} = [0.1, 0.3] is not valid: must be a group of keys: {KINDS}"),
    ({}, f"{FRICTION} = {{}} is not valid: must be exactly one of {KINDS}"),
    (
        {"constant": 0.2, "uniform": [0.1, 0.3]},
        f"{FRICTION} = {{constant: 0.2, uniform: [0.1, 0.3]}} is not valid: "
        f"must be exactly one of {KINDS}",
    ),
    ({"unifrom": [0.1, 0.3]}, f"{FRICTION}.unifrom is not a key: did you mean uniform?"),
    (
        {"constant": "0.2 um"},
        f"{FRICTION}.constant = '0.2 um' is not valid: must be a number; "
        "write the number alone, the key carries the unit",
    ),
    (
        {"constant": float("nan")},
        f"{FRICTION}.constant = .nan is not valid: must be a finite number",
    ),
    (
        {"uniform": 0.2},
        f"{FRICTION}.uniform = 0.2 is not valid: must be a list of 2 numbers",
    ),
    (
        {"uniform": [0.3, 0.1]},
        f"{FRICTION}.uniform = [0.3, 0.1] is not valid: "
        "must be a low and a high end, low less than high",
    ),
    (
        {"uniform": [0.1, 0.2, 0.3]},
        f"{FRICTION}.uniform = [0.1, 0.2, 0.3] is not valid: must be a list of 2 numbers",
    ),
    (
        {"log_uniform": [0, 0.1]},
        f"{FRICTION}.log_uniform = [0, 0.1] is not valid: "
        "must be a low and a high end, 0 less than low less than high",
    ),
    (
        {"choice": []},
        f"{FRICTION}.choice = [] is not valid: must be a list with at least one entry",
    ),
    (
        {"choice": [0.1, "a"]},
        f"{FRICTION}.choice[1] = 'a' is not valid: must be a number",
    ),
    (
        {"truncated_normal": {"mean": 0.2, "std": 0, "low": 0.1, "high": 0.3}},
        f"{FRICTION}.truncated_normal.std = 0 is not valid: must be greater than 0",
    ),
    (
        {"truncated_normal": {"mean": 0.2, "std": 1, "low": 0.1}},
        f"{FRICTION}.truncated_normal.high is missing: must be a number",
    ),
    (
        {"truncated_normal": {"mean": 0.4, "std": 1, "low": 0.1, "high": 0.3}},
        f"{FRICTION}.truncated_normal = {{mean: 0.4, std: 1, low: 0.1, high: 0.3}} is not valid: "
        "must be such that low < high and low <= mean <= high",
    ),
    (
        {"truncated_normal": {"mean": 0.2, "std": 1, "low": 0.1, "high": 2.1}},
        f"{FRICTION} = {{truncated_normal: {{mean: 0.2, std: 1, low: 0.1, high: 2.1}}}} is not "
        "valid: must be at least 0 and at most 2 throughout",
    ),
]


@pytest.mark.parametrize(("value", "expected"), DISTRIBUTIONS)
def test_what_is_no_distribution(value: object, expected: str, refuse: Refuse) -> None:
    assert refuse(with_value(FRICTION, value)) == f"{FILE}: {expected}"


CROSS: list[tuple[str, object, str]] = [
    ("holes", [], "holes = [] is not valid: must be a list with at least one entry"),
    (
        "holes[0].gap_um",
        {"constant": 1},
        "holes[0].gap_um is not a key: there is no hole before the first",
    ),
    (
        "holes[1].clearance_um",
        {"uniform": [-50, 10]},
        "holes[1].clearance_um reaches -50: must be above -40.5 throughout, "
        "where the thinnest shaft has no hole",
    ),
    (
        "holes[1].entry_chamfer.height_um",
        {"uniform": [5, 500]},
        "holes[1].entry_chamfer.height_um reaches 500: must be below 500 throughout, "
        "the thickness of the thinnest wall",
    ),
    (
        "shaft.leading_chamfer.width_um",
        {"uniform": [5, 20]},
        "shaft.leading_chamfer.width_um reaches 20: must be below 20 throughout, "
        "the radius of the thinnest shaft",
    ),
    (
        ROUNDING,
        {"uniform": [5, 20.5]},
        "shaft.leading_rounding_um reaches 20.5: must be below 20 throughout, "
        "the radius of the thinnest shaft",
    ),
    (
        "shaft.trailing_chamfer.width_um",
        {"constant": 21},
        "shaft.trailing_chamfer.width_um reaches 21: must be below 20 throughout, "
        "the radius of the thinnest shaft",
    ),
    (
        "shaft.trailing_chamfer.height_um",
        {"log_uniform": [5, 3999.75]},
        "shaft.length_um reaches 4000: must be above 4000.25 throughout, "
        "the length of the worked ends",
    ),
    (
        "force_sensor.drift.highest_frequency_Hz",
        50.1,
        "force_sensor.drift.highest_frequency_Hz = 50.1 is not valid: must be at most 50, "
        "a twentieth of rate_Hz = 1000",
    ),
    (
        "force_sensor.drift.highest_frequency_Hz",
        0.0005,
        "force_sensor.drift.highest_frequency_Hz = 0.0005 is not valid: must be greater than "
        "lowest_frequency_Hz = 0.001",
    ),
    (
        "xyzzy",
        1,
        "xyzzy is not a key: valid keys are contact, shaft, common_clearance_um, holes, alignment, "
        "force_sensor, stage, arm, holder",
    ),
]


@pytest.mark.parametrize(("path", "value", "expected"), CROSS)
def test_what_does_not_fit_together(
    path: str, value: object, expected: str, refuse: Refuse
) -> None:
    file = with_value(path, value)
    put(file, "shaft.diameter_um", {"uniform": [40, 50]})
    assert refuse(file) == f"{FILE}: {expected}"


def test_a_leading_end_is_chamfered_or_rounded(refuse: Refuse) -> None:
    file = full()
    put(file, ROUNDING, {"constant": 5})
    assert refuse(file) == (
        f"{FILE}: shaft.leading_rounding_um is not valid beside leading_chamfer: "
        "the leading end has one of the two"
    )


def test_what_holes_have_in_common_counts(refuse: Refuse) -> None:
    file = with_value("common_clearance_um", {"choice": [-41, 12]})
    put(file, "shaft.diameter_um", {"uniform": [40, 50]})
    put(file, "holes[1].clearance_um", {"uniform": [1.25, 2]})
    assert refuse(file) == (
        f"{FILE}: holes[0].clearance_um reaches 0.5: must be above 1 throughout, "
        "where the thinnest shaft has no hole"
    )


def test_crosstalk_needs_the_ranges_that_it_is_a_share_of(refuse: Refuse) -> None:
    file = full()
    for key in ("force_range_mN", "torque_range_uNm"):
        drop(file, f"force_sensor.{key}")
    assert refuse(file).splitlines() == [
        f"{FILE}: force_sensor.force_range_mN is missing: crosstalk_percent is a share of it",
        f"{FILE}: force_sensor.torque_range_uNm is missing: crosstalk_percent is a share of it",
    ]


def test_all_problems_are_told_at_once(refuse: Refuse) -> None:
    file = with_value("contact.stiffness_mN_um", {"uniform": [0, 12]})
    put(file, "arm.vibration[1].damping_ratio", 1)
    drop(file, "alignment")
    assert refuse(file).splitlines() == [
        f"{FILE}: contact.stiffness_mN_um = {{uniform: [0, 12]}} is not valid: "
        "must be greater than 0 and at most 1000 throughout",
        f"{FILE}: alignment is missing: must be a group of keys: position_error_um, tilt_error_deg",
        f"{FILE}: arm.vibration[1].damping_ratio = 1 is not valid: "
        "must be greater than 0 and less than 1",
    ]
