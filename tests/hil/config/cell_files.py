"""The files of a cell as data that a test can spoil."""

import copy
import functools
import json
import math
import re
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import yaml

from drivers.contract.errors import ConfigurationError
from hil.config import CellConfig, load_cell
from learning.policy.file import save_policy
from tests.hil.config.key_table import CELL, LIMITS, PART
from tests.learning.policy.policies import zero_policy

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
EFFECTS: dict[str, dict[str, Any]] = {
    "force_sensor": {
        "latency_ms": 2,
        "drift": {
            "force_uN_rtHz": 100,
            "torque_nNm_rtHz": 500,
            "lowest_frequency_Hz": 0.001,
            "highest_frequency_Hz": 0.4,
        },
        "crosstalk": {
            "fx_percent": [0, 0.5, -1, 0, 2, 0],
            "fy_percent": [0.5, 0, -1, -2, 0, 0],
            "fz_percent": [1, 1, 0.3, 0, 0, 0],
            "tx_percent": [0, 0, 0, 0, 0, 1],
            "ty_percent": [0, 0, 0, 0, 0, 1],
            "tz_percent": [0, 0, 0, 1, 1, 0],
        },
    },
    "stage": {
        "minimum_step_um": 0.1,
        "minimum_step_deg": 0.0001,
        "backlash_um": 0.5,
        "backlash_deg": 0.0005,
        "hysteresis_gap_um": 0.4,
        "hysteresis_gap_deg": 0.0004,
        "hysteresis_weight": 0.3,
        "repeatability_um": 0.2,
        "repeatability_deg": 0.0002,
        "settling_time_constant_ms": 5,
    },
    "arm": {
        "walk_um_rts": 0.1,
        "walk_deg_rts": 0.0001,
        "thermal": [
            {"end_um": [5, -5, 1], "end_deg": [0.001, 0, 0], "time_constant_s": 600},
            {"end_um": [1, 1, 1], "end_deg": [0, 0.001, 0], "time_constant_s": 60},
        ],
        "vibration": [
            {"frequency_Hz": f, "damping_ratio": 0.02, "rms_um": [1, 1, 0], "rms_deg": [0, 0, 0]}
            for f in (12, 31)
        ],
    },
}
"""What a mock can do besides what the shipped cell lets it do."""
POLICY = "policies/zero.safetensors"
Files = dict[str, dict[str, Any]]

_SHIPPED: Files = {
    file: yaml.safe_load((ROOT / file).read_text(encoding="utf-8")) for file in (LIMITS, PART, CELL)
}


class Twice(dict[str, Any]):
    """A mapping whose key `twice` is written a second time."""

    twice: str


def shipped() -> Files:
    """The shipped files with every key that they may state."""
    files = copy.deepcopy(_SHIPPED)
    files[PART]["limits"] = copy.deepcopy(PART_LIMITS)
    for device, keys in EFFECTS.items():
        files[CELL][device].update(copy.deepcopy(keys))
    files[CELL]["controllers"]["skill"] = {"kind": "skill", "policy": f"../{POLICY}"}
    del files[CELL]["controllers"]["extended"]  # the same kind again, with a policy of its own
    return files


@functools.cache
def policy_file() -> bytes:
    """What the file of a policy holds whose residual is zero."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "zero.safetensors"
        save_policy(zero_policy(), path, {})
        return path.read_bytes()


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
    """Write the files below `folder`, each on one line, and the policy that they name."""
    (folder / POLICY).parent.mkdir(parents=True, exist_ok=True)
    (folder / POLICY).write_bytes(policy_file())
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
