"""What travels between filter, skill, supervisor and gate: frozen values in SI units."""

import math
from dataclasses import dataclass
from enum import IntEnum, IntFlag, StrEnum
from typing import NamedTuple

from drivers.contract.messages import (
    ZERO3,
    ArmState,
    ForceSample,
    GripperState,
    Pose,
    StageState,
    Vector3,
    Wrench,
)


class FilterHealth(IntFlag):
    """What speaks against using a force estimate; several may hold at once."""

    OK = 0
    REJECTED = 1
    """The newest sample was an outlier and has not been used."""
    STUCK = 2
    """The sensor repeats the same values, on all axes or for long on one."""
    SILENT = 4
    """The sensor has sent nothing for three periods."""
    UNTARED = 8
    """No bias has been taken, so the zero is unknown."""


class ForceEstimate(NamedTuple):
    """The Kalman filter's view of the load, bias removed."""

    stamp_ns: int
    wrench: Wrench
    """[N, N*m], frame F."""
    rate: Wrench
    """Time derivative of `wrench` [N/s, N*m/s]."""
    std: Wrench
    """Standard deviation of `wrench`."""
    nis: float
    """Normalised innovation squared of the newest sample; six degrees of freedom."""
    health: FilterHealth


@dataclass(frozen=True, slots=True)
class Observation:
    """What a controller may know when it proposes a step."""

    stamp_ns: int
    step: int
    """Insertion steps made so far."""
    wrench: Wrench
    wrench_std: Wrench
    pose: Pose
    """Stage pose in frame M; its z is the depth p_z."""
    displacement: Vector3
    """Stage position since the insertion began [m]."""
    commanded: Pose
    """Where the stage was last sent, and before the first step where it stands."""

    @property
    def depth_m(self) -> float:
        return self.pose.position[2]


class Move(NamedTuple):
    """A step of the stage, relative to where it is, in frame M."""

    translation: Vector3
    """[m]."""
    rotation: Vector3 = ZERO3
    """[rad] about x, y, z, around the centre of the shaft's leading end."""
    expected_force: Vector3 = ZERO3
    """See `Proposal.expected_force`."""


@dataclass(frozen=True, slots=True)
class ContactBelief:
    """What a controller believes of the hidden pose and of the part, by contact."""

    stamp_ns: int
    """Of the observation that it answers."""
    mean: tuple[float, ...]
    """Seven parameters: how far the shaft is beside where the stage says, x and y [m], and turned
    from it, about x and y [rad]; stiffness [N/m], clearance of the first hole [m], friction."""
    covariance: tuple[float, ...]
    """49 values, row by row, in the units of `mean`."""
    state: str
    """The most likely contact state."""
    state_probability: float
    misfit: float
    """Mean squared misfit of the newest reading; about 6 where the contact model holds."""
    restarts: int
    """How often in this insertion the belief was lost and searched anew."""

    @property
    def std(self) -> tuple[float, ...]:
        """Standard deviation of each parameter."""
        return tuple(math.sqrt(v) for v in self.covariance[:: len(self.mean) + 1])


@dataclass(frozen=True, slots=True)
class Proposal:
    """A step that somebody would like the stage to make, relative to where it is."""

    stamp_ns: int
    number: int
    """Counts up through a run and ties proposal, verdict and sent command together."""
    source: str
    translation: Vector3
    """[m], frame M."""
    rotation: Vector3 = ZERO3
    """[rad] about x, y, z."""
    expected_force: Vector3 = ZERO3
    """Largest force that the step may lead to, as far as its source foresees [N]."""


class Severity(IntEnum):
    """How hard the supervisor steps in; the hardest rule that fires decides."""

    PASS = 0
    REDUCE = 1
    """Go on, but smaller or slower."""
    HOLD = 2
    """Halt and send nothing until the cause is gone."""
    RETREAT = 3
    """Halt; only steps out of the part are sent until the load is gone."""
    STOP = 4
    """Halt and latch: nothing is sent until an operator resets."""


class Rule(StrEnum):
    """The supervisor's rules, each named after what it protects against."""

    MISSING_DATA = "missing data"
    NON_FINITE = "non-finite value"
    CLOCK = "clock ran backwards"
    HEARTBEAT = "late tick"
    STALE_SAMPLE = "stale force sample"
    STALE_DEVICE = "stale device state"
    STALE_PROPOSAL = "stale proposal"
    SENSOR_STATUS = "force sensor status"
    FILTER_HEALTH = "force filter health"
    UNTARED = "force not tared"
    FORCE = "force limit"
    FORCE_RATE = "force rate limit"
    IMPULSE = "impulse limit"
    GOVERNOR = "speed governor"
    SPEED = "speed limit"
    STEP_BOX = "step box"
    WORKSPACE = "workspace"
    KEEP_OUT = "arm and stage keep-out"
    VACUUM = "vacuum lost"
    BUSY = "stage still moving"
    RETREATING = "only steps out are allowed"


@dataclass(frozen=True, slots=True)
class Reason:
    """One rule that fired, with the value and the limit in people's units."""

    rule: Rule
    severity: Severity
    detail: str

    def __str__(self) -> str:
        return f"{self.rule}: {self.detail}"


class Verdict(NamedTuple):
    """The supervisor's answer; `reasons` is empty exactly for PASS."""

    stamp_ns: int
    reasons: tuple[Reason, ...] = ()
    speed_cap_m_s: float = math.inf
    """Path speed that must not be exceeded now."""

    @property
    def severity(self) -> Severity:
        """Of the hardest reason."""
        severity = Severity.PASS
        for reason in self.reasons:
            severity = max(severity, reason.severity)
        return severity

    @property
    def lets_out(self) -> bool:
        """Whether it asks for a way out of the part, with nothing beside it that holds."""
        return self.severity is Severity.RETREAT and all(
            reason.severity is not Severity.HOLD for reason in self.reasons
        )


class Snapshot(NamedTuple):
    """All that the supervisor looks at, at one instant; None where nothing has been heard yet."""

    now_ns: int
    sample: ForceSample | None
    bias: Wrench
    """Taken off the raw sample before the force limits are checked."""
    estimate: ForceEstimate | None
    stage: StageState | None
    arm: ArmState | None
    gripper: GripperState | None


@dataclass(frozen=True, slots=True)
class Sent:
    """What the gate made of a proposal: the command that really left, or None with the verdict."""

    stamp_ns: int
    number: int
    verdict: Verdict
    target: Pose | None
    translation: Vector3 = ZERO3
    """What is really commanded, relative to the pose before [m]."""
    rotation: Vector3 = ZERO3
    speed_m_s: float = 0.0


@dataclass(frozen=True, slots=True)
class ResetRecord:
    """An operator's reset of a latched stop."""

    stamp_ns: int
    operator: str
    cleared: tuple[Reason, ...]


class SkillPhase(StrEnum):
    """Where an insertion stands."""

    APPROACH = "approach"
    """Above the part, in free air."""
    INSERT = "insert"
    RETRACT = "retract"
    """Out of the part, after a failure with the part still held or after it was let go."""
    DONE = "done"
    FAILED = "failed"


@dataclass(frozen=True, slots=True)
class PhaseChange:
    """An insertion enters a phase."""

    stamp_ns: int
    insertion: int
    """Counts from 1."""
    phase: SkillPhase
    reason: str
    """Why; empty where the phase is the ordinary next one."""
    steps: int
    """Steps sent in the insert phase so far."""


class Tick(NamedTuple):
    """One turn of the control loop, from sample to verdict."""

    snapshot: Snapshot
    verdict: Verdict
    start_ns: int
    """When the sample was at hand."""
    end_ns: int
    """When the verdict was carried out."""
