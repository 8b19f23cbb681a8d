"""While a controller thinks the cell is watched, and what it then proposes rests on the newest."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from controllers.control_loop import Subscriber
from controllers.insertion import Controller
from controllers.messages import (
    Move,
    Observation,
    PhaseChange,
    Proposal,
    Sent,
    Severity,
    SkillPhase,
    Tick,
)
from drivers.contract.clock import ManualClock
from drivers.contract.messages import ForceSample
from drivers.force_sensor.mock import MockForceSensor
from hil.cell import Cell
from hil.config import load_cell

CONFIG = Path(__file__).parents[2] / "config"
MS = 1_000_000
PIECES = 7


class Thinker(Controller):
    """Goes straight in, and takes its time over each step."""

    def __init__(self, clock: ManualClock) -> None:
        self.clock = clock
        self.pieces = PIECES
        self.piece_ns = 0
        self.thought: list[Observation] = []
        self.answered: list[Observation] = []

    def think(self, observation: Observation) -> Iterator[None]:
        self.thought.append(observation)
        for _ in range(self.pieces):
            self.clock.sleep_until_ns(self.clock.now_ns() + self.piece_ns)
            yield

    def step(self, observation: Observation) -> Move:
        self.answered.append(observation)
        return Move((0.0, 0.0, 60e-6))


class Notes(Subscriber):
    def __init__(self) -> None:
        self.stamps_ns: list[int] = []
        self.sent: list[Sent] = []
        self.phases: list[PhaseChange] = []
        self.proposals: list[Proposal] = []
        self.severities: list[Severity] = []

    def on_tick(self, tick: Tick) -> None:
        self.severities.append(tick.verdict.severity)
        self.stamps_ns.append(tick.start_ns)

    def on_proposal(self, observation: Observation, proposal: Proposal) -> None:
        self.proposals.append(proposal)

    def on_sent(self, sent: Sent) -> None:
        self.sent.append(sent)

    def on_phase(self, change: PhaseChange) -> None:
        self.phases.append(change)


def thinking_cell(monkeypatch: pytest.MonkeyPatch) -> tuple[Cell, Thinker, Notes]:
    clock = ManualClock()
    cell = Cell(load_cell(CONFIG / "mock_cell.yaml"), "expert", clock, np.random.default_rng(1))
    thinker, notes = Thinker(clock), Notes()
    monkeypatch.setattr(cell, "_new_controller", lambda: thinker)
    cell.follow(notes)
    cell.connect()
    return cell, thinker, notes


def test_each_pause_is_a_turn_of_the_loop(monkeypatch: pytest.MonkeyPatch) -> None:
    cell, thinker, notes = thinking_cell(monkeypatch)
    assert cell.insert_part(1).phase is SkillPhase.DONE
    assert len(thinker.thought) == len(thinker.answered) == 54
    for thought, answered in zip(thinker.thought, thinker.answered, strict=True):
        assert answered.stamp_ns - thought.stamp_ns == PIECES * MS
        assert (answered.pose, answered.step) == (thought.pose, thought.step)
        inside = [s for s in notes.stamps_ns if thought.stamp_ns < s <= answered.stamp_ns]
        assert len(inside) == PIECES
    proposed = {p.stamp_ns for p in notes.proposals}
    assert {observation.stamp_ns for observation in thinker.answered} <= proposed


def test_a_long_piece_leaves_no_sample_behind(monkeypatch: pytest.MonkeyPatch) -> None:
    """A piece of 4.5 ms is followed by five turns: four for what came meanwhile, one more."""
    cell, thinker, notes = thinking_cell(monkeypatch)
    thinker.piece_ns = 4 * MS + MS // 2
    assert cell.insert_part(1).phase is SkillPhase.DONE
    assert max(notes.severities) < Severity.HOLD
    for thought, answered in zip(thinker.thought, thinker.answered, strict=True):
        inside = [s for s in notes.stamps_ns if thought.stamp_ns < s <= answered.stamp_ns]
        assert len(inside) == 5 * PIECES


def test_it_thinks_in_the_part_only(monkeypatch: pytest.MonkeyPatch) -> None:
    cell, thinker, notes = thinking_cell(monkeypatch)
    cell.insert_part(1)
    insert, done = (c.stamp_ns for c in notes.phases if c.phase in ("insert", "done"))
    assert thinker.thought[0].stamp_ns == insert - PIECES * MS
    assert thinker.answered[-1].stamp_ns < done


@pytest.mark.parametrize(
    ("push_N", "samples", "severity", "reason", "answers"),
    [
        (0.200, 1, Severity.STOP, "force limit: f_x = ", 9),
        (0.065, 700, Severity.RETREAT, "impulse", 10),
    ],
)
def test_a_load_that_comes_and_goes_while_it_thinks_ends_the_insertion(
    push_N: float,
    samples: int,
    severity: Severity,
    reason: str,
    answers: int,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """After a stop nothing is proposed any more; after a retreat the next step is the last one."""
    cell, thinker, notes = thinking_cell(monkeypatch)
    read, pushes = MockForceSensor.read, 0

    def pushed(sensor: MockForceSensor, timeout_s: float) -> ForceSample:
        nonlocal pushes
        sample = read(sensor, timeout_s)
        if len(thinker.thought) == 10 and len(thinker.answered) == 9 and pushes < samples:
            pushes += 1
            fx, fy, fz, tx, ty, tz = sample.wrench
            return sample._replace(wrench=(fx + push_N, fy, fz, tx, ty, tz))
        return sample

    monkeypatch.setattr(MockForceSensor, "read", pushed)
    thinker.pieces = 1000
    outcome = cell.insert_part(1)
    assert max(notes.severities) is severity
    assert outcome.phase is SkillPhase.FAILED
    assert reason in outcome.reason
    assert len(thinker.answered) == answers


def test_a_cell_that_has_stopped_is_not_thought_about(monkeypatch: pytest.MonkeyPatch) -> None:
    """What stopped it may be a reading that nobody can think about."""
    cell, thinker, _ = thinking_cell(monkeypatch)
    read = MockForceSensor.read

    def broken(sensor: MockForceSensor, timeout_s: float) -> ForceSample:
        sample = read(sensor, timeout_s)
        if len(thinker.answered) >= 5:
            return sample._replace(wrench=(float("nan"), *sample.wrench[1:]))
        return sample

    monkeypatch.setattr(MockForceSensor, "read", broken)
    outcome = cell.insert_part(1)
    assert outcome.phase is SkillPhase.FAILED
    assert outcome.reason.startswith("non-finite value")
    assert len(thinker.thought) == len(thinker.answered) == 5
