"""Mock vacuum gripper over the shared world: vacuum builds up after the valve opens on a part.

Not modelled: leaks, slip, a part lost on the way.
"""

from typing import Annotated

from annotated_types import Gt, Le
from pydantic import Field

from drivers.contract.clock import Clock
from drivers.contract.device_settings import TelemetrySettings
from drivers.contract.errors import DeviceError
from drivers.contract.messages import GripperState
from drivers.contract.settings import MILLI
from drivers.mock_world import MockWorld


class MockGripperSettings(TelemetrySettings):
    """What the mock's gripper is like."""

    vacuum_rise_s: Annotated[float, Gt(0), Le(10_000), MILLI] = Field(alias="vacuum_rise_ms")
    """From the valve opening to the switch reporting a part held."""


class MockGripper:
    """Picks a new part when its valve opens at the tray."""

    def __init__(self, settings: MockGripperSettings, clock: Clock, world: MockWorld) -> None:
        self._settings = settings
        self._clock = clock
        self._world = world
        self._period_ns = round(1e9 / settings.telemetry_rate_Hz)
        self._connected = False
        self._valve_open = False
        self._held_from_ns: int | None = None
        self._state: GripperState | None = None

    def connect(self) -> None:
        """Make the digital input and output available; the valve stays closed."""
        self._connected = True

    def close(self) -> None:
        """Let go of the input and output; the valve stays as it is, so a held part stays held."""
        self._connected = False

    def state(self) -> GripperState:
        """Return valve and vacuum switch as of the newest telemetry."""
        self._demand_connection()
        now_ns = self._clock.now_ns()
        stamp_ns = now_ns - now_ns % self._period_ns
        if self._state is None or self._state.stamp_ns != stamp_ns:
            held = self._held_from_ns is not None and stamp_ns >= self._held_from_ns
            self._state = GripperState(stamp_ns, self._valve_open, held)
        return self._state

    def set_valve(self, is_open: bool) -> None:
        """Open the valve to pick what lies at the tray, close it to let go."""
        self._demand_connection()
        if is_open == self._valve_open:
            return
        self._valve_open = is_open
        self._state = None
        now_ns = self._clock.now_ns()
        if is_open and self._world.pick(now_ns):
            self._held_from_ns = now_ns + round(self._settings.vacuum_rise_s * 1e9)
        elif not is_open:
            self._world.let_go()
            self._held_from_ns = None

    def _demand_connection(self) -> None:
        if not self._connected:
            raise DeviceError("the mock gripper is not connected")
