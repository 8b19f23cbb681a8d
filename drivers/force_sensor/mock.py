"""Mock force sensor over the shared world: bias, white noise, quantisation, saturation.

Not modelled: drift, crosstalk, latency, lost samples.
"""

import math
from typing import Annotated

from annotated_types import Ge, Gt, Le
from pydantic import Field

from drivers.contract.clock import Clock
from drivers.contract.device_settings import ForceSensorSettings
from drivers.contract.errors import DeviceError, DeviceTimeoutError
from drivers.contract.messages import ForceSample, SensorStatus, Wrench
from drivers.contract.settings import MICRO, MILLI
from drivers.mock_world import MockWorld
from simulator.sensor import SensorModel, measure

_Bias = Annotated[float, Ge(-10_000), Le(10_000)]
_Place = Annotated[float, Ge(-1_000_000), Le(1_000_000)]


class MockForceSensorSettings(ForceSensorSettings):
    """What the mock's sensor is like."""

    force_noise_N: Annotated[float, Gt(0), Le(1_000), MILLI] = Field(alias="force_noise_mN")
    """Standard deviation of one sample."""
    torque_noise_Nm: Annotated[float, Gt(0), Le(100_000), MICRO] = Field(alias="torque_noise_uNm")
    """Standard deviation of one sample."""
    bias_N: Annotated[tuple[_Bias, _Bias, _Bias], MILLI] = Field(alias="bias_mN")
    """What the unloaded sensor reads."""
    force_resolution_N: Annotated[float, Gt(0), Le(1_000), MILLI] = Field(
        alias="force_resolution_mN"
    )
    torque_resolution_Nm: Annotated[float, Gt(0), Le(100_000), MICRO] = Field(
        alias="torque_resolution_uNm"
    )
    force_range_N: Annotated[float, Gt(0), Le(1_000_000), MILLI] = Field(alias="force_range_mN")
    """Largest force, to either side, before an axis saturates."""
    torque_range_Nm: Annotated[float, Gt(0), Le(100_000_000), MICRO] = Field(
        alias="torque_range_uNm"
    )
    """Largest torque, to either side, before an axis saturates."""
    origin_m: Annotated[tuple[_Place, _Place, _Place], MICRO] = Field(alias="origin_um")
    """Place of the sensor in frame M; torques are taken about it."""


_BLOCK = 32
"""Samples made at a time; a command to an actuator discards those not yet due."""


class MockForceSensor:
    """Measures the world's wrench at a fixed rate from the moment it is connected."""

    def __init__(self, settings: MockForceSensorSettings, clock: Clock, world: MockWorld) -> None:
        self._settings = settings
        self._clock = clock
        self._world = world
        noise, fine, far = (
            (settings.force_noise_N, settings.torque_noise_Nm),
            (settings.force_resolution_N, settings.torque_resolution_Nm),
            (settings.force_range_N, settings.torque_range_Nm),
        )
        self._model = SensorModel(
            noise_std=noise,
            bias=(*settings.bias_N, 0.0, 0.0, 0.0),
            resolution=fine,
            range=far,
        )
        self._period_ns = round(1e9 / settings.rate_Hz)
        self._start_ns: int | None = None
        self._sequence = 0
        self._block: list[tuple[Wrench, bool]] = []
        self._block_start = 0
        self._block_version = -1

    @property
    def rate_Hz(self) -> float:
        return self._settings.rate_Hz

    @property
    def noise_std(self) -> Wrench:
        """Standard deviation of one sample, white noise and quantisation together [N, N*m]."""
        s = self._settings
        force = math.hypot(s.force_noise_N, s.force_resolution_N / math.sqrt(12.0))
        torque = math.hypot(s.torque_noise_Nm, s.torque_resolution_Nm / math.sqrt(12.0))
        return (force, force, force, torque, torque, torque)

    def connect(self) -> None:
        """Start the stream: the first sample is due one period from now."""
        self._start_ns = self._clock.now_ns()
        self._sequence = 0
        self._block = []

    def close(self) -> None:
        """End the stream."""
        self._start_ns = None

    def read(self, timeout_s: float) -> ForceSample:
        """Return the oldest sample not yet read; raises DeviceTimeoutError after `timeout_s`."""
        if self._start_ns is None:
            raise DeviceError("the mock force sensor is not connected")
        stamp_ns = self._start_ns + (self._sequence + 1) * self._period_ns
        deadline_ns = self._clock.now_ns() + round(timeout_s * 1e9)
        if stamp_ns > deadline_ns:
            self._clock.sleep_until_ns(deadline_ns)
            raise DeviceTimeoutError(f"no force sample within {timeout_s * 1e3:.1f} ms")
        self._clock.sleep_until_ns(stamp_ns)
        wrench, saturated = self._measured(self._sequence, stamp_ns)
        status = SensorStatus.SATURATED if saturated else SensorStatus.OK
        sample = ForceSample(stamp_ns, self._clock.now_ns(), self._sequence, wrench, status)
        self._sequence += 1
        return sample

    def _measured(self, sequence: int, stamp_ns: int) -> tuple[Wrench, bool]:
        index = sequence - self._block_start
        if index >= len(self._block) or self._block_version != self._world.version:
            times = range(stamp_ns, stamp_ns + _BLOCK * self._period_ns, self._period_ns)
            true = self._world.wrench(times, self._settings.origin_m)
            wrenches, saturated = measure(true, self._model, self._world.generator)
            self._block = [
                ((fx, fy, fz, tx, ty, tz), bool(full))
                for (fx, fy, fz, tx, ty, tz), full in zip(
                    wrenches.tolist(), saturated.tolist(), strict=True
                )
            ]
            self._block_start, self._block_version, index = sequence, self._world.version, 0
        return self._block[index]
