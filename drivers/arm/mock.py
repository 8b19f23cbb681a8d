"""Mock arm over the shared world: straight moves between the tray and the place of insertion.

Drift and vibration where the settings say so. Not modelled: joints, rotation.
"""

import math

from drivers.arm.mock_settings import MockArmSettings
from drivers.contract.clock import Clock
from drivers.contract.errors import CommandRefusedError, DeviceError
from drivers.contract.messages import ArmState, Pose
from drivers.mock_motion import Speeds, StraightMove
from drivers.mock_sway import Sway
from drivers.mock_world import MockWorld


class MockArm:
    """Follows its profile and reports it at the telemetry rate; its encoders see no sway."""

    def __init__(self, settings: MockArmSettings, clock: Clock, world: MockWorld) -> None:
        self._settings = settings
        self._clock = clock
        self._world = world
        self._move = StraightMove.rest(0, world.settings.tray)
        self._effects = settings.effects()
        self._period_ns = round(1e9 / settings.telemetry_rate_Hz)
        self._state: ArmState | None = None
        self._connected = False

    def connect(self) -> None:
        """Take the place in the world."""
        self._connected = True
        self._begin(StraightMove.rest(self._clock.now_ns(), self._move.start))
        if self._effects is not None:
            (generator,) = self._world.generator.spawn(1)
            self._world.set_sway(Sway(self._effects, self._clock.now_ns(), generator))

    def close(self) -> None:
        """Come to rest and let go of the world."""
        if self._connected:
            self.halt()
        self._connected = False

    def state(self) -> ArmState:
        """Return the newest telemetry."""
        self._demand_connection()
        now_ns = self._clock.now_ns()
        stamp_ns = now_ns - now_ns % self._period_ns
        state = self._state
        if state is None or (state.moving and state.stamp_ns != stamp_ns):
            state = ArmState(stamp_ns, self._move.pose(stamp_ns), self._move.is_running(stamp_ns))
        elif state.stamp_ns != stamp_ns:
            state = state._replace(stamp_ns=stamp_ns)
        self._state = state
        return state

    def move_to(self, target: Pose, speed_m_s: float) -> None:
        """Start a straight move; raises CommandRefusedError while one is running."""
        self._demand_connection()
        now_ns = self._clock.now_ns()
        if self._move.is_running(now_ns):
            raise CommandRefusedError("the arm is moving; halt it or wait")
        if not speed_m_s > 0.0:
            raise CommandRefusedError(f"speed {speed_m_s} m/s, valid: more than 0")
        start = self._move.pose(now_ns)
        self._begin(StraightMove.between(now_ns, start, target, self._speeds(speed_m_s)))

    def halt(self) -> None:
        """Brake to rest on the line of the running move."""
        self._demand_connection()
        now_ns = self._clock.now_ns()
        if self._move.is_running(now_ns) and not self._move.is_braking:
            self._begin(self._move.braked(now_ns, self._speeds(1.0)))

    def _begin(self, move: StraightMove) -> None:
        self._move = move
        self._state = None
        self._world.set_arm(move)

    def _speeds(self, linear_m_s: float) -> Speeds:
        return Speeds(linear_m_s, math.inf, self._settings.acceleration_m_s2, math.inf)

    def _demand_connection(self) -> None:
        if not self._connected:
            raise DeviceError("the mock arm is not connected")
