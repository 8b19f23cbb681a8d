"""The log as a file: its topics, and an MCAP writer whose file is readable after a kill."""

import contextlib
from collections.abc import Mapping
from enum import StrEnum
from pathlib import Path
from types import MappingProxyType

from mcap.writer import Writer

from drivers.contract.errors import LogError
from hil import ros_types as ros

FORMAT_RECORD = "tenon_log"
"""Name of the metadata record that says which format a log has."""
FORMAT_VERSION = "2"
ENDING_RECORD = "ending"
"""Name of the metadata record that says why a run ended before its time."""

FLUSH_PERIOD_NS = 50_000_000
"""At least so often, by the host's time, all traffic goes to the operating system."""


class Topic(StrEnum):
    """Where messages stand in the log."""

    __hash__ = str.__hash__
    """An enumeration's own is a Python function, and every message looks its topic up."""

    RAW_FORCE = "/force/raw"
    FORCE_BIAS = "/force/bias"
    FORCE_ESTIMATE = "/force/estimate"
    STAGE_POSE = "/stage/pose"
    STAGE_TWIST = "/stage/twist"
    ARM_POSE = "/arm/pose"
    OBSERVATION = "/skill/observation"
    BELIEF = "/skill/belief"
    PROPOSAL = "/skill/proposal"
    PHASE = "/skill/phase"
    VERDICT = "/safety/verdict"
    SENT = "/safety/sent"
    RESET = "/safety/reset"
    LOOP_TIMING = "/loop/timing"
    CONTACT_STATE = "/truth/contact"
    DIAGNOSTICS = "/diagnostics"


MESSAGE_TYPES: Mapping[Topic, type[ros.RosMessage]] = MappingProxyType(
    {
        Topic.RAW_FORCE: ros.WrenchStamped,
        Topic.FORCE_BIAS: ros.WrenchStamped,
        Topic.FORCE_ESTIMATE: ros.ForceEstimate,
        Topic.STAGE_POSE: ros.PoseStamped,
        Topic.STAGE_TWIST: ros.TwistStamped,
        Topic.ARM_POSE: ros.PoseStamped,
        Topic.OBSERVATION: ros.Observation,
        Topic.BELIEF: ros.Belief,
        Topic.PROPOSAL: ros.Proposal,
        Topic.PHASE: ros.PhaseChange,
        Topic.VERDICT: ros.Verdict,
        Topic.SENT: ros.Sent,
        Topic.RESET: ros.Reset,
        Topic.LOOP_TIMING: ros.LoopTiming,
        Topic.CONTACT_STATE: ros.ContactState,
        Topic.DIAGNOSTICS: ros.DiagnosticArray,
    }
)


class Pace:
    """Says when a period has passed."""

    def __init__(self, period_ns: int) -> None:
        self._period_ns = period_ns
        self._last_ns: int | None = None

    def due(self, now_ns: int) -> bool:
        """Say yes the first time and whenever a period lies between now and the last yes.

        A clock that jumps back by a period counts too.
        """
        if self._last_ns is not None and abs(now_ns - self._last_ns) < self._period_ns:
            return False
        self._last_ns = now_ns
        return True


# The ignored types below: mcap annotates neither Writer.flush nor Writer.finish.
class LogFile:
    """A new MCAP file with a channel for each topic, written chunk by chunk.

    Log times are the host's, made non-decreasing. Every method raises LogError where the system
    cannot write; the file then keeps what it has and takes nothing more.
    """

    def __init__(
        self,
        path: Path,
        metadata: Mapping[str, Mapping[str, str]],
        flush_period_ns: int = FLUSH_PERIOD_NS,
    ) -> None:
        """Create the file, which must not exist, with `metadata` as its first records.

        `metadata` holds named records of text, such as configuration and limits.
        """
        self._path = path
        self._flush_pace = Pace(flush_period_ns)
        self._log_time_ns = 0
        self._unusable = ""
        try:
            self._stream = path.open("xb", buffering=0)
        except FileExistsError as error:
            raise LogError(
                f"{path} exists and a log is never overwritten: move it away or choose another name"
            ) from error
        except OSError as error:
            raise LogError(f"cannot create the log {path}: {error.strerror}") from error
        try:
            self._writer = Writer(self._stream, enable_data_crcs=True)
            self._writer.start(profile="ros2")
            self._writer.add_metadata(FORMAT_RECORD, {"version": FORMAT_VERSION})
            for name, entries in metadata.items():
                self._writer.add_metadata(name, dict(entries))
            schemas: dict[str, int] = {}
            self._channels: dict[str, int] = {
                topic: self._register(topic, schemas) for topic in Topic
            }
            self._writer.flush()  # type: ignore[no-untyped-call]  # see above LogFile
        except OSError as error:
            raise self._failed(error) from error

    @property
    def usable(self) -> bool:
        """Whether the file is open and no write has failed."""
        return not self._unusable

    def write(
        self, topic: str, data: bytes, stamp_ns: int, heard_ns: int, sequence: int = 0
    ) -> None:
        """Add one message to a Topic with its own stamp and the host's time; flush if due."""
        if self._unusable:
            raise LogError(self._unusable)
        if heard_ns > self._log_time_ns:
            self._log_time_ns = heard_ns
        try:
            self._writer.add_message(
                self._channels[topic],
                self._log_time_ns,
                data,
                stamp_ns if stamp_ns > 0 else 0,
                sequence & 0xFFFF_FFFF,
            )
        except OSError as error:
            raise self._failed(error) from error
        self.keep_pace(heard_ns)

    def keep_pace(self, now_ns: int) -> None:
        """Flush if the flush period has passed."""
        if self._flush_pace.due(now_ns):
            self.flush()

    def flush(self) -> None:
        """Hand everything so far to the operating system."""
        if self._unusable:
            raise LogError(self._unusable)
        try:
            self._writer.flush()  # type: ignore[no-untyped-call]  # see above LogFile
        except OSError as error:
            raise self._failed(error) from error

    def close(self, ending: str = "") -> None:
        """Write why the run ended before its time, if it did, then index and footer, and close."""
        if self._unusable:
            raise LogError(self._unusable)
        try:
            if ending:
                self._writer.add_metadata(ENDING_RECORD, {"text": ending})
            self._writer.finish()  # type: ignore[no-untyped-call]  # see above LogFile
            self._writer.flush()  # type: ignore[no-untyped-call]  # see above LogFile
            self._stream.close()
        except OSError as error:
            raise self._failed(error) from error
        self._unusable = f"the log {self._path} is closed"

    def _register(self, topic: Topic, schemas: dict[str, int]) -> int:
        kind = MESSAGE_TYPES[topic]
        name = kind.__msgtype__
        if name not in schemas:
            text = ros.definition(kind).encode()
            schemas[name] = self._writer.register_schema(name, "ros2msg", text)
        return self._writer.register_channel(topic, "cdr", schemas[name])

    def _failed(self, error: OSError) -> LogError:
        self._unusable = (
            f"cannot write the log {self._path}: {error.strerror}; "
            "what it held until then can be read"
        )
        with contextlib.suppress(OSError):
            self._stream.close()
        return LogError(self._unusable)
