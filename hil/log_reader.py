"""Reads a log back into our own values, whether it was finished, cut off or its writer killed."""

import struct
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import chain
from pathlib import Path
from typing import BinaryIO, TypeVar

import numpy as np
from mcap.exceptions import McapError, RecordLengthLimitExceeded
from mcap.records import Channel, DataEnd, Header, Message, Metadata, Schema
from mcap.stream_reader import StreamReader
from numpy.typing import NDArray
from rosbags.serde import SerdeError
from zstandard import ZstdError

from controllers.messages import (
    ContactBelief,
    ForceEstimate,
    Observation,
    PhaseChange,
    Proposal,
    ResetRecord,
    Sent,
    SkillPhase,
    Verdict,
)
from drivers.contract.errors import LogError
from drivers.contract.messages import Vector3
from hil import log_decoding as decoding
from hil import ros_types as ros
from hil.log_decoding import DeviceStatus
from hil.log_file import FORMAT_RECORD, FORMAT_VERSION, MESSAGE_TYPES, Topic
from hil.ros_messages import ContactTruth, LoopTiming

Stamps = NDArray[np.int64]
Rows = NDArray[np.float64]

_DAMAGE = (McapError, struct.error, ValueError, OverflowError, MemoryError, ZstdError)
"""What mcap's reader raises on records that are cut off or altered."""

_CUT_OFF = "it has no end: its writer was stopped, or the file cut off"

T = TypeVar("T")


@dataclass(frozen=True, slots=True)
class RawForce:
    """Raw samples, one row each; the arrays are read-only."""

    stamps_ns: Stamps
    """(n,) when measured."""
    receipts_ns: Stamps
    """(n,) when the host had it."""
    sequences: Stamps
    """(n,) the sensor's counter, modulo 2**32."""
    wrench: Rows
    """(n, 6) [N, N*m], frame F, bias included."""


@dataclass(frozen=True, slots=True)
class BiasTrack:
    """The bias that was in force from each stamp on."""

    stamps_ns: Stamps
    wrench: Rows
    """(n, 6) [N, N*m], frame F."""


@dataclass(frozen=True, slots=True)
class PoseTrack:
    """Poses over time."""

    stamps_ns: Stamps
    position: Rows
    """(n, 3) [m]"""
    rotation: Rows
    """(n, 3) [rad] about x, then y, then z."""


@dataclass(frozen=True, slots=True)
class TwistTrack:
    """Velocities over time."""

    stamps_ns: Stamps
    velocity: Rows
    """(n, 3) [m/s]"""
    angular_velocity: Rows
    """(n, 3) [rad/s]"""


@dataclass(frozen=True, slots=True)
class ForceTrace:
    """Raw samples of one insertion, each with the bias and the depth at its stamp."""

    stamps_ns: Stamps
    raw: Rows
    """(n, 6) [N, N*m], frame F, bias included."""
    bias: Rows
    """(n, 6) [N, N*m]; NaN where the log holds none."""
    depth_m: Rows
    """(n,) interpolated between the stage's poses; NaN before the first."""

    @property
    def wrench(self) -> Rows:
        """(n, 6) [N, N*m], bias removed."""
        return self.raw - self.bias


@dataclass(frozen=True, slots=True)
class Log:
    """Everything that a log holds, each kind in the order in which it was recorded."""

    path: Path
    complete: bool
    """Whether the recorder closed the file."""
    ending: str
    """Where `complete` is false: how the file ends."""
    metadata: Mapping[str, Mapping[str, str]]
    raw_force: RawForce
    force_bias: BiasTrack
    stage_pose: PoseTrack
    stage_twist: TwistTrack
    arm_pose: PoseTrack
    estimates: tuple[ForceEstimate, ...]
    observations: tuple[Observation, ...]
    beliefs: tuple[ContactBelief, ...]
    proposals: tuple[Proposal, ...]
    phases: tuple[PhaseChange, ...]
    verdicts: tuple[Verdict, ...]
    sent: tuple[Sent, ...]
    resets: tuple[ResetRecord, ...]
    timings: tuple[LoopTiming, ...]
    contact_states: tuple[ContactTruth, ...]
    device_statuses: tuple[DeviceStatus, ...]

    @property
    def insertions(self) -> tuple[int, ...]:
        """The insertions that the log knows, by number."""
        return tuple(sorted({change.insertion for change in self.phases}))

    def trace(self, insertion: int, phase: SkillPhase = SkillPhase.INSERT) -> ForceTrace:
        """Return the samples that were measured while `insertion` was in `phase`.

        A phase lasts until the next one begins, the last one until the end of the log.
        Raises LogError where the log does not know the insertion.
        """
        if insertion not in self.insertions:
            known = ", ".join(map(str, self.insertions)) or "none"
            raise LogError(f"{self.path} has no insertion {insertion}; it has {known}")
        stamps_ns = self.raw_force.stamps_ns
        inside = np.zeros(stamps_ns.shape, dtype=bool)
        ends_ns = [*(change.stamp_ns for change in self.phases[1:]), np.iinfo(np.int64).max]
        for change, end_ns in zip(self.phases, ends_ns, strict=True):
            if change.insertion == insertion and change.phase is phase:
                inside |= (change.stamp_ns <= stamps_ns) & (stamps_ns < end_ns)
        return ForceTrace(
            stamps_ns=stamps_ns[inside],
            raw=self.raw_force.wrench[inside],
            bias=self._bias_at(stamps_ns[inside]),
            depth_m=self._depth_at(stamps_ns[inside]),
        )

    def _bias_at(self, stamps_ns: Stamps) -> Rows:
        track = self.force_bias
        if not track.stamps_ns.size:
            return np.full((stamps_ns.size, 6), np.nan)
        newest = np.searchsorted(track.stamps_ns, stamps_ns, side="right") - 1
        bias: Rows = track.wrench[np.maximum(newest, 0)]
        return bias

    def _depth_at(self, stamps_ns: Stamps) -> Rows:
        track = self.stage_pose
        if not track.stamps_ns.size:
            return np.full(stamps_ns.size, np.nan)
        start_ns = track.stamps_ns[0]
        depth_m: Rows = np.interp(
            (stamps_ns - start_ns).astype(np.float64),
            (track.stamps_ns - start_ns).astype(np.float64),
            track.position[:, 2],
            left=np.nan,
        )
        return depth_m


@dataclass(slots=True)
class _Contents:
    metadata: dict[str, dict[str, str]] = field(default_factory=dict)
    messages: dict[Topic, list[Message]] = field(
        default_factory=lambda: {topic: [] for topic in Topic}
    )
    ending: str = ""


def read_log(path: Path) -> Log:
    """Return what the log at `path` holds, up to the first record that is not whole.

    Raises LogError where there is no such file, or it is not an MCAP file, or it is not a log of
    this project in a format that this program knows.
    """
    try:
        with path.open("rb") as stream:
            contents = _read(path, stream)
    except OSError as error:
        raise LogError(f"cannot read the log {path}: {error.strerror}") from error
    try:
        return _decoded(path, contents)
    except (SerdeError, ValueError) as error:
        raise LogError(f"{path} holds a message that cannot be decoded: {error}") from error


def _read(path: Path, stream: BinaryIO) -> _Contents:
    size = path.stat().st_size
    records = StreamReader(stream, validate_crcs=True, record_size_limit=size).records
    try:
        header = next(records)
    except _DAMAGE as error:
        raise LogError(f"{path} is not an MCAP file, or cut off in its header") from error
    if not isinstance(header, Header) or header.profile != "ros2":
        raise LogError(f"{path} is not a log of this project: it has no ROS 2 messages")
    contents = _Contents(ending=_CUT_OFF)
    schemas: dict[int, Schema] = {}
    topics: dict[int, Topic | None] = {}
    try:
        for record in records:
            if isinstance(record, Metadata):
                if record.name == FORMAT_RECORD:
                    _check_version(path, record.metadata.get("version"))
                contents.metadata[record.name] = record.metadata
            elif isinstance(record, Schema):
                schemas[record.id] = record
            elif isinstance(record, Channel) and record.id not in topics:
                topics[record.id] = _topic(path, record, schemas.get(record.schema_id))
            elif isinstance(record, Message):
                topic = topics.get(record.channel_id)
                if topic is not None:
                    contents.messages[topic].append(record)
            elif isinstance(record, DataEnd):
                contents.ending = ""
    except RecordLengthLimitExceeded:
        contents.ending = _CUT_OFF
    except _DAMAGE as error:
        cut_off = not stream.read(1)
        contents.ending = (
            _CUT_OFF if cut_off else f"it is damaged before byte {stream.tell()}: {error}"
        )
    _check_format(path, contents)
    return contents


def _topic(path: Path, channel: Channel, schema: Schema | None) -> Topic | None:
    """Return the channel's topic, or None for a topic that this program does not know."""
    topic = next((topic for topic in Topic if topic == channel.topic), None)
    if topic is None:
        return None
    kind = MESSAGE_TYPES[topic]
    if schema is None or not ros.is_definition_of(schema.name, schema.data.decode(), kind):
        name = schema.name if schema else "no schema"
        raise LogError(
            f"{path} is not a log that this program knows: "
            f"{topic} has another definition of {name} than {kind.__msgtype__} here"
        )
    return topic


def _check_format(path: Path, contents: _Contents) -> None:
    if contents.metadata.pop(FORMAT_RECORD, None) is None:
        raise LogError(
            f"{path} is not a log of this project, or cut off in its first bytes: "
            f"it has no record {FORMAT_RECORD!r}"
        )


def _check_version(path: Path, version: str | None) -> None:
    if version != FORMAT_VERSION:
        raise LogError(f"{path} has log format {version}; this program reads {FORMAT_VERSION}")


def _decoded(path: Path, contents: _Contents) -> Log:
    def values(topic: Topic, decode: Callable[[bytes], T]) -> tuple[T, ...]:
        return tuple(decode(message.data) for message in contents.messages[topic])

    raw_messages = contents.messages[Topic.RAW_FORCE]
    raw = values(Topic.RAW_FORCE, decoding.wrench_stamped)
    bias = values(Topic.FORCE_BIAS, decoding.wrench_stamped)
    twist = values(Topic.STAGE_TWIST, decoding.twist_stamped)
    return Log(
        path=path,
        complete=not contents.ending,
        ending=contents.ending,
        metadata=contents.metadata,
        raw_force=RawForce(
            stamps_ns=_integers(row[0] for row in raw),
            receipts_ns=_integers(message.log_time for message in raw_messages),
            sequences=_integers(message.sequence for message in raw_messages),
            wrench=_matrix((row[1] for row in raw), 6),
        ),
        force_bias=BiasTrack(
            stamps_ns=_integers(row[0] for row in bias),
            wrench=_matrix((row[1] for row in bias), 6),
        ),
        stage_pose=_pose_track(values(Topic.STAGE_POSE, decoding.pose_stamped)),
        stage_twist=TwistTrack(
            stamps_ns=_integers(row[0] for row in twist),
            velocity=_matrix((row[1] for row in twist), 3),
            angular_velocity=_matrix((row[2] for row in twist), 3),
        ),
        arm_pose=_pose_track(values(Topic.ARM_POSE, decoding.pose_stamped)),
        estimates=values(Topic.FORCE_ESTIMATE, decoding.force_estimate),
        observations=values(Topic.OBSERVATION, decoding.observation),
        beliefs=values(Topic.BELIEF, decoding.belief),
        proposals=values(Topic.PROPOSAL, decoding.proposal),
        phases=values(Topic.PHASE, decoding.phase_change),
        verdicts=values(Topic.VERDICT, decoding.verdict),
        sent=values(Topic.SENT, decoding.sent),
        resets=values(Topic.RESET, decoding.reset),
        timings=values(Topic.LOOP_TIMING, decoding.loop_timing),
        contact_states=values(Topic.CONTACT_STATE, decoding.contact_state),
        device_statuses=tuple(chain.from_iterable(values(Topic.DIAGNOSTICS, decoding.diagnostics))),
    )


def _pose_track(rows: Sequence[tuple[int, Vector3, Vector3]]) -> PoseTrack:
    return PoseTrack(
        stamps_ns=_integers(row[0] for row in rows),
        position=_matrix((row[1] for row in rows), 3),
        rotation=_matrix((row[2] for row in rows), 3),
    )


def _integers(values: Iterable[int]) -> Stamps:
    array = np.fromiter(values, dtype=np.int64)
    array.setflags(write=False)
    return array


def _matrix(rows: Iterable[tuple[float, ...]], columns: int) -> Rows:
    array = np.array(list(rows), dtype=np.float64).reshape(-1, columns)
    array.setflags(write=False)
    return array
