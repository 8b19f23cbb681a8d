"""The files of a cell as data that a test can spoil."""

import copy
import json
import math
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import yaml

from drivers.contract.errors import ConfigurationError
from hil.config import CellConfig, load_cell
from tests.hil.config.key_table import CELL, LIMITS, PART

ROOT = Path(__file__).parents[3]
PART_LIMITS = {
    "speed_limit_mm_s": 5,
    "angular_speed_limit_deg_s": 1,
    "step_box_um": [20, 20, 60],
    "force_limit_mN": [70, 100, 1000],
    "force_rate_limit_N_s": 40,
    "gentle_force_mN": 44,
    "impulse_limit_mN_s": 10,
}
Files = dict[str, dict[str, Any]]

_SHIPPED: Files = {
    file: yaml.safe_load((ROOT / file).read_text(encoding="utf-8")) for file in (LIMITS, PART, CELL)
}


class Twice(dict[str, Any]):
    """A mapping whose key `twice` is written a second time."""

    twice: str


def shipped() -> Files:
    """The shipped files, the part's with every limit that it may state."""
    files = copy.deepcopy(_SHIPPED)
    files[PART]["limits"] = copy.deepcopy(PART_LIMITS)
    return files


def steps(path: str) -> list[str | int]:
    """`holes[1].gap_um` -> ["holes", 1, "gap_um"]."""
    return [int(s) if s.isdigit() else s for s in re.findall(r"\w+", path)]


def parent(files: Files, file: str, path: str) -> tuple[Any, Any]:
    """The mapping or list that holds `path`, and its last step."""
    *before, last = steps(path)
    group: Any = files[file]
    for step in before:
        group = group[step]
    return group, last


def flow(value: object) -> str:
    """One line of YAML."""
    if isinstance(value, dict):
        entries = [f"{json.dumps(k)}: {flow(v)}" for k, v in value.items()]
        if isinstance(value, Twice):
            entries.append(f"{json.dumps(value.twice)}: {flow(value[value.twice])}")
        return f"{{{', '.join(entries)}}}"
    if isinstance(value, list):
        return f"[{', '.join(flow(v) for v in value)}]"
    if isinstance(value, float) and not math.isfinite(value):
        return str(value).replace("inf", ".inf").replace("nan", ".nan")
    return json.dumps(value)


def write(files: Files, folder: Path) -> None:
    """Write the files below `folder`, each on one line."""
    for file, values in files.items():
        (folder / file).parent.mkdir(parents=True, exist_ok=True)
        (folder / file).write_text(flow(values), encoding="utf-8")


Load = Callable[[Files], CellConfig]
Refuse = Callable[[Files], str]


@pytest.fixture
def load(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Load:
    """Loads files from a folder of their own."""
    monkeypatch.chdir(tmp_path)

    def load_files(files: Files) -> CellConfig:
        write(files, tmp_path)
        return load_cell(Path(CELL))

    return load_files


@pytest.fixture
def refuse(load: Load) -> Refuse:
    """Returns the text with which files are refused."""

    def refuse_files(files: Files) -> str:
        with pytest.raises(ConfigurationError) as caught:
            load(files)
        return str(caught.value)

    return refuse_files
