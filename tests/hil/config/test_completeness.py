"""No key without a row in the table of bad input and a line in the reference."""

import re
from collections.abc import Iterator
from typing import get_args, get_origin

import pytest
from pydantic import BaseModel

from controllers.limits import Limits
from controllers.settings import LookAheadControllerSettings, ProportionalSettings
from drivers.arm.mock import MockArmSettings
from drivers.backends import DeviceClass, settings_class
from drivers.force_sensor.mock import MockForceSensorSettings
from drivers.gripper.mock import MockGripperSettings
from drivers.stage.mock import MockStageSettings
from hil.config.cell import CellSettings, PolicySettings
from learning.part import PartSettings
from tests.hil.config.cell_files import ROOT
from tests.hil.config.key_table import CELL, GROUPS, KEYS, LIMITS, PART

DEVICES: dict[str, type[BaseModel]] = {
    "force_sensor": MockForceSensorSettings,
    "stage": MockStageSettings,
    "arm": MockArmSettings,
    "gripper": MockGripperSettings,
}


CONTROLLERS: dict[str, type[BaseModel]] = {
    "controllers.expert": ProportionalSettings,
    "controllers.look_ahead": LookAheadControllerSettings,
    "controllers.skill": PolicySettings,
}


def model_in(annotation: object) -> type[BaseModel] | None:
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return annotation
    return next(filter(None, map(model_in, get_args(annotation))), None)


def paths(model: type[BaseModel], prefix: str = "") -> Iterator[str]:
    for name, field in model.model_fields.items():
        path = f"{prefix}{field.alias or name}"
        yield path
        inner = model_in(field.annotation)
        if inner is None:
            continue
        if get_origin(field.annotation) is tuple:
            path += "[1]"
            yield path
        elif get_origin(field.annotation) is dict:
            continue  # whose entries are of several kinds
        yield from paths(inner, f"{path}.")


def every_path() -> Iterator[tuple[str, str]]:
    yield from ((LIMITS, path) for path in paths(Limits))
    yield from ((PART, path) for path in paths(PartSettings))
    yield from ((CELL, path) for path in paths(CellSettings))
    for device, model in DEVICES.items():
        yield from ((CELL, path) for path in paths(model, f"{device}."))
    for controller, kind in CONTROLLERS.items():
        yield CELL, controller
        yield from ((CELL, path) for path in paths(kind, f"{controller}."))


def test_every_key_has_a_row() -> None:
    rows = [(row.file, row.path) for row in (*KEYS, *GROUPS)]
    assert len(rows) == len(set(rows))
    assert set(rows) == set(every_path())


def test_every_number_has_both_bounds_but_the_limits_of_a_part() -> None:
    open_ended = {row.path for row in KEYS if row.unit and (row.low is None or row.high is None)}
    assert open_ended == {row.path for row in KEYS if row.file == PART and "limits." in row.path}


@pytest.mark.parametrize("device", list(DeviceClass))
def test_the_table_of_backends_leads_to_the_settings(device: DeviceClass) -> None:
    assert settings_class(device, "mock") is DEVICES[device]


def reference() -> dict[tuple[str, str, str], tuple[str, str]]:
    """Unit and range of each key of the reference, under its file and group."""
    rows: dict[tuple[str, str, str], tuple[str, str]] = {}
    file = group = ""
    text = (ROOT / "docs/reference/configuration.md").read_text(encoding="utf-8")
    for line in text.splitlines():
        if heading := re.fullmatch(r"(##|###) `(.+)`", line):
            level, name = heading.groups()
            file, group = (name, "") if level == "##" else (file, name)
        elif row := re.fullmatch(r"\| `(\w+)` \| (.*?) ?\| (.+?) \| .+ \|", line):
            key, unit, valid = row.groups()
            place = (file, group, key)
            assert place not in rows
            rows[place] = (unit, valid.strip("`"))
    return rows


def test_the_reference_states_unit_and_range_of_every_key_and_no_other() -> None:
    files = {LIMITS: "limits.yaml", PART: "parts/*.yaml", CELL: "mock_cell.yaml"}
    stated = {}
    for row in KEYS:
        *groups, key = re.findall(r"[a-z]\w*", row.path)
        valid = (
            row.range or {"kind": "proportional` or `skill` or `look_ahead", "backend": "mock"}[key]
        )
        group = ".".join(name for name in groups if name not in ("expert", "look_ahead", "skill"))
        group = "skill" if groups == ["skill"] else group
        stated[files[row.file], group, key] = (row.unit, valid)
    assert reference() == stated
