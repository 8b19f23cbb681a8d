"""Mock force sensor over the shared world, with the errors of a real one.

Bias, white noise, quantisation and saturation are always there; drift, crosstalk and latency where
the settings say so. Not modelled: lost samples, a bandwidth below half the sample rate.
"""

import math

import numpy as np

from drivers.contract.clock import Clock
from drivers.contract.errors import DeviceError, DeviceTimeoutError
from drivers.contract.messages import ForceSample, SensorStatus, Wrench
from drivers.force_sensor.mock_settings import MockForceSensorSettings
from drivers.mock_world import MockWorld
from simulator.effects.sensor import Recording, record, warmed_up

_BLOCK = 32
"""Samples made at a time; a command to an actuator discards those not yet due."""


class MockForceSensor:
    """Measures the world's wrench at a fixed rate from the moment it is connected."""

    def __init__(self, settings: MockForceSensorSettings, clock: Clock, world: MockWorld) -> None:
        self._settings = settings
        self._clock = clock
        self._world = world
        self._effects = settings.effects()
        self._period_ns = round(1e9 / settings.rate_Hz)
        self._start_ns: int | None = None
        self._sequence = 0
        self._recording: Recording | None = None
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
        step = np.repeat([s.force_resolution_N, s.torque_resolution_Nm], 3)
        fx, fy, fz, tx, ty, tz = np.hypot(self._effects.noise_std, step / math.sqrt(12.0)).tolist()
        return (fx, fy, fz, tx, ty, tz)

    def connect(self) -> None:
        """Start the stream: the first sample is due one period from now."""
        self._start_ns = self._clock.now_ns()
        self._sequence = 0
        self._recording, self._block = None, []

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
            self._recording = self._recorded(stamp_ns, index)
            saturated = np.logical_or.reduce(self._recording.saturated, axis=-1).tolist()
            self._block = [
                ((fx, fy, fz, tx, ty, tz), full)
                for (fx, fy, fz, tx, ty, tz), full in zip(
                    self._recording.readings.tolist(), saturated, strict=True
                )
            ]
            self._block_start, self._block_version, index = sequence, self._world.version, 0
        return self._block[index]

    def _recorded(self, stamp_ns: int, read: int) -> Recording:
        """The block from `stamp_ns` on, after the first `read` samples of the block before."""
        effects, draw = self._effects, self._world.generator.standard_normal
        times = range(stamp_ns, stamp_ns + _BLOCK * self._period_ns, self._period_ns)
        loads = self._world.wrench(times, self._settings.origin_m)
        if self._recording is None:
            state = warmed_up(effects, loads[0], draw(effects.draws_at_start))
        else:
            state = self._recording.after(read)
        return record(effects, loads, state, draw((_BLOCK, effects.draws_per_sample)))
