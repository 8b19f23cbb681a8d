"""Every key of a randomisation file, with what it accepts, and a file that states them all."""

import copy
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import pytest

from drivers.contract.errors import ConfigurationError
from learning.randomisation import load_randomisation
from simulator.randomisation.plants import PlantDistribution
from tests.hil.config.cell_files import flow, steps

FILE = "plants.yaml"
KINDS = "constant, uniform, log_uniform, truncated_normal, choice"


class Spread(NamedTuple):
    """A key that holds a distribution; `low` and `high` lie just outside of its range."""

    path: str
    range: str
    low: float
    high: float
    unit: str = ""


class Number(NamedTuple):
    """A key that holds a plain number."""

    path: str
    range: str
    low: float
    high: float
    unit: str


SIZE = "greater than 0 and at most 100000"
LENGTH, ANGLE = "at least 0 and at most 1000", "at least 0 and at most 1"
FORCE_DENSITY = "at least 0 and at most 100000"
TORQUE_DENSITY = "at least 0 and at most 10000000"
CLEARANCE = "at least -100 and at most 1000"
SHIFT, TURN = "at least 0 and at most 100", "at least 0 and at most 1000"
HOLDING_FORCE = "greater than 0 and at most 10000"
HOLDING_TORQUE = "greater than 0 and at most 1000000"
ROUNDING = "shaft.leading_rounding_um"

SPREADS = (
    Spread("contact.stiffness_mN_um", "greater than 0 and at most 1000", 0, 1001, "mN/um"),
    Spread("contact.friction", "at least 0 and at most 2", -0.1, 2.1),
    Spread("contact.tangential_stiffness_ratio", "greater than 0 and at most 2", 0, 2.1),
    Spread("shaft.diameter_um", SIZE, 0, 100_001, "um"),
    Spread("shaft.length_um", SIZE, 0, 100_001, "um"),
    Spread("shaft.leading_chamfer.width_um", SIZE, 0, 100_001, "um"),
    Spread("shaft.leading_chamfer.height_um", SIZE, 0, 100_001, "um"),
    Spread(ROUNDING, SIZE, 0, 100_001, "um"),
    Spread("shaft.trailing_chamfer.width_um", SIZE, 0, 100_001, "um"),
    Spread("shaft.trailing_chamfer.height_um", SIZE, 0, 100_001, "um"),
    Spread("common_clearance_um", CLEARANCE, -101, 1001, "um"),
    Spread("holes[1].clearance_um", CLEARANCE, -101, 1001, "um"),
    Spread("holes[1].thickness_um", SIZE, 0, 100_001, "um"),
    Spread("holes[1].gap_um", SIZE, 0, 100_001, "um"),
    Spread("holes[1].entry_chamfer.width_um", SIZE, 0, 100_001, "um"),
    Spread("holes[1].entry_chamfer.height_um", SIZE, 0, 100_001, "um"),
    Spread("alignment.position_error_um", LENGTH, -1, 1001, "um"),
    Spread("alignment.tilt_error_deg", "at least 0 and at most 5", -0.1, 5.1, "deg"),
    Spread("force_sensor.force_noise_uN_rtHz", FORCE_DENSITY, -1, 1e6, "uN/sqrt(Hz)"),
    Spread("force_sensor.torque_noise_nNm_rtHz", TORQUE_DENSITY, -1, 1e8, "nN m/sqrt(Hz)"),
    Spread("force_sensor.force_bias_mN", "at least -10000 and at most 10000", -1e5, 1e5, "mN"),
    Spread(
        "force_sensor.torque_bias_uNm", "at least -1000000 and at most 1000000", -1e7, 1e7, "uN m"
    ),
    Spread("force_sensor.crosstalk_percent", "at least -20 and at most 20", -21, 21, "%"),
    Spread("force_sensor.drift.force_uN_rtHz", FORCE_DENSITY, -1, 1e6, "uN/sqrt(Hz)"),
    Spread("force_sensor.drift.torque_nNm_rtHz", TORQUE_DENSITY, -1, 1e8, "nN m/sqrt(Hz)"),
    Spread("stage.position_noise_um", LENGTH, -1, 1001, "um"),
    Spread("stage.minimum_step_um", LENGTH, -1, 1001, "um"),
    Spread("stage.minimum_step_deg", ANGLE, -1, 1.1, "deg"),
    Spread("stage.backlash_um", LENGTH, -1, 1001, "um"),
    Spread("stage.backlash_deg", ANGLE, -1, 1.1, "deg"),
    Spread("stage.hysteresis_gap_um", LENGTH, -1, 1001, "um"),
    Spread("stage.hysteresis_gap_deg", ANGLE, -1, 1.1, "deg"),
    Spread("stage.hysteresis_weight", ANGLE, -0.1, 1.1),
    Spread("stage.repeatability_um", LENGTH, -1, 1001, "um"),
    Spread("stage.repeatability_deg", ANGLE, -1, 1.1, "deg"),
    Spread("arm.thermal[1].end_um", "at least -1000 and at most 1000", -1001, 1001, "um"),
    Spread("arm.thermal[1].end_deg", "at least -1 and at most 1", -1.1, 1.1, "deg"),
    Spread("arm.vibration[1].rms_um", LENGTH, -1, 1001, "um"),
    Spread("arm.vibration[1].rms_deg", ANGLE, -1, 1.1, "deg"),
    Spread("arm.walk_um_rts", LENGTH, -1, 1001, "um/sqrt(s)"),
    Spread("arm.walk_deg_rts", ANGLE, -1, 1.1, "deg/sqrt(s)"),
    *(Spread(f"holder.compliance_{axis}_um_mN", SHIFT, -1, 101, "um/mN") for axis in "xyz"),
    *(
        Spread(f"holder.compliance_{axis}_urad_uNm", TURN, -1, 1001, "urad/(uN m)")
        for axis in ("rx", "ry")
    ),
    *(Spread(f"holder.holding_force_{axis}_mN", HOLDING_FORCE, 0, 1e5, "mN") for axis in "xyz"),
    *(
        Spread(f"holder.holding_torque_{axis}_uNm", HOLDING_TORQUE, 0, 1e7, "uN m")
        for axis in ("rx", "ry")
    ),
)
BAND = "force_sensor.drift"
NUMBERS = (
    Number("force_sensor.rate_Hz", "at least 10 and at most 20000", 9, 20_001, "Hz"),
    Number("force_sensor.latency_ms", "at least 0 and at most 100", -1, 101, "ms"),
    Number("force_sensor.force_resolution_mN", "at least 0 and at most 1000", -1, 1001, "mN"),
    Number("force_sensor.torque_resolution_uNm", FORCE_DENSITY, -1, 1e6, "uN m"),
    Number("force_sensor.force_range_mN", HOLDING_TORQUE, 0, 1e7, "mN"),
    Number("force_sensor.torque_range_uNm", "greater than 0 and at most 100000000", 0, 1e9, "uN m"),
    Number(f"{BAND}.lowest_frequency_Hz", "at least 1e-06 and at most 100", 0, 101, "Hz"),
    Number(f"{BAND}.highest_frequency_Hz", "at least 1e-06 and at most 1000", 0, 1001, "Hz"),
    Number("stage.settling_time_constant_ms", "at least 0 and at most 10000", -1, 10_001, "ms"),
    Number("arm.thermal[1].time_constant_s", SIZE, 0, 100_001, "s"),
    Number("arm.vibration[1].frequency_Hz", "greater than 0 and at most 1000", 0, 1001, "Hz"),
    Number("arm.vibration[1].damping_ratio", "greater than 0 and less than 1", 0, 1, ""),
    Number("holder.pivot_um[1]", "at least -1000000 and at most 1000000", -1e7, 1e7, "um"),
)
REQUIRED = (
    "contact.stiffness_mN_um",
    "contact.friction",
    "shaft.diameter_um",
    "shaft.length_um",
    *(s.path for s in SPREADS if "_chamfer." in s.path),
    "holes[1].clearance_um",
    "holes[1].thickness_um",
    "holes[1].gap_um",
    "alignment.position_error_um",
    "alignment.tilt_error_deg",
    "force_sensor.rate_Hz",
    "force_sensor.drift.force_uN_rtHz",
    "force_sensor.drift.torque_nNm_rtHz",
    "force_sensor.drift.lowest_frequency_Hz",
    "force_sensor.drift.highest_frequency_Hz",
    "arm.thermal[1].end_um",
    "arm.thermal[1].time_constant_s",
    "arm.vibration[1].rms_um",
    "arm.vibration[1].frequency_Hz",
    "arm.vibration[1].damping_ratio",
)

_VALUES = {
    "shaft.diameter_um": 1000,
    "shaft.length_um": 4000,
    "holes[1].thickness_um": 500,
    "holder.pivot_um[1]": 1500,
    "force_sensor.force_range_mN": 2000,
    "force_sensor.torque_range_uNm": 4000,
    "force_sensor.rate_Hz": 1000,
    "force_sensor.drift.lowest_frequency_Hz": 0.001,
    "force_sensor.drift.highest_frequency_Hz": 0.4,
}


def full(path: str = "") -> dict[str, Any]:
    """A file with every key; lists of groups have two, and both state every key but a first gap.

    The leading end has a chamfer, or is rounded where `path` is the key of the rounding.
    """
    file: dict[str, Any] = {
        "holes": [{}, {}],
        "arm": {"thermal": [{}, {}], "vibration": [{}, {}]},
        "holder": {"pivot_um": [0, 0, 0]},
    }
    for row in (*SPREADS, *NUMBERS):
        value = _VALUES.get(row.path, 0.5)
        held = {"constant": value} if isinstance(row, Spread) else value
        for place in {row.path, row.path.replace("[1]", "[0]")} - {"holes[0].gap_um"}:
            put(file, place, copy.copy(held))
    drop(file, "shaft.leading_chamfer" if path == ROUNDING else ROUNDING)
    return file


def put(file: dict[str, Any], path: str, value: object) -> None:
    """Set the value at a path, making the groups that lead to it."""
    *before, last = steps(path)
    group: Any = file
    for step in before:
        group = group[step] if isinstance(step, int) else group.setdefault(step, {})
    group[last] = value


def drop(file: dict[str, Any], path: str) -> object:
    """Take the value at a path out of the file."""
    *before, last = steps(path)
    group: Any = file
    for step in before:
        group = group[step]
    return group.pop(last)


Load = Callable[[dict[str, Any]], PlantDistribution]
Refuse = Callable[[dict[str, Any]], str]


@pytest.fixture
def load(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Load:
    """Loads a file from a folder of its own."""
    monkeypatch.chdir(tmp_path)

    def load_file(file: dict[str, Any]) -> PlantDistribution:
        Path(FILE).write_text(flow(file), encoding="utf-8")
        return load_randomisation(Path(FILE))

    return load_file


@pytest.fixture
def refuse(load: Load) -> Refuse:
    """Returns the text with which a file is refused."""

    def refuse_file(file: dict[str, Any]) -> str:
        with pytest.raises(ConfigurationError) as caught:
            load(file)
        return str(caught.value)

    return refuse_file
