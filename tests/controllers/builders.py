"""A cell in perfect order, to be disturbed by one thing at a time. All limits are literals."""

import math
from dataclasses import replace
from typing import Any

from controllers.faults import Load, Memory
from controllers.gate import Gate
from controllers.governor import Travel
from controllers.limits import Limits
from controllers.messages import (
    FilterHealth,
    ForceEstimate,
    Proposal,
    Rule,
    Severity,
    Snapshot,
    Verdict,
)
from controllers.supervisor import RunningMove, Step, judge, watch
from drivers.contract.clock import ManualClock
from drivers.contract.messages import (
    ArmState,
    ForceSample,
    GripperState,
    Pose,
    StageCommand,
    StageState,
    Wrench,
)

NOW = 1_000_000_000
MS = 1_000_000
HOLD_POSE = Pose((0.0, 0.0, 0.0))
ZERO: Wrench = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
STD: Wrench = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)

LIMITS = Limits.model_validate(
    {
        "speed_limit_mm_s": 5.0,
        "angular_speed_limit_deg_s": 1.0,
        "arm_speed_limit_mm_s": 50.0,
        "step_box_um": (20.0, 20.0, 60.0),
        "rotation_step_limit_deg": 0.05,
        "workspace_min_um": (-200.0, -200.0, -1000.0),
        "workspace_max_um": (200.0, 200.0, 3600.0),
        "tilt_limit_deg": 0.6,
        "clear_depth_um": -100.0,
        "arm_tolerance_um": 5.0,
        "force_limit_mN": (70.0, 100.0, 1000.0),
        "force_rate_limit_N_s": 40.0,
        "gentle_force_mN": 44.0,
        "impulse_limit_mN_s": 10.0,
        "sample_age_limit_ms": 5.0,
        "device_age_limit_ms": 30.0,
        "proposal_age_limit_ms": 50.0,
        "heartbeat_limit_ms": 20.0,
        "reaction_time_ms": 2.0,
        "deceleration_mm_s2": 1000.0,
        "radial_stiffness_mN_um": 16.0,
        "axial_stiffness_mN_um": 4.0,
        "lever_um": 4000.0,
        "creep_speed_mm_s": 0.1,
        "uncertainty_sigmas": 3.0,
    }
)


def up(value: float) -> float:
    return math.nextafter(value, math.inf)


def down(value: float) -> float:
    return math.nextafter(value, -math.inf)


def sample(force: tuple[float, float, float] = (0.0, 0.0, 0.0), **changes: Any) -> ForceSample:
    return ForceSample(NOW, NOW, 1, (*force, 0.0, 0.0, 0.0))._replace(**changes)


def estimate(**changes: Any) -> ForceEstimate:
    return ForceEstimate(NOW, ZERO, ZERO, STD, 6.0, FilterHealth.OK)._replace(**changes)


def stage(depth_m: float = 1e-3, **changes: Any) -> StageState:
    rest = StageState(NOW, Pose((0.0, 0.0, depth_m)), (0.0,) * 3, (0.0,) * 3, False)
    return rest._replace(**changes)


def arm(**changes: Any) -> ArmState:
    return ArmState(NOW, HOLD_POSE, False)._replace(**changes)


def gripper(**changes: Any) -> GripperState:
    return GripperState(NOW, True, True)._replace(**changes)


def snapshot(**changes: Any) -> Snapshot:
    return Snapshot(NOW, sample(), ZERO, estimate(), stage(), arm(), gripper())._replace(**changes)


def load(
    stamp_ns: int,
    force: tuple[float, float, float],
    rate_N_s: float = 0.0,
    impulse_N_s: float = 0.0,
) -> Load:
    """Of a sensor without bias."""
    return Load(stamp_ns, force, force, rate_N_s, impulse_N_s)


def proposal(
    translation: tuple[float, float, float] = (0.0, 0.0, 60e-6), **changes: Any
) -> Proposal:
    return replace(Proposal(NOW, 1, "test", translation), **changes)


def watched(
    memory: Memory = Memory(), running: RunningMove | None = None, **changes: Any
) -> tuple[Verdict, Memory]:
    return watch(LIMITS, HOLD_POSE, memory, snapshot(**changes), running)


def judged(
    step: Proposal, standing: Verdict = Verdict(NOW), now_ns: int = NOW, **changes: Any
) -> tuple[Verdict, Step | None]:
    return judge(LIMITS, HOLD_POSE, standing, snapshot(**changes), step, now_ns)


def rules(verdict: Verdict) -> set[Rule]:
    return {reason.rule for reason in verdict.reasons}


def fires(rule: Rule, severity: Severity, **changes: Any) -> bool:
    verdict, _ = watched(**changes)
    fired = [reason for reason in verdict.reasons if reason.rule is rule]
    if not fired:
        assert verdict.severity is Severity.PASS, verdict
        return False
    assert fired[0].severity is severity
    assert verdict.severity is severity
    return True


def running(
    speed_m_s: float, translation: tuple[float, float, float] = (1e-5, 0.0, 0.0)
) -> RunningMove:
    travel = Travel.of(translation, (0.0, 0.0, 0.0), 4e-3)
    return RunningMove(travel, translation[2] < 0.0, speed_m_s)


class FakeStage:
    """Is wherever the test puts it and writes down every command."""

    def __init__(self) -> None:
        self.now = stage()
        self.moves: list[tuple[Pose, float, float]] = []
        self.slowed: list[tuple[float, float]] = []
        self.halts = 0

    def connect(self) -> None: ...

    def close(self) -> None: ...

    def state(self) -> StageState:
        return self.now

    def move_to(self, target: Pose, speed_m_s: float, angular_speed_rad_s: float) -> StageCommand:
        self.moves.append((target, speed_m_s, angular_speed_rad_s))
        return StageCommand(NOW, target, speed_m_s, angular_speed_rad_s)

    def slow_to(self, speed_m_s: float, angular_speed_rad_s: float) -> None:
        self.slowed.append((speed_m_s, angular_speed_rad_s))

    def halt(self) -> None:
        self.halts += 1


class FakeArm:
    """Is wherever the test puts it and writes down every command."""

    def __init__(self) -> None:
        self.now = arm()
        self.moves: list[tuple[Pose, float]] = []
        self.halts = 0

    def connect(self) -> None: ...

    def close(self) -> None: ...

    def state(self) -> ArmState:
        return self.now

    def move_to(self, target: Pose, speed_m_s: float) -> None:
        self.moves.append((target, speed_m_s))

    def halt(self) -> None:
        self.halts += 1


class FakeGripper:
    """Says what the test wants and writes down every command."""

    def __init__(self) -> None:
        self.now = gripper()
        self.valve: list[bool] = []

    def connect(self) -> None: ...

    def close(self) -> None: ...

    def state(self) -> GripperState:
        return self.now

    def set_valve(self, is_open: bool) -> None:
        self.valve.append(is_open)


class Bench:
    """A gate over fake actuators."""

    def __init__(self) -> None:
        self.stage, self.arm, self.gripper = FakeStage(), FakeArm(), FakeGripper()
        self.gate = Gate(LIMITS, HOLD_POSE, self.stage, self.arm, self.gripper)

    def see(
        self, now_ns: int = NOW, force: tuple[float, float, float] = (0.0, 0.0, 0.0)
    ) -> Snapshot:
        """Bring all states up to date, watch, and return what was watched."""
        self.stage.now = self.stage.now._replace(stamp_ns=now_ns)
        return self.look(now_ns, force)

    def look(
        self, now_ns: int = NOW, force: tuple[float, float, float] = (0.0, 0.0, 0.0)
    ) -> Snapshot:
        """The same with the stage's state as old as it is."""
        self.arm.now = self.arm.now._replace(stamp_ns=now_ns)
        self.gripper.now = self.gripper.now._replace(stamp_ns=now_ns)
        seen = self.gate.snapshot(
            ManualClock(now_ns),
            sample(force, stamp_ns=now_ns),
            ZERO,
            estimate(stamp_ns=now_ns, wrench=(*force, 0.0, 0.0, 0.0)),
        )
        self.gate.watch(seen)
        return seen


NOT_FINITE = (math.nan, math.inf, -math.inf)
