"""The log's ROS 2 types: the project's own as Python classes, and the way to CDR bytes and back.

Standard types come with rosbags; our own are defined in `msg/*.msg`, package `tenon_msgs`. Each
class here has the fields of the file of its name, in that order. Units stand in the field names;
where they do not, in the file.
"""

from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from typing import ClassVar, Generic, Protocol, TypeVar, cast

import numpy as np
from numpy.typing import NDArray
from rosbags.typesys import Stores, TypesysError, get_types_from_msg, get_typestore
from rosbags.typesys.store import Typestore
from rosbags.typesys.stores import ros2_humble as humble

Time = humble.builtin_interfaces__msg__Time
Header = humble.std_msgs__msg__Header
Point = humble.geometry_msgs__msg__Point
Quaternion = humble.geometry_msgs__msg__Quaternion
Vector3 = humble.geometry_msgs__msg__Vector3
Pose = humble.geometry_msgs__msg__Pose
Twist = humble.geometry_msgs__msg__Twist
Wrench = humble.geometry_msgs__msg__Wrench
PoseStamped = humble.geometry_msgs__msg__PoseStamped
TwistStamped = humble.geometry_msgs__msg__TwistStamped
WrenchStamped = humble.geometry_msgs__msg__WrenchStamped
DiagnosticArray = humble.diagnostic_msgs__msg__DiagnosticArray
DiagnosticStatus = humble.diagnostic_msgs__msg__DiagnosticStatus
KeyValue = humble.diagnostic_msgs__msg__KeyValue


@dataclass
class ForceEstimate:
    """The filter's view of the load."""

    __msgtype__: ClassVar[str] = "tenon_msgs/msg/ForceEstimate"
    header: Header
    wrench: Wrench
    wrench_rate: Wrench
    wrench_std: Wrench
    nis: float
    health: int


@dataclass
class Observation:
    """What a controller knew when it proposed a step."""

    __msgtype__: ClassVar[str] = "tenon_msgs/msg/Observation"
    header: Header
    step: int
    wrench: Wrench
    wrench_std: Wrench
    position_m: Vector3
    rotation_rad: Vector3
    displacement_m: Vector3
    commanded_m: Vector3
    commanded_rad: Vector3


@dataclass
class Belief:
    """What a controller believes of the hidden pose and of the part."""

    __msgtype__: ClassVar[str] = "tenon_msgs/msg/Belief"
    header: Header
    mean: NDArray[np.float64]
    deviation: NDArray[np.float64]
    covariance: NDArray[np.float64]
    state: str
    state_probability: float
    misfit: float
    restarts: int


@dataclass
class Proposal:
    """A step that a controller would like."""

    __msgtype__: ClassVar[str] = "tenon_msgs/msg/Proposal"
    header: Header
    number: int
    source: str
    translation_m: Vector3
    rotation_rad: Vector3
    expected_force: Vector3


@dataclass
class Reason:
    """One rule of the safety supervisor that fired."""

    __msgtype__: ClassVar[str] = "tenon_msgs/msg/Reason"
    rule: str
    severity: int
    detail: str


@dataclass
class Verdict:
    """The safety supervisor's answer."""

    __msgtype__: ClassVar[str] = "tenon_msgs/msg/Verdict"
    header: Header
    severity: int
    reasons: list[Reason]
    speed_cap_m_s: float


@dataclass
class Sent:
    """What the gate made of a proposal."""

    __msgtype__: ClassVar[str] = "tenon_msgs/msg/Sent"
    header: Header
    number: int
    sent: bool
    target_position_m: Vector3
    target_rotation_rad: Vector3
    translation_m: Vector3
    rotation_rad: Vector3
    speed_m_s: float
    verdict: Verdict


@dataclass
class LoopTiming:
    """The control loop over one window."""

    __msgtype__: ClassVar[str] = "tenon_msgs/msg/LoopTiming"
    header: Header
    window_s: float
    ticks: int
    sample_to_verdict_mean_s: float
    sample_to_verdict_median_s: float
    sample_to_verdict_max_s: float
    deadline_s: float
    missed_deadlines: int


@dataclass
class ContactState:
    """The truth about the contact, from a mock cell."""

    __msgtype__: ClassVar[str] = "tenon_msgs/msg/ContactState"
    header: Header
    state: str
    phase: str
    contacts: int
    depth_m: float
    wrench: Wrench
    position_m: Vector3
    rotation_rad: Vector3


@dataclass
class PhaseChange:
    """An insertion enters a phase."""

    __msgtype__: ClassVar[str] = "tenon_msgs/msg/PhaseChange"
    header: Header
    insertion: int
    phase: str
    reason: str
    steps: int


@dataclass
class Reset:
    """An operator's reset of a latched stop."""

    __msgtype__: ClassVar[str] = "tenon_msgs/msg/Reset"
    header: Header
    operator_name: str
    cleared: list[Reason]


class RosMessage(Protocol):
    """An object with the fields of a registered ROS type."""

    __msgtype__: ClassVar[str]


M = TypeVar("M", bound=RosMessage)

_ENCAPSULATION_BYTES = 4
"""What precedes the fields in CDR."""


def _load_types() -> tuple[Typestore, dict[str, str]]:
    """Return a store that knows our types beside ROS 2's, and our definitions by type name."""
    store = get_typestore(Stores.ROS2_HUMBLE)
    texts = {
        f"tenon_msgs/msg/{entry.name.removesuffix('.msg')}": entry.read_text(encoding="utf-8")
        for entry in files("hil").joinpath("msg").iterdir()
        if entry.name.endswith(".msg")
    }
    for name, text in texts.items():
        store.register(get_types_from_msg(text, name))
    return store, texts


_STORE, _OWN_TEXTS = _load_types()


@cache
def definition(kind: type[RosMessage]) -> str:
    """Return the type's definition and those that it needs, as MCAP's `ros2msg` schemas want it.

    Our own types keep their comments, so that a log says its units by itself.
    """
    name = kind.__msgtype__
    generated, _ = _STORE.generate_msgdef(name, ros_version=2)
    if name not in _OWN_TEXTS:
        return generated
    separator = "=" * 80
    return "".join((_OWN_TEXTS[name], *generated.partition(separator)[1:]))


def is_definition_of(name: str, text: str, kind: type[RosMessage]) -> bool:
    """Say whether a schema has the fields of `kind`; comments and constants do not matter."""
    ours = definition(kind)
    if (name, text) == (kind.__msgtype__, ours):
        return True
    return _fields(text, name) == _fields(ours, kind.__msgtype__)


def _fields(text: str, name: str) -> dict[str, object]:
    try:
        return {key: fields for key, (_, fields) in get_types_from_msg(text, name).items()}
    except TypesysError:
        return {}


def encode(message: RosMessage) -> bytes:
    """Return the message as little-endian CDR."""
    return bytes(_STORE.serialize_cdr(message, message.__msgtype__, little_endian=True))


class RepeatedEncoder(Generic[M]):
    """Encodes one message object again and again into one buffer, in a third of the time.

    The message's numbers may be changed in between; strings and lists must keep their lengths.
    """

    def __init__(self, message: M) -> None:
        self._message = message
        self._buffer = bytearray(encode(message))
        self._body = memoryview(self._buffer)[_ENCAPSULATION_BYTES:]
        self._serialize = _STORE.get_msgdef(message.__msgtype__).serialize_cdr_le

    def encode(self) -> bytes:
        """Return the message as it is now, as `encode` would."""
        self._serialize(self._body, 0, self._message, _STORE)
        return bytes(self._buffer)


def decode(data: bytes, kind: type[M]) -> M:
    """Return the message in `data`; raises rosbags' SerdeError where it is none of that kind."""
    return cast(M, _STORE.deserialize_cdr(data, kind.__msgtype__))
