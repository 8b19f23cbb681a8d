"""Every key of every file, spoiled in every way, and the exact message that follows."""

import math
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from drivers.contract.errors import ConfigurationError
from hil.config import load_cell
from tests.hil.config.cell_files import (
    EFFECTS,
    Files,
    Load,
    Refuse,
    Twice,
    parent,
    shipped,
    steps,
    write,
)
from tests.hil.config.key_table import (
    CELL,
    GROUPS,
    KEYS,
    LIMITS,
    LISTS,
    NUMBER,
    OPTIONAL,
    PART,
    WHOLE,
    Group,
    Key,
    is_named,
)

pytestmark = pytest.mark.slow

WRONG_UNITS = {
    "mm/s": ("mm_s", "m_s"),
    "deg/s": ("deg_s", "rad_s"),
    "um": ("um", "mm"),
    "deg": ("deg", "rad"),
    "mN": ("mN", "N"),
    "N/s": ("N_s", "mN_s"),
    "mN s": ("mN_s", "N_s"),
    "ms": ("ms", "s"),
    "mm/s2": ("mm_s2", "m_s2"),
    "mN/um": ("mN_um", "N_mm"),
    "Hz": ("Hz", "kHz"),
    "uN m": ("uNm", "Nm"),
    "N/s2": ("N_s2", "mN_s2"),
    "N m/s2": ("Nm_s2", "mNm_s2"),
    "um/N": ("um_N", "mm_N"),
    "uN/sqrt(Hz)": ("uN_rtHz", "mN_rtHz"),
    "nN m/sqrt(Hz)": ("nNm_rtHz", "uNm_rtHz"),
    "%": ("percent", "ppm"),
    "um/sqrt(s)": ("um_rts", "mm_rts"),
    "deg/sqrt(s)": ("deg_rts", "rad_rts"),
    "s": ("s", "ms"),
}
NUMERIC = [key for key in KEYS if key.kind in (NUMBER, WHOLE, *LISTS)]
ONE_OF_EACH_KIND = ("speed_limit_mm_s", "force_limit_mN", "filter.tare_samples")


def label(row: Key | Group) -> str:
    return f"{row.file.removeprefix('config/')}:{row.path}"


def every(rows: list[Any] | tuple[Any, ...]) -> pytest.MarkDecorator:
    return pytest.mark.parametrize("row", rows, ids=label)


def entry(key: Key) -> str:
    """Where a single number of the key stands."""
    return f"{key.path}[1]" if key.kind in LISTS else key.path


def spoiled(path: str, file: str, value: object) -> Files:
    files = shipped()
    group, last = parent(files, file, path)
    group[last] = value
    return files


@every(KEYS)
def test_wrong_type(row: Key, refuse: Refuse) -> None:
    value, shown = (5, "5") if row.kind == "text" else ("abc", "'abc'")
    hint = "; put it in quotes" if row.kind == "text" else ""
    assert refuse(spoiled(row.path, row.file, value)) == (
        f"{row.file}: {row.path} = {shown} is not valid: must be {row.valid}{hint}"
    )


@every([key for key in KEYS if key.path in ONE_OF_EACH_KIND])
@pytest.mark.parametrize(
    ("value", "shown", "hint"),
    [
        (True, "true", ""),
        ("yes", "'yes'", ""),
        ("0x1F", "'0x1F'", "; write a plain decimal number"),
        ("1:30", "'1:30'", "; write a plain decimal number"),
        ("2um", "'2um'", "; write the number alone, the key carries the unit"),
        ("-1.5e3 mN", "'-1.5e3 mN'", "; write the number alone, the key carries the unit"),
        ("5 mm", "'5 mm'", "; write the number alone, the key carries the unit"),
        ("1_000", "'1_000'", "; write a plain decimal number"),
        ("7", "'7'", "; write a plain decimal number without quotes"),
        ({"a": [1, "b"]}, "{a: [1, 'b']}", ""),
        ("x" * 200, "'" + "x" * 59 + "...", ""),
    ],
)
def test_number_in_disguise(row: Key, value: object, shown: str, hint: str, refuse: Refuse) -> None:
    accepted = f"{row.kind if row.kind not in LISTS else NUMBER} {row.range}".rstrip()
    assert refuse(spoiled(entry(row), row.file, value)) == (
        f"{row.file}: {entry(row)} = {shown} is not valid: must be {accepted}{hint}"
    )


@every([key for key in KEYS if key.low is not None])
def test_too_low(row: Key, refuse: Refuse) -> None:
    assert refuse(spoiled(entry(row), row.file, row.low)) == (
        f"{row.file}: {entry(row)} = {row.low!r} is not valid: must be {_range(row)}"
    )


@every([key for key in KEYS if key.high is not None])
def test_too_high(row: Key, refuse: Refuse) -> None:
    shown = f"'{'n' * 59}..." if isinstance(row.high, str) else repr(row.high)
    assert refuse(spoiled(entry(row), row.file, row.high)) == (
        f"{row.file}: {entry(row)} = {shown} is not valid: must be {_range(row)}"
    )


def _range(row: Key) -> str:
    return row.valid if row.kind == "text" else row.range


@every(NUMERIC)
@pytest.mark.parametrize(
    ("value", "shown"), [(math.nan, ".nan"), (math.inf, ".inf"), (-math.inf, "-.inf")]
)
def test_not_finite(row: Key, value: float, shown: str, refuse: Refuse) -> None:
    noun = "a whole number" if row.kind == WHOLE else "a finite number"
    accepted = f"{noun} {row.range}".rstrip()
    assert refuse(spoiled(entry(row), row.file, value)) == (
        f"{row.file}: {entry(row)} = {shown} is not valid: must be {accepted}"
    )


@every([key for key in KEYS if key.kind in LISTS])
@pytest.mark.parametrize("length", [0, 1, 2, 3, 4, 7])
def test_wrong_length(row: Key, length: int, refuse: Refuse) -> None:
    value = [1] * length
    if row.kind == f"a list of {length} numbers":
        return
    assert refuse(spoiled(row.path, row.file, value)) == (
        f"{row.file}: {row.path} = {value} is not valid: must be {row.valid}"
    )


@every([row for row in (*KEYS, *GROUPS) if (row.file, row.path) not in OPTIONAL and is_named(row)])
def test_missing(row: Key | Group, refuse: Refuse) -> None:
    files = shipped()
    group, last = parent(files, row.file, row.path)
    del group[last]
    unit = f", in {row.unit}" if isinstance(row, Key) and row.unit else ""
    valid = row.valid
    if row.path == "holes[1].gap_um":
        valid = "a number greater than 0 and at most 100000"
    assert refuse(files) == f"{row.file}: {row.path} is missing: must be {valid}{unit}"


OPTIONAL_ROWS = [row for row in (*KEYS, *GROUPS) if (row.file, row.path) in OPTIONAL]


@every([row for row in OPTIONAL_ROWS if row.file == CELL and "[" not in row.path])
def test_what_a_mock_is_not_told_to_do_is_off(row: Key | Group, load: Load) -> None:
    files, bare = shipped(), shipped()
    group, last = parent(files, row.file, row.path)
    del group[last]
    device, *_ = row.path.split(".")
    settings = getattr(load(files), device).settings
    bare[CELL][device] = {k: v for k, v in group.items() if k not in EFFECTS[device]}
    off = getattr(load(bare), device).settings
    field = next(n for n, f in type(off).model_fields.items() if (f.alias or n) == last)
    assert getattr(settings, field) == getattr(off, field)
    assert not getattr(off, field)


@every([row for row in OPTIONAL_ROWS if row.file == PART])
def test_missing_part_limit_is_the_machines(row: Key | Group, load: Load) -> None:
    files = shipped()
    group, last = parent(files, row.file, row.path)
    del group[last]
    assert load(files).limits == load(shipped()).limits


@every(KEYS)
def test_duplicate(row: Key, refuse: Refuse) -> None:
    files = shipped()
    *before, last = steps(row.path)
    group: Any = files
    holder: str | int = row.file
    for step in before:
        group, holder = group[holder], step
    twice = Twice(group[holder])
    twice.twice = str(last)
    group[holder] = twice
    assert refuse(files) == f"{row.file}, line 1: {last} appears a second time"


@every([key for key in KEYS if key.unit])
def test_wrong_unit(row: Key, refuse: Refuse) -> None:
    files = shipped()
    group, last = parent(files, row.file, row.path)
    right, wrong = WRONG_UNITS[row.unit]
    group[last.removesuffix(right) + wrong] = group.pop(last)
    path = row.path.removesuffix(right) + wrong
    assert refuse(files) == (
        f"{row.file}: {path} is not a key: did you mean {last}? Its unit is {row.unit}"
    )


@every([key for key in KEYS if key.unit])
def test_no_unit(row: Key, refuse: Refuse) -> None:
    files = shipped()
    group, last = parent(files, row.file, row.path)
    stem = row.path.removesuffix(f"_{WRONG_UNITS[row.unit][0]}")
    group[steps(stem)[-1]] = group.pop(last)
    alike = [
        str(steps(key.path)[-1])
        for key in KEYS
        if key.unit and key.file == row.file and key.path == f"{stem}_{WRONG_UNITS[key.unit][0]}"
    ]
    unit = f" Its unit is {row.unit}" if alike == [last] else ""
    assert refuse(files).splitlines()[0] == (
        f"{row.file}: {stem} is not a key: did you mean {' or '.join(alike)}?{unit}"
    )


@every([row for row in (*KEYS, *GROUPS) if is_named(row)])
def test_misspelt(row: Key | Group, refuse: Refuse) -> None:
    files = shipped()
    group, last = parent(files, row.file, row.path)
    group[f"{last[0]}{last}"] = group.pop(last)
    path = f"{row.path.removesuffix(last)}{last[0]}{last}"
    expected = f"{row.file}: {path} is not a key: did you mean {last}?"
    if row.path.endswith((".backend", ".kind")):
        expected = f"{row.file}: {row.path} is missing: must be {row.valid}"
    assert refuse(files) == expected


@pytest.mark.parametrize("file", [LIMITS, PART, CELL])
def test_unknown(file: str, refuse: Refuse) -> None:
    valid = {
        LIMITS: ", ".join(key.path for key in KEYS if key.file == LIMITS),
        PART: "name, shaft, holes, contact, alignment, insertion, limits",
        CELL: "limits, part, force_sensor, stage, arm, gripper, arm_poses, filter, skill, "
        "controllers",
    }
    files = shipped()
    files[file]["xyzzy"] = 1
    assert refuse(files) == f"{file}: xyzzy is not a key: valid keys are {valid[file]}"


@every(GROUPS)
def test_group_of_wrong_type(row: Group, refuse: Refuse) -> None:
    assert refuse(spoiled(row.path, row.file, 7)) == (
        f"{row.file}: {row.path} = 7 is not valid: must be {row.valid}"
    )


@pytest.mark.parametrize(
    ("path", "value", "expected"),
    [
        ("holes", [], "holes = [] is not valid: must be a list with at least one entry"),
        (
            "controllers",
            {},
            "controllers = {} is not valid: must be a mapping of names to groups of keys",
        ),
    ],
)
def test_empty_group(path: str, value: object, expected: str, refuse: Refuse) -> None:
    file = PART if path == "holes" else CELL
    assert refuse(spoiled(path, file, value)) == f"{file}: {expected}"


def test_all_problems_of_a_file_are_told_at_once(refuse: Refuse) -> None:
    files = shipped()
    files[CELL]["stage"]["speed_limit_mm_s"] = 7
    files[CELL]["arm"]["acceleration_mm_s2"] = "fast"
    files[CELL]["filter"]["tare_samples"] = 1.5
    del files[CELL]["skill"]["settle_time_ms"]
    assert refuse(files).splitlines() == [
        "config/mock_cell.yaml: filter.tare_samples = 1.5 is not valid: "
        "must be a whole number at least 10 and at most 100000",
        "config/mock_cell.yaml: skill.settle_time_ms is missing: "
        "must be a number at least 0 and at most 10000, in ms",
        "config/mock_cell.yaml: stage.speed_limit_mm_s = 7 is not valid: "
        "must be at least 0.01 and at most 5",
        "config/mock_cell.yaml: arm.acceleration_mm_s2 = 'fast' is not valid: "
        "must be a number greater than 0 and at most 10000",
    ]


VALUES = st.recursive(
    st.booleans() | st.integers() | st.floats() | st.text(max_size=10),
    lambda inner: (
        st.lists(inner, max_size=4)
        | st.dictionaries(st.from_regex(r"[a-z]\w{0,8}", fullmatch=True), inner, max_size=3)
    ),
    max_leaves=6,
)


@given(st.sampled_from((*KEYS, *GROUPS)), VALUES)
def test_any_value_is_taken_or_refused_in_lines_that_name_the_file(
    tmp_path_factory: pytest.TempPathFactory, row: Key | Group, value: object
) -> None:
    folder = tmp_path_factory.getbasetemp() / "any"
    write(spoiled(row.path, row.file, value), folder)
    text = str(folder)
    try:
        load_cell(folder / CELL)
    except ConfigurationError as error:
        text = str(error)
    assert all(line.startswith(str(folder)) for line in text.splitlines())
