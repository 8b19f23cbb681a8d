"""A log written by a process of its own, so that no compression or slow disk delays the loop.

Messages travel in batches through a pipe. What is in the pipe outlives the sender: if that is
killed, the writer still writes everything it was sent, and finishes the file. A writer that falls
behind by more than the pipe holds is an error, so that the sender never waits for it for ever.
"""

import atexit
import fcntl
import marshal
import multiprocessing
import os
import select
from collections.abc import Mapping
from contextlib import suppress
from io import BufferedReader, FileIO
from multiprocessing.connection import Connection
from pathlib import Path

from drivers.contract.errors import LogError
from hil.interrupt import signals_blocked
from hil.log_file import FLUSH_PERIOD_NS, LogFile, Pace

PATIENCE_S = 10.0
"""How long the sender waits for a writer that makes no progress, if nothing moves meanwhile."""

_BATCH_PERIOD_NS = 10_000_000
_PIPE_BYTES = 1 << 20
"""Some seconds of a run at 1 kHz: what Linux gives without privileges; macOS gives less."""
_SIZE_BYTES = 4
"""A batch comes after its size."""

_Message = tuple[str, bytes, int, int, int]
"""The arguments of `LogFile.write`."""


class LogProcess:
    """Stands in for a `LogFile` that another process holds; Linux and macOS.

    An error of the writer is raised by the first call that finds its end of the pipe closed, or the
    pipe full for longer than the patience.
    """

    def __init__(
        self,
        path: Path,
        metadata: Mapping[str, Mapping[str, str]],
        flush_period_ns: int = FLUSH_PERIOD_NS,
        patience_s: float = PATIENCE_S,
    ) -> None:
        """Create the file, as LogFile does, and return once its first records are written."""
        context = multiprocessing.get_context("fork")
        receiver, self._sender = _pipe()
        self._answers, answering = context.Pipe(duplex=False)
        self._process = context.Process(
            target=_write_log,
            args=(receiver, self._sender, answering, path, metadata, flush_period_ns),
            name="log writer",
        )
        with signals_blocked():
            self._process.start()
            atexit.register(self._let_go)
        receiver.close()
        answering.close()
        self._path = path
        self._patience_s = patience_s
        self._writable = select.poll()
        self._writable.register(self._sender, select.POLLOUT)
        self._batch: list[_Message] = []
        self._batch_pace = Pace(_BATCH_PERIOD_NS)
        self._unusable = self._answer()
        if self._unusable:
            self._let_go()
            raise LogError(self._unusable)

    @property
    def usable(self) -> bool:
        """Whether the log is open and no write is known to have failed."""
        return not self._unusable

    def write(
        self, topic: str, data: bytes, stamp_ns: int, heard_ns: int, sequence: int = 0
    ) -> None:
        """Add one message with its own stamp and the host's time."""
        if self._unusable:
            raise LogError(self._unusable)
        self._batch.append((str(topic), data, stamp_ns, heard_ns, sequence))
        self.keep_pace(heard_ns)

    def keep_pace(self, now_ns: int) -> None:
        """Send what has gathered if a batch's period has passed."""
        if self._batch_pace.due(now_ns):
            self._send(now_ns)

    def flush(self) -> None:
        """Send what has gathered, to be handed to the operating system on arrival."""
        self._send(None)

    def close(self, ending: str = "") -> None:
        """Send the rest, and return once the writer has finished the file as LogFile.close does."""
        self._send(None, ending)
        self._sender.close()
        error = self._answer()
        self._unusable = error or f"the log {self._path} is closed"
        self._let_go()
        if error:
            raise LogError(error)

    def _send(self, now_ns: int | None, ending: str = "") -> None:
        """Send the batch; the writer flushes at its own pace at `now_ns`, at once if None."""
        if self._unusable:
            raise LogError(self._unusable)
        batch, self._batch = self._batch, []
        content = marshal.dumps((batch, now_ns, ending))
        left = memoryview(len(content).to_bytes(_SIZE_BYTES, "little") + content)
        try:
            while left:
                sent = self._sender.write(left)
                if sent is None and not self._writable.poll(self._patience_s * 1e3):
                    self._unusable = self._failure("does not keep up")
                    raise LogError(self._unusable)
                left = left[sent or 0 :]
        except BrokenPipeError as error:
            self._unusable = self._answer()
            raise LogError(self._unusable) from error

    def _answer(self) -> str:
        """Return what the writer says of the file: nothing if it is in order."""
        if not self._answers.poll(PATIENCE_S):
            return self._failure("does not answer")
        try:
            return str(self._answers.recv_bytes(), "utf-8")
        except EOFError:
            return self._failure("has died")

    def _failure(self, how: str) -> str:
        return (
            f"the process that writes the log {self._path} {how}; "
            "what the log held until then can be read"
        )

    def _let_go(self) -> None:
        """Let the writer finish what it was sent; one that does not is killed."""
        self._sender.close()
        self._process.join(PATIENCE_S)
        self._process.kill()
        self._process.join()


def _pipe() -> tuple[BufferedReader, FileIO]:
    """Return the ends of a pipe that holds as much as the system gives; writing does not block."""
    receiving, sending = os.pipe()
    os.set_blocking(sending, False)
    if hasattr(fcntl, "F_SETPIPE_SZ"):
        with suppress(OSError):
            fcntl.fcntl(sending, fcntl.F_SETPIPE_SZ, _PIPE_BYTES)
    return BufferedReader(FileIO(receiving)), FileIO(sending, "w")


def _write_log(
    receiver: BufferedReader,
    sender: FileIO,
    answering: Connection,
    path: Path,
    metadata: Mapping[str, Mapping[str, str]],
    flush_period_ns: int,
) -> None:
    """Write what comes until the sender closes or dies.

    The signals that were blocked at the start stay so: they are the sender's business.
    """
    sender.close()
    try:
        file = LogFile(path, metadata, flush_period_ns)
        answering.send_bytes(b"")
        file.close(_write_batches(receiver, file))
    except LogError as error:
        answering.send_bytes(str(error).encode())
    else:
        answering.send_bytes(b"")


def _write_batches(receiver: BufferedReader, file: LogFile) -> str:
    """Write until the sender is gone; return what it said of the run's ending."""
    ending = ""
    while True:
        size = int.from_bytes(receiver.read(_SIZE_BYTES), "little")
        received = receiver.read(size)
        if not size or len(received) < size:
            return ending
        batch, now_ns, ending = marshal.loads(received)  # noqa: S302 (from our own sender)
        for message in batch:
            file.write(*message)
        if now_ns is None:
            file.flush()
        else:
            file.keep_pace(now_ns)
