"""Signals that ask a run to end: it ends between two ticks, never in the middle of one."""

import signal
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

from controllers.control_loop import Subscriber
from controllers.messages import Tick
from drivers.contract.errors import TenonError

_SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGTSTP)
"""Ctrl-C, kill, a lost terminal, and Ctrl-Z: no loop may sleep while its stage moves."""


@contextmanager
def signals_blocked() -> Iterator[None]:
    """Keep back the signals that ask a run to end."""
    before = signal.pthread_sigmask(signal.SIG_BLOCK, _SIGNALS)
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


class InterruptedRunError(TenonError):
    """Somebody asked the run to end; `signal_number` says how."""

    def __init__(self, signal_number: int) -> None:
        super().__init__(f"interrupted by {signal.Signals(signal_number).name}")
        self.signal_number = signal_number


class Interrupt(Subscriber):
    """Notes the first such signal while it is entered, and raises at the end of the running tick.

    Further signals change nothing: the run is ending already. A hangup that is ignored, as under
    nohup, stays ignored. Be the last subscriber of the loop, so that the tick has been recorded.
    """

    def __init__(self) -> None:
        self._noted: int | None = None
        self._has_raised = False
        self._before: dict[int, signal._HANDLER] = {}

    def __enter__(self) -> "Interrupt":
        for number in _SIGNALS:
            before = signal.getsignal(number)
            if not (number is signal.SIGHUP and before is signal.SIG_IGN):
                self._before[number] = before
                signal.signal(number, self._note)
        return self

    def __exit__(self, *_: object) -> None:
        for number, before in self._before.items():
            signal.signal(number, before)

    def on_tick(self, tick: Tick) -> None:
        """Raise InterruptedRunError once after a signal."""
        if self._noted is not None and not self._has_raised:
            self._has_raised = True
            raise InterruptedRunError(self._noted)

    def _note(self, signal_number: int, _: FrameType | None) -> None:
        if self._noted is None:
            self._noted = signal_number
