"""A made-up run: what a recorder is told, call by call, with every kind of traffic.

Every 150 ms other parts of the loop are silent, so that no kind of call can leave it to another to
bring the log to the disk.
"""

import random
from collections.abc import Callable, Iterator
from dataclasses import dataclass

from controllers.messages import (
    ContactBelief,
    FilterHealth,
    ForceEstimate,
    Observation,
    PhaseChange,
    Proposal,
    Reason,
    ResetRecord,
    Rule,
    Sent,
    Severity,
    SkillPhase,
    Snapshot,
    Tick,
    Verdict,
)
from drivers.contract.messages import (
    ArmState,
    ForceSample,
    GripperState,
    Pose,
    SensorStatus,
    StageState,
)
from hil.log_reader import Log
from hil.recorder import Recorder
from hil.ros_messages import ContactTruth

MS = 1_000_000
START_NS = 1_700_000_000_000_000_000
LATENCY_NS = MS // 2
METADATA = {
    "configuration": {"file": "cell.yaml", "text": "hole_diameter_um: 1010\n"},
    "run": {"seed": "7", "operator": "Zoë"},
}

_SEGMENT_MS = 150
_SEGMENTS = (
    {"sample", "tick", "proposal", "truth"},
    {"tick"},
    {"sample"},
    {"proposal"},
    {"sample", "tick"},
    {"truth"},
)


@dataclass(frozen=True)
class Call:
    """One call of a recorder's method, at a time of the host's clock."""

    time_ns: int
    make: Callable[[Recorder], None]


def calls(seed: int, milliseconds: int) -> Iterator[Call]:
    """Yield the run's calls in order; the same arguments give the same calls."""
    rng = random.Random(seed)  # noqa: S311, no secret
    snapshot = Snapshot(START_NS, None, (0.0,) * 6, None, None, None, None)
    number = 0
    for ms in range(milliseconds):
        now_ns = START_NS + ms * MS
        active = _SEGMENTS[ms // _SEGMENT_MS % len(_SEGMENTS)]
        if ms % 400 == 40:
            yield Call(now_ns, _phase(now_ns, ms))
        if "sample" in active:
            sample = _sample(rng, now_ns, ms)
            snapshot = _snapshot(rng, now_ns, sample)
            yield Call(now_ns, lambda recorder, sample=sample: recorder.on_sample(sample))
        if "truth" in active:
            shaft = Pose((1e-6, 0.0, ms * 1e-6), (0.001, 0.0, 0.0))
            truth = ContactTruth(
                now_ns, "b", "upper hole", ms // 40, ms * 1e-6, _wrench(rng), shaft
            )
            yield Call(now_ns, lambda recorder, truth=truth: recorder.on_truth(truth))
        if "tick" in active:
            snapshot = snapshot._replace(now_ns=now_ns)
            tick = _tick(rng, now_ns, snapshot)
            yield Call(tick.end_ns, lambda recorder, tick=tick: recorder.on_tick(tick))
        if "proposal" in active and ms % 20 == 7:
            number += 1
            yield from _step(rng, now_ns + MS // 4, number)


def rows(log: Log) -> dict[str, list[tuple[int, object]]]:
    """Return all that a log holds: for each kind, when the host heard of it, and what."""
    raw, stage, twist = log.raw_force, log.stage_pose, log.stage_twist
    found: dict[str, list[tuple[int, object]]] = {
        "raw force": [
            (receipt_ns, row)
            for receipt_ns, *row in zip(
                raw.receipts_ns.tolist(),
                raw.stamps_ns.tolist(),
                raw.sequences.tolist(),
                raw.wrench.tolist(),
                strict=True,
            )
        ],
        "bias": list(
            zip(log.force_bias.stamps_ns.tolist(), log.force_bias.wrench.tolist(), strict=True)
        ),
        "stage position": list(zip(stage.stamps_ns.tolist(), stage.position.tolist(), strict=True)),
        "stage rotation": list(zip(stage.stamps_ns.tolist(), stage.rotation.tolist(), strict=True)),
        "stage velocity": list(zip(twist.stamps_ns.tolist(), twist.velocity.tolist(), strict=True)),
        "arm": list(
            zip(log.arm_pose.stamps_ns.tolist(), log.arm_pose.position.tolist(), strict=True)
        ),
    }
    for name in (
        "estimates",
        "observations",
        "beliefs",
        "proposals",
        "phases",
        "verdicts",
        "sent",
        "resets",
        "timings",
        "contact_states",
        "device_statuses",
    ):
        found[name] = [(value.stamp_ns, value) for value in getattr(log, name)]
    return found


def _wrench(rng: random.Random) -> tuple[float, float, float, float, float, float]:
    fx, fy, fz, tx, ty, tz = (rng.gauss(0.0, 0.03) for _ in range(6))
    return (fx, fy, fz, tx, ty, tz)


def _sample(rng: random.Random, now_ns: int, ms: int) -> ForceSample:
    status = SensorStatus.SATURATED if ms % 190 < 3 else SensorStatus.OK
    return ForceSample(now_ns - LATENCY_NS, now_ns, ms, _wrench(rng), status)


def _snapshot(rng: random.Random, now_ns: int, sample: ForceSample) -> Snapshot:
    health = FilterHealth.REJECTED if rng.random() < 0.02 else FilterHealth.OK
    depth_m = (now_ns - START_NS) * 1e-12
    return Snapshot(
        now_ns=now_ns,
        sample=sample,
        bias=(0.001, -0.002, 0.0, 0.0, 0.0, 1e-5) if sample.sequence > 20 else (0.0,) * 6,
        estimate=ForceEstimate(now_ns, _wrench(rng), _wrench(rng), _wrench(rng), 5.5, health),
        stage=StageState(
            now_ns,
            Pose((1e-6, 0.0, depth_m), (0.001, 0.0, 0.0)),
            (0.0, 0.0, 1e-3),
            (0.0,) * 3,
            True,
        ),
        arm=ArmState(now_ns, Pose((0.1, 0.2, 0.3)), moving=False),
        gripper=GripperState(now_ns, valve_open=True, part_held=True),
    )


def _tick(rng: random.Random, now_ns: int, snapshot: Snapshot) -> Tick:
    reasons = (Reason(Rule.FORCE, Severity.HOLD, "f_x 80 mN over 70 mN"),)
    verdict = Verdict(now_ns, reasons if rng.random() < 0.05 else ())
    return Tick(snapshot, verdict, now_ns, now_ns + rng.randrange(20_000, 60_000))


def _step(rng: random.Random, now_ns: int, number: int) -> Iterator[Call]:
    pose = Pose((0.0, 0.0, number * 1e-5))
    observation = Observation(
        now_ns, number - 1, _wrench(rng), _wrench(rng), pose, (0.0, 0.0, number * 1e-5), pose
    )
    belief = ContactBelief(
        now_ns, tuple(rng.random() for _ in range(7)), (0.5,) * 49, "free", 0.75, 6.0, number % 2
    )
    proposal = Proposal(now_ns, number, "expert", (1e-6, -2e-6, 5e-5))
    reasons = (Reason(Rule.GOVERNOR, Severity.REDUCE, "speed 5 mm/s over 2 mm/s"),)
    target = None if number % 5 == 0 else pose
    sent = Sent(now_ns + 5_000, number, Verdict(now_ns, reasons, 0.002), target, (0.0, 0.0, 5e-5))
    yield Call(now_ns, lambda recorder: recorder.on_belief(belief))
    yield Call(now_ns, lambda recorder: recorder.on_proposal(observation, proposal))
    yield Call(now_ns + 5_000, lambda recorder: recorder.on_sent(sent))


def _phase(now_ns: int, ms: int) -> Callable[[Recorder], None]:
    if ms == 440:
        cleared = (Reason(Rule.IMPULSE, Severity.STOP, "30 mN s over 20 mN s"),)
        return lambda recorder: recorder.on_reset(ResetRecord(now_ns, "Zoë", cleared))
    change = PhaseChange(now_ns, 1 + ms // 400, SkillPhase.INSERT, "", ms // 40)
    return lambda recorder: recorder.on_phase(change)
