"""What tests put before a gate: commands, faults and loads; and what came of them."""

import math

from controllers.messages import Sent, Severity, Snapshot
from drivers.contract.messages import Pose, Vector3
from tests.controllers.builders import MS, NOW, Bench, proposal, sample, stage

OUT_AND_CALM = stage(-300e-6)


def commands(bench: Bench) -> list[object]:
    """Everything that has reached an actuator, halts aside."""
    return [*bench.stage.moves, *bench.arm.moves, *bench.gripper.valve]


def send(bench: Bench, translation: Vector3 = (0.0, 0.0, 60e-6), now_ns: int = NOW) -> Sent:
    seen = bench.see(now_ns)
    return bench.gate.send_step(proposal(translation, stamp_ns=now_ns), seen, now_ns)


def send_in(bench: Bench, seen: Snapshot) -> None:
    bench.gate.send_step(proposal(), seen, NOW)


def send_away(bench: Bench, seen: Snapshot) -> None:
    bench.gate.send_arm(Pose((0.1, 0.0, 0.0)), seen)


def pick(bench: Bench, seen: Snapshot) -> None:
    bench.gate.send_valve(True, seen)


def let_go(bench: Bench, seen: Snapshot) -> None:
    bench.gate.send_valve(False, seen)


def send_nan(bench: Bench, seen: Snapshot) -> None:
    bench.gate.send_step(proposal((math.nan, 0.0, 0.0)), seen, NOW)


def halt(bench: Bench, seen: Snapshot) -> None:
    bench.gate.hold()


def overload(bench: Bench, start_ns: int, ticks: int) -> int:
    """Hold 60 mN for so many steps of 5 ms; 10 mN s are full after 625 ms."""
    for tick in range(ticks):
        bench.see(start_ns + tick * 5 * MS, (0.060, 0.0, 0.0))
    return start_ns + ticks * 5 * MS


def stale(bench: Bench, now_ns: int) -> Snapshot:
    """Watch a cell whose only fault is an old force sample: a hold."""
    seen = bench.see(now_ns)._replace(sample=sample(stamp_ns=now_ns - 6 * MS))
    assert bench.gate.watch(seen).severity is Severity.HOLD
    return seen
