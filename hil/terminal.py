"""What the commands say to people, where a terminal may be gone or a disk be full."""

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from errno import EPIPE

from rich.console import Console
from rich.text import Text

from drivers.contract.errors import TenonError


class OutputError(TenonError):
    """Standard output cannot be written."""


class _Output(Console):
    def on_broken_pipe(self) -> None:
        """Raise what is raised for any other fault of the output; rich would end the process."""
        raise BrokenPipeError(EPIPE, os.strerror(EPIPE))


@contextmanager
def standard_output() -> Iterator[Console]:
    """Lend a console; raises OutputError where it cannot be written.

    What is written after that goes nowhere, so that the process can end in order.
    """
    try:
        yield _Output()
    except OSError as error:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        raise OutputError(f"cannot write to standard output: {error.strerror}") from error


def print_error(error: TenonError) -> None:
    """Say what went wrong on standard error, if anybody can hear it."""
    with suppress(OSError, SystemExit):
        text = Text.assemble(("error:", "red"), f" {error}")
        Console(stderr=True).print(text, soft_wrap=True, highlight=False)
