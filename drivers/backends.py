"""The backends of each device class by name. A backend is imported only when a cell names it."""

from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum
from importlib import import_module
from typing import cast

from drivers.contract.errors import ConfigurationError
from drivers.contract.interfaces import Device
from drivers.contract.settings import Settings


class DeviceClass(StrEnum):
    """The devices of a cell, named as in its file."""

    FORCE_SENSOR = "force_sensor"
    STAGE = "stage"
    ARM = "arm"
    GRIPPER = "gripper"


@dataclass(frozen=True, slots=True)
class _Backend:
    module: str
    settings: str
    device: str


_BACKENDS = {
    DeviceClass.FORCE_SENSOR: {
        "mock": _Backend("drivers.force_sensor.mock", "MockForceSensorSettings", "MockForceSensor"),
    },
    DeviceClass.STAGE: {
        "mock": _Backend("drivers.stage.mock", "MockStageSettings", "MockStage"),
    },
    DeviceClass.ARM: {
        "mock": _Backend("drivers.arm.mock", "MockArmSettings", "MockArm"),
    },
    DeviceClass.GRIPPER: {
        "mock": _Backend("drivers.gripper.mock", "MockGripperSettings", "MockGripper"),
    },
}


def settings_class(device: DeviceClass, backend: str) -> type[Settings]:
    """Import a backend and return the class of its settings.

    Raises ConfigurationError if there is no such backend or a package that it needs is missing.
    """
    return cast(type[Settings], _attribute(device, backend, _find(device, backend).settings))


def device_class(device: DeviceClass, backend: str) -> Callable[..., Device]:
    """Import a backend and return the class of its device; raises as `settings_class` does."""
    found = _attribute(device, backend, _find(device, backend).device)
    return cast(Callable[..., Device], found)


def _find(device: DeviceClass, backend: str) -> _Backend:
    backends = _BACKENDS[device]
    if backend not in backends:
        raise _refusal(device, backend, f"must be one of {', '.join(backends)}")
    return backends[backend]


def _attribute(device: DeviceClass, backend: str, name: str) -> object:
    try:
        module = import_module(_find(device, backend).module)
    except ImportError as error:
        raise _refusal(device, backend, f"cannot be imported: {error}") from error
    return getattr(module, name)


def _refusal(device: DeviceClass, backend: str, reason: str) -> ConfigurationError:
    return ConfigurationError(f"{device}.backend = {backend!r} is not valid: {reason}")
