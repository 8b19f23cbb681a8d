"""Backends are imported only when a cell names them."""

import subprocess
import sys

import pytest

from drivers import backends
from drivers.backends import DeviceClass, device_class, settings_class
from drivers.contract.errors import ConfigurationError
from hil.config import load_cell
from tests.hil.config.cell_files import ROOT
from tests.hil.config.key_table import CELL


def test_nothing_is_imported_with_the_table() -> None:
    code = (
        "import sys, drivers.backends\n"
        "print([m for m in sys.modules if m.endswith('.mock') and m.startswith('drivers.')])"
    )
    result = subprocess.run(
        [sys.executable, "-c", code], cwd=ROOT, capture_output=True, text=True, check=True
    )
    assert result.stdout == "[]\n"


@pytest.mark.parametrize(
    ("device", "name"),
    [
        (DeviceClass.FORCE_SENSOR, "MockForceSensor"),
        (DeviceClass.STAGE, "MockStage"),
        (DeviceClass.ARM, "MockArm"),
        (DeviceClass.GRIPPER, "MockGripper"),
    ],
)
def test_device_class(device: DeviceClass, name: str) -> None:
    assert getattr(device_class(device, "mock"), "__name__", "") == name


def test_missing_package_hurts_only_its_user(monkeypatch: pytest.MonkeyPatch) -> None:
    for module in ("drivers.stage.mock", "drivers.arm.mock"):
        monkeypatch.setitem(sys.modules, module, None)
    with pytest.raises(ConfigurationError) as caught:
        load_cell(ROOT / CELL)
    assert str(caught.value).splitlines() == [
        f"{ROOT / CELL}: {device}.backend = 'mock' is not valid: cannot be imported: "
        f"import of drivers.{device}.mock halted; None in sys.modules"
        for device in ("stage", "arm")
    ]
    assert settings_class(DeviceClass.GRIPPER, "mock").__name__ == "MockGripperSettings"


def test_unknown_backend_lists_the_valid_ones(monkeypatch: pytest.MonkeyPatch) -> None:
    known = backends._BACKENDS[DeviceClass.STAGE]
    monkeypatch.setitem(backends._BACKENDS, DeviceClass.STAGE, {**known, "hexapod": known["mock"]})
    with pytest.raises(ConfigurationError) as caught:
        device_class(DeviceClass.STAGE, "hexapot")
    assert str(caught.value) == (
        "stage.backend = 'hexapot' is not valid: must be one of mock, hexapod"
    )
