"""The whole mock cell on simulated time: what its users see of it."""

import re
import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from controllers.control_loop import Subscriber
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
from controllers.proportional import ProportionalController
from drivers.contract.clock import ManualClock
from drivers.contract.errors import ConfigurationError
from drivers.contract.messages import Pose, Vector3
from hil.cell import Cell
from hil.config import CellConfig, load_cell
from tests.hil.watched_cell import CONFIG, LIMITS_N, make_cell


@pytest.mark.slow
@pytest.mark.parametrize("part", ["paper_online", "paper_simulation"])
def test_the_expert_inserts_softly(part: str) -> None:
    cell, watcher, _ = make_cell(part=part)
    outcomes = [cell.insert_part(number) for number in range(1, 6)]
    assert [o.phase for o in outcomes] == [SkillPhase.DONE] * 5
    assert all(o.is_clear and o.reason == "" and o.steps <= 60 for o in outcomes)
    inside = watcher.force[np.array(watcher.depths) > 0.0]
    assert (np.abs(inside).max(axis=0) <= [0.100, 0.100, 0.090]).all()
    assert (np.hypot(inside[:, 0], inside[:, 1]) <= 0.044).mean() > 0.9
    assert max(watcher.severities) < Severity.STOP


class Starts(Subscriber):
    """Keeps where the stage is as each insertion begins."""

    def __init__(self) -> None:
        self.poses: list[Pose] = []
        self._pose = Pose()

    def on_tick(self, tick: Tick) -> None:
        if tick.snapshot.stage is not None:
            self._pose = tick.snapshot.stage.pose

    def on_phase(self, change: PhaseChange) -> None:
        if change.phase is SkillPhase.APPROACH:
            self.poses.append(self._pose)


@pytest.mark.slow
@pytest.mark.parametrize("fails", [False, True])
def test_each_insertion_begins_where_the_first_one_did(
    fails: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A controller that goes sideways and turns leaves nothing of it to the next part."""

    def step(self: ProportionalController, observation: Observation) -> Move:
        if observation.step >= 3:
            return Move((0.0, 0.0, 60e-6))
        return Move((0.7e-6, -1e-6, 60e-6), (3e-4, -6e-4, 0.0))

    monkeypatch.setattr(ProportionalController, "step", step)
    monkeypatch.setattr(
        "drivers.mock_world.initial_poses", lambda *_: np.array([[-1e-6, 2e-6, 0.0, 0.0, 0.0]])
    )

    def change(config: CellConfig) -> CellConfig:
        insertion = config.part.insertion.model_copy(update={"steps_max": 3 if fails else 1000})
        return replace(config, part=config.part.model_copy(update={"insertion": insertion}))

    cell, _, _ = make_cell(change=change)
    starts = Starts()
    cell.follow(starts)
    outcomes = [cell.insert_part(number) for number in range(1, 4)]
    assert all(outcome.is_clear for outcome in outcomes)
    assert {o.phase for o in outcomes} == {SkillPhase.FAILED if fails else SkillPhase.DONE}
    assert len(starts.poses) == 3
    for pose in starts.poses:
        assert pose.position == pytest.approx((0.0, 0.0, -300e-6), abs=0.2e-6)
        assert pose.rotation == pytest.approx((0.0, 0.0, 0.0), abs=1e-5)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(4))
def test_the_conventional_controller_oscillates_and_is_stopped_at_the_limit(seed: int) -> None:
    """No axis passes its limit by more than one sample's growth, and the verdict says which."""
    cell, watcher, _ = make_cell("p", seed, "paper_simulation")
    outcome = cell.insert_part(1)
    while outcome.is_clear:
        outcome = cell.insert_part(outcome.number + 1)
    assert outcome.phase is SkillPhase.FAILED
    assert outcome.reason.startswith("force limit: f_")
    force = watcher.force
    first_stop = watcher.severities.index(Severity.STOP)
    began = max(i for i in range(first_stop) if watcher.depths[i] < -200e-6)
    inserting = force[began : first_stop + 50]
    growth = np.abs(np.diff(inserting, axis=0)).max(axis=0)
    assert (np.abs(inserting).max(axis=0) <= LIMITS_N + growth).all()
    assert np.abs(force[first_stop:]).max() < 0.110
    # it swings from one side to the other before that
    radial = inserting[:, :2]
    assert (radial.max(axis=0) > 0.020).any()
    assert (radial.min(axis=0) < -0.020).any()


def test_the_same_seed_gives_the_same_run_and_another_seed_another() -> None:
    runs = []
    for seed in (5, 5, 6):
        cell, watcher, clock = make_cell(seed=seed)
        cell.insert_part(1)
        runs.append((watcher.forces, clock.now_ns()))
    assert runs[0] == runs[1]
    assert runs[0] != runs[2]


def test_an_unknown_controller_is_refused() -> None:
    with pytest.raises(
        ConfigurationError,
        match="controller 'ddpg' is not valid: one of expert, extended, look_ahead, p",
    ):
        make_cell("ddpg")


@pytest.mark.slow
@pytest.mark.parametrize("bias_N", [(0.080, -0.007, 0.030), (0.012, -0.007, 1.500)])
def test_any_bias_of_the_sensor_is_taken_before_the_force_counts(bias_N: Vector3) -> None:
    """Beyond the limits of 70 and 1000 mN, with nothing touching."""

    def biased(config: CellConfig) -> CellConfig:
        settings = config.force_sensor.settings.model_copy(update={"bias_N": bias_N})
        return replace(config, force_sensor=replace(config.force_sensor, settings=settings))

    cell, watcher, _ = make_cell(change=biased)
    assert cell.insert_part(1).phase is SkillPhase.DONE
    assert max(watcher.severities) < Severity.HOLD


def test_every_proposal_is_answered_and_tied_by_its_number() -> None:
    cell, _, _ = make_cell()
    proposed: list[int] = []
    sent: list[int] = []

    class Numbers(Subscriber):
        def on_proposal(self, observation: Observation, proposal: Proposal) -> None:
            proposed.append(proposal.number)

        def on_sent(self, answer: Sent) -> None:
            sent.append(answer.number)

    cell.follow(Numbers())
    cell.insert_part(1)
    assert proposed == sent == list(range(1, len(sent) + 1))


@pytest.mark.parametrize(
    ("file", "pattern", "text", "speed_m_s"),
    [
        ("mock_cell.yaml", r"speed_limit_mm_s: 5(?=\n  angular)", "speed_limit_mm_s: 2", 2e-3),
        ("parts/paper_online.yaml", r"\Z", "limits: {speed_limit_mm_s: 0.01}\n", 1e-5),
        ("mock_cell.yaml", r"settle_time_ms: 10", "settle_time_ms: 6000", 5e-3),
    ],
)
def test_slow_steps_take_their_time(
    tmp_path: Path, file: str, pattern: str, text: str, speed_m_s: float
) -> None:
    shutil.copytree(CONFIG, tmp_path / "config")
    shutil.copytree(CONFIG.parent / "policies", tmp_path / "policies")
    path = tmp_path / "config" / file
    path.write_text(re.sub(pattern, text, path.read_text(), count=1))
    config = load_cell(tmp_path / "config" / "mock_cell.yaml")
    cell = Cell(config, "expert", ManualClock(), np.random.default_rng(1))

    class EnoughError(Exception):
        pass

    speeds_m_s: list[float] = []

    class Steps(Subscriber):
        def on_sent(self, answer: Sent) -> None:
            speeds_m_s.append(answer.speed_m_s)
            if len(speeds_m_s) == 2:
                raise EnoughError

    cell.follow(Steps())
    cell.connect()
    with pytest.raises(EnoughError):
        cell.insert_part(1)
    assert 0.0 < speeds_m_s[0] <= speed_m_s
