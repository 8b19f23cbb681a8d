"""Time as an argument: the same code runs on simulated and on real time."""

import time
from typing import Protocol


class Clock(Protocol):
    """Time in integer nanoseconds."""

    def now_ns(self) -> int:
        """Return the present time [ns]; never decreases."""

    def sleep_until_ns(self, time_ns: int) -> None:
        """Return at `time_ns` or, if that has passed, at once."""


class ManualClock:
    """Simulated time: it passes only when somebody sleeps, so a run is exactly repeatable."""

    def __init__(self, start_ns: int = 0) -> None:
        self._now_ns = start_ns

    def now_ns(self) -> int:
        return self._now_ns

    def sleep_until_ns(self, time_ns: int) -> None:
        self._now_ns = max(self._now_ns, time_ns)


class SystemClock:
    """Real time: counts since the Unix epoch, but never jumps when the system time is set."""

    def __init__(self) -> None:
        self._epoch_ns = time.time_ns() - time.monotonic_ns()

    def now_ns(self) -> int:
        return self._epoch_ns + time.monotonic_ns()

    def sleep_until_ns(self, time_ns: int) -> None:
        remaining_ns = time_ns - self.now_ns()
        if remaining_ns > 0:
            time.sleep(remaining_ns * 1e-9)
