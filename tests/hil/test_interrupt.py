"""Which signals end a run, and how often."""

import os
import signal
from collections.abc import Iterator

import pytest

from controllers.messages import Snapshot, Tick, Verdict
from hil.interrupt import Interrupt, InterruptedRunError

ZERO = (0.0,) * 6
TICK = Tick(Snapshot(0, None, ZERO, None, None, None, None), Verdict(0), 0, 0)
NUMBERS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGTSTP)


@pytest.fixture(autouse=True)
def _handlers() -> Iterator[None]:
    before = [signal.getsignal(number) for number in NUMBERS]
    yield
    for number, handler in zip(NUMBERS, before, strict=True):
        signal.signal(number, handler)


@pytest.mark.parametrize("number", NUMBERS)
def test_the_first_signal_ends_the_run_and_the_others_change_nothing(number: int) -> None:
    with Interrupt() as interrupt:
        interrupt.on_tick(TICK)
        os.kill(os.getpid(), number)
        os.kill(os.getpid(), signal.SIGTERM)
        with pytest.raises(InterruptedRunError) as caught:
            interrupt.on_tick(TICK)
        assert caught.value.signal_number == number
        os.kill(os.getpid(), signal.SIGINT)
        interrupt.on_tick(TICK)


def test_afterwards_signals_do_what_they_did_before() -> None:
    def handler(*_: object) -> None:
        pass

    for number in NUMBERS:
        signal.signal(number, handler)
    with Interrupt():
        assert all(signal.getsignal(number) is not handler for number in NUMBERS)
    assert all(signal.getsignal(number) is handler for number in NUMBERS)


def test_under_nohup_a_hangup_stays_ignored() -> None:
    signal.signal(signal.SIGHUP, signal.SIG_IGN)
    with Interrupt() as interrupt:
        os.kill(os.getpid(), signal.SIGHUP)
        interrupt.on_tick(TICK)
        assert signal.getsignal(signal.SIGHUP) is signal.SIG_IGN
