"""Commands that tests give a gate, and what came of them."""

import math

from controllers.messages import Snapshot
from drivers.contract.messages import Pose
from tests.controllers.builders import (
    NOW,
    Bench,
    proposal,
)


def commands(bench: Bench) -> list[object]:
    """Everything that has reached an actuator, halts aside."""
    return [*bench.stage.moves, *bench.arm.moves, *bench.gripper.valve]


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
