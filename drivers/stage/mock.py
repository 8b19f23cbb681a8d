"""Mock stage over the shared world: trapezoidal moves that can be slowed and stopped on the way.

Not modelled: backlash, hysteresis, minimum step, settling, coupling of the axes' travel.
"""

import math

from drivers.contract.clock import Clock
from drivers.contract.device_settings import StageSettings
from drivers.contract.errors import CommandRefusedError, DeviceError
from drivers.contract.messages import Pose, StageCommand, StageState
from drivers.mock_motion import Speeds, StraightMove
from drivers.mock_world import MockWorld


class MockStageSettings(StageSettings):
    """What the mock's stage is like."""


class MockStage:
    """Follows its profile exactly and reports its state at the telemetry rate.

    Linear and angular speed reach their limits in the same time.
    """

    def __init__(self, settings: MockStageSettings, clock: Clock, world: MockWorld) -> None:
        self._settings = settings
        self._clock = clock
        self._world = world
        self._move = StraightMove.rest(0, world.settings.stage_start)
        self._period_ns = round(1e9 / settings.telemetry_rate_Hz)
        self._state: StageState | None = None
        self._connected = False

    def connect(self) -> None:
        """Take the place in the world."""
        self._connected = True
        self._begin(StraightMove.rest(self._clock.now_ns(), self._move.start))

    def close(self) -> None:
        """Come to rest and let go of the world."""
        if self._connected:
            self.halt()
        self._connected = False

    def state(self) -> StageState:
        """Return the newest telemetry."""
        self._demand_connection()
        now_ns = self._clock.now_ns()
        stamp_ns = now_ns - now_ns % self._period_ns
        state = self._state
        if state is None or (state.moving and state.stamp_ns != stamp_ns):
            pose, velocity, angular_velocity = self._move.state(stamp_ns)
            is_running = self._move.is_running(stamp_ns)
            state = StageState(stamp_ns, pose, velocity, angular_velocity, is_running)
        elif state.stamp_ns != stamp_ns:
            state = state._replace(stamp_ns=stamp_ns)
        self._state = state
        return state

    def move_to(self, target: Pose, speed_m_s: float, angular_speed_rad_s: float) -> StageCommand:
        """Start a straight move; raises CommandRefusedError as the contract says."""
        self._demand_connection()
        now_ns = self._clock.now_ns()
        if self._move.is_running(now_ns):
            raise CommandRefusedError("the stage is moving; halt it or wait")
        for axis, value, travel in zip(
            "xyz", target.position, self._settings.travel_m, strict=True
        ):
            if not abs(value) <= travel:
                raise CommandRefusedError(
                    f"target {axis} = {value * 1e6:.1f} um, valid: +-{travel * 1e6:.1f} um"
                )
        self._check_speeds(speed_m_s, angular_speed_rad_s)
        start = self._move.pose(now_ns)
        speeds = self._speeds(speed_m_s, angular_speed_rad_s)
        self._begin(StraightMove.between(now_ns, start, target, speeds))
        return StageCommand(now_ns, target, speed_m_s, angular_speed_rad_s)

    def slow_to(self, speed_m_s: float, angular_speed_rad_s: float) -> None:
        """Lower the speeds of the running move; at rest there is nothing to do."""
        self._demand_connection()
        self._check_speeds(speed_m_s, angular_speed_rad_s)
        now_ns = self._clock.now_ns()
        if self._move.is_running(now_ns):
            speeds = self._speeds(speed_m_s, angular_speed_rad_s)
            self._begin(self._move.slowed(now_ns, speeds))

    def halt(self) -> None:
        """Brake to rest on the line of the running move."""
        self._demand_connection()
        now_ns = self._clock.now_ns()
        if self._move.is_running(now_ns) and not self._move.is_braking:
            self._begin(self._move.braked(now_ns, self._speeds(1.0, 1.0)))

    def _begin(self, move: StraightMove) -> None:
        self._move = move
        self._state = None
        self._world.set_stage(move)

    def _speeds(self, linear_m_s: float, angular_rad_s: float) -> Speeds:
        s = self._settings
        angular_rad_s2 = s.acceleration_m_s2 * s.angular_speed_rad_s / s.speed_m_s
        return Speeds(linear_m_s, angular_rad_s, s.acceleration_m_s2, angular_rad_s2)

    def _check_speeds(self, linear_m_s: float, angular_rad_s: float) -> None:
        s = self._settings
        if not 0.0 <= linear_m_s <= s.speed_m_s:
            raise CommandRefusedError(
                f"speed {linear_m_s * 1e3:.3f} mm/s, valid: 0 to {s.speed_m_s * 1e3:.3f} mm/s"
            )
        if not 0.0 <= angular_rad_s <= s.angular_speed_rad_s:
            raise CommandRefusedError(
                f"angular speed {math.degrees(angular_rad_s):.3f} deg/s, "
                f"valid: 0 to {math.degrees(s.angular_speed_rad_s):.3f} deg/s"
            )

    def _demand_connection(self) -> None:
        if not self._connected:
            raise DeviceError("the mock stage is not connected")
