"""A log written by a process of its own, so that no compression or slow disk delays the loop.

Messages travel in batches through a pipe. What is in the pipe outlives the sender: if that is
killed, the writer still writes everything it was sent, and finishes the file.
"""

import atexit
import marshal
import multiprocessing
import signal
from collections.abc import Mapping
from multiprocessing.connection import Connection
from pathlib import Path

from drivers.contract.errors import LogError
from hil.log_file import FLUSH_PERIOD_NS, LogFile, Pace

_BATCH_PERIOD_NS = 10_000_000

_Message = tuple[str, bytes, int, int, int]
"""The arguments of `LogFile.write`."""


class LogProcess:
    """Stands in for a `LogFile` that another process holds; Linux and macOS.

    An error of the writer is raised by the first call that finds its end of the pipe closed.
    """

    def __init__(
        self,
        path: Path,
        metadata: Mapping[str, Mapping[str, str]],
        flush_period_ns: int = FLUSH_PERIOD_NS,
    ) -> None:
        """Create the file, as LogFile does, and return once its first records are written."""
        context = multiprocessing.get_context("fork")
        receiver, self._sender = context.Pipe(duplex=False)
        self._answers, answering = context.Pipe(duplex=False)
        self._process = context.Process(
            target=_write_log,
            args=(receiver, self._sender, answering, path, metadata, flush_period_ns),
            name="log writer",
        )
        self._process.start()
        receiver.close()
        answering.close()
        atexit.register(self._sender.close)
        self._path = path
        self._batch: list[_Message] = []
        self._batch_pace = Pace(_BATCH_PERIOD_NS)
        self._unusable = self._answer()
        if self._unusable:
            self._process.join()
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
        self._process.join()
        if error:
            raise LogError(error)

    def _send(self, now_ns: int | None, ending: str = "") -> None:
        """Send the batch; the writer flushes at its own pace at `now_ns`, at once if None."""
        if self._unusable:
            raise LogError(self._unusable)
        batch, self._batch = self._batch, []
        try:
            self._sender.send_bytes(marshal.dumps((batch, now_ns, ending)))
        except BrokenPipeError as error:
            self._unusable = self._answer()
            raise LogError(self._unusable) from error

    def _answer(self) -> str:
        """Return what the writer says of the file: nothing if it is in order."""
        try:
            return str(self._answers.recv_bytes(), "utf-8")
        except EOFError:
            return (
                f"the process that writes the log {self._path} has died; "
                "what the log held until then can be read"
            )


def _write_log(
    receiver: Connection,
    sender: Connection,
    answering: Connection,
    path: Path,
    metadata: Mapping[str, Mapping[str, str]],
    flush_period_ns: int,
) -> None:
    """Write what comes until the sender closes or dies; signals are the sender's business."""
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, signal.SIG_IGN)
    sender.close()
    try:
        file = LogFile(path, metadata, flush_period_ns)
        answering.send_bytes(b"")
        file.close(_write_batches(receiver, file))
    except LogError as error:
        answering.send_bytes(str(error).encode())
    else:
        answering.send_bytes(b"")


def _write_batches(receiver: Connection, file: LogFile) -> str:
    """Write until the sender is gone; return what it said of the run's ending."""
    ending = ""
    while True:
        try:
            received = receiver.recv_bytes()
        except EOFError:
            return ending
        batch, now_ns, ending = marshal.loads(received)  # noqa: S302 (from our own sender)
        for message in batch:
            file.write(*message)
        if now_ns is None:
            file.flush()
        else:
            file.keep_pace(now_ns)
