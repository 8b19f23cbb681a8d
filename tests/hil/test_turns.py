"""A controller that turns the shaft: what it proposes is judged, sent, made and logged."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from controllers.control_loop import Subscriber
from controllers.messages import Move, Observation, Proposal, Sent, SkillPhase
from controllers.proportional import ProportionalController
from drivers.contract.clock import ManualClock
from drivers.contract.messages import Vector3
from hil.cell import Cell
from hil.config import CellConfig, load_cell
from hil.log_file import LogFile
from hil.log_reader import read_log
from hil.metadata import metadata
from hil.recorder import Recorder

CONFIG = Path(__file__).parents[2] / "config"


def aligned() -> CellConfig:
    """The mock cell with parts that need no correction."""
    config = load_cell(CONFIG / "mock_cell.yaml")
    alignment = config.part.alignment.model_copy(
        update={"position_error_m": 0.0, "tilt_error_rad": 0.0}
    )
    return replace(config, part=config.part.model_copy(update={"alignment": alignment}))


class Turns(Subscriber):
    """Keeps the rotations that were seen, proposed and sent in the insert phase."""

    def __init__(self) -> None:
        self.seen: list[Vector3] = []
        self.proposed: list[Vector3] = []
        self.sent: list[Vector3] = []

    def on_proposal(self, observation: Observation, proposal: Proposal) -> None:
        if observation.depth_m > -25e-6 and proposal.source == "expert":
            self.seen.append(observation.pose.rotation)
            self.proposed.append(proposal.rotation)

    def on_sent(self, sent: Sent) -> None:
        if len(self.sent) < len(self.proposed):
            self.sent.append(sent.rotation)


def swaying(turn_rad: float, monkeypatch: pytest.MonkeyPatch) -> None:
    """Lets the expert turn to and fro about x, and once about y."""

    def step(self: ProportionalController, observation: Observation) -> Move:
        sign = 1.0 if observation.step % 2 == 0 else -1.0
        about_y = 1e-4 if observation.step == 0 else 0.0
        return Move((0.0, 0.0, 60e-6), (sign * turn_rad, about_y, 0.0))

    monkeypatch.setattr(ProportionalController, "step", step)


@pytest.mark.slow
def test_turns_reach_the_stage_and_the_log(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """2 mrad are cut to 0.05 degrees, which are 0.87 mrad."""
    swaying(2e-3, monkeypatch)
    config = aligned()
    cell = Cell(config, "expert", ManualClock(), np.random.default_rng(1))
    path = tmp_path / "run.mcap"
    recorder = Recorder(LogFile(path, metadata(config, "expert", 1, 1, real_time=False)))
    turns = Turns()
    cell.follow(recorder)
    cell.follow(turns)
    cell.connect()
    outcome = cell.insert_part(1)
    recorder.close()
    assert outcome.phase is SkillPhase.DONE
    assert turns.proposed[:2] == [(2e-3, 1e-4, 0.0), (-2e-3, 0.0, 0.0)]
    assert turns.sent[0] == pytest.approx((8.7266e-4, 1e-4, 0.0), abs=1e-8)
    made = np.cumsum(turns.sent, axis=0)
    assert np.array(turns.seen)[1:] == pytest.approx(made[:-1], abs=1e-9)
    log = read_log(path)
    inserting = [p for p in log.proposals if p.source == "expert" and any(p.rotation)]
    assert [p.rotation for p in inserting] == turns.proposed
    numbers = {p.number for p in inserting}
    assert [s.rotation for s in log.sent if s.number in numbers] == turns.sent


def test_a_turn_that_is_not_finite_stops_the_cell(monkeypatch: pytest.MonkeyPatch) -> None:
    swaying(float("nan"), monkeypatch)
    cell = Cell(aligned(), "expert", ManualClock(), np.random.default_rng(1))
    cell.connect()
    outcome = cell.insert_part(1)
    assert outcome.phase is SkillPhase.FAILED
    assert outcome.reason.startswith("non-finite value: proposal (0.0, 0.0, 6e-05), (nan, ")
