"""Ctrl-C and SIGTERM: the run ends between two ticks, never in the middle of one."""

import signal
from types import FrameType

from controllers.control_loop import Subscriber
from controllers.messages import Tick
from drivers.contract.errors import TenonError


class InterruptedRunError(TenonError):
    """Somebody asked the run to end; `signal_number` says how."""

    def __init__(self, signal_number: int) -> None:
        super().__init__(f"interrupted by {signal.Signals(signal_number).name}")
        self.signal_number = signal_number


class Interrupt(Subscriber):
    """Notes SIGINT and SIGTERM while it is entered, and raises at the end of the running tick.

    Be the last subscriber of the loop, so that the tick has been recorded when it raises.
    """

    def __init__(self) -> None:
        self._signal_number: int | None = None

    def __enter__(self) -> "Interrupt":
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, self._note)
        return self

    def __exit__(self, *_: object) -> None:
        signal.signal(signal.SIGINT, signal.default_int_handler)
        signal.signal(signal.SIGTERM, signal.SIG_DFL)

    def on_tick(self, tick: Tick) -> None:
        """Raise InterruptedRunError once after a signal."""
        number, self._signal_number = self._signal_number, None
        if number is not None:
            raise InterruptedRunError(number)

    def _note(self, signal_number: int, _: FrameType | None) -> None:
        self._signal_number = signal_number
