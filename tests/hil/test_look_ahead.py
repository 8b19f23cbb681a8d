"""The cell led by a controller that believes and looks ahead."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from controllers.belief_controller import BeliefController
from controllers.control_loop import Subscriber
from controllers.messages import ContactBelief, Sent, Severity, SkillPhase, Tick
from drivers.contract.clock import ManualClock
from drivers.contract.errors import ConfigurationError
from drivers.contract.messages import Pose, StageCommand
from drivers.stage.mock import MockStage
from hil.cell import Cell
from hil.config import CellConfig, load_cell
from hil.log_file import LogFile
from hil.log_reader import read_log
from hil.metadata import metadata
from hil.recorder import Recorder
from hil.truth_probe import TruthProbe

CONFIG = Path(__file__).parents[2] / "config"


def quick(config: CellConfig) -> CellConfig:
    """The same cell with fewer hypotheses."""
    choice = config.controllers["look_ahead"]
    assert not isinstance(choice, tuple)
    few = choice.model_copy(update={"hypotheses": 128, "samples": 32})  # type: ignore[union-attr]
    return replace(config, controllers={**config.controllers, "look_ahead": few})


def cell_of(
    seed: int, part: str = "paper_simulation", change: Callable[[CellConfig], CellConfig] = quick
) -> Cell:
    config = change(load_cell(CONFIG / "mock_cell.yaml", CONFIG / "parts" / f"{part}.yaml"))
    return Cell(config, "look_ahead", ManualClock(), np.random.default_rng(seed))


class Notes(Subscriber):
    """Keeps beliefs, targets, and the radial force of every tick in the part."""

    def __init__(self) -> None:
        self.beliefs: list[ContactBelief] = []
        self.targets: list[Pose | None] = []
        self.radial_N: list[float] = []
        self.severities: list[Severity] = []

    def on_belief(self, belief: ContactBelief) -> None:
        self.beliefs.append(belief)

    def on_sent(self, sent: Sent) -> None:
        self.targets.append(sent.target)

    def on_tick(self, tick: Tick) -> None:
        sample, stage = tick.snapshot.sample, tick.snapshot.stage
        if sample is not None and stage is not None and stage.pose.position[2] > 0.0:
            force = np.subtract(sample.wrench[:2], tick.snapshot.bias[:2])
            self.radial_N.append(float(np.hypot(*force)))
            self.severities.append(tick.verdict.severity)


@pytest.mark.slow
def test_it_inserts_gently_what_is_10_um_and_a_third_of_a_degree_off() -> None:
    cell, notes = cell_of(1, change=lambda config: config), Notes()
    cell.follow(notes)
    cell.connect()
    outcomes = [cell.insert_part(number) for number in range(1, 4)]
    assert [o.phase for o in outcomes] == [SkillPhase.DONE] * 3
    assert all(o.is_clear and o.steps <= 60 for o in outcomes)
    assert max(notes.radial_N) < 0.060
    assert max(notes.severities) < Severity.HOLD
    error = cell.world._error[[0, 1, 3, 4]]
    believed = notes.beliefs[-1]
    assert (np.abs(error - believed.mean[:4]) <= 4.0 * np.array(believed.std[:4])).all()


@pytest.mark.slow
def test_the_same_seed_gives_the_same_run_and_another_seed_another() -> None:
    runs = []
    for seed in (5, 5, 6):
        cell, notes = cell_of(seed), Notes()
        cell.follow(notes)
        cell.connect()
        cell.insert_part(1)
        runs.append((notes.targets, notes.beliefs))
    assert runs[0] == runs[1]
    assert runs[0] != runs[2]


@pytest.mark.slow
def test_the_chance_of_a_controller_is_none_of_the_parts() -> None:
    """Which errors alignment leaves does not depend on who inserts."""
    errors = []
    for name in ("expert", "look_ahead"):
        config = quick(load_cell(CONFIG / "mock_cell.yaml"))
        cell = Cell(config, name, ManualClock(), np.random.default_rng(4))
        cell.connect()
        cell._switch_valve(True)
        errors.append(cell.world._error.tolist())
    assert errors[0] == errors[1]


@pytest.mark.slow
def test_a_stage_that_halts_half_way_is_where_it_reports(monkeypatch: pytest.MonkeyPatch) -> None:
    """One step is made by half: what was commanded no longer counts, and the part goes in."""
    cell = cell_of(2)
    made: list[BeliefController] = []
    new = cell._new_controller

    def kept() -> BeliefController:
        controller = new()
        assert isinstance(controller, BeliefController)
        made.append(controller)
        return controller

    monkeypatch.setattr(cell, "_new_controller", kept)
    move_to, moves = MockStage.move_to, 0
    taken, reported = [], []

    def move(stage: MockStage, target: Pose, *speeds: float) -> StageCommand:
        nonlocal moves
        moves += 1
        start = stage.state().pose
        if moves > 16:
            taken.append(made[0]._filter.pose)
            reported.append([*start.position, *start.rotation[:2]])
        if moves == 16:
            half = (0.5 * (s + t) for s, t in zip(start.position, target.position, strict=True))
            x, y, z = half
            target = Pose((x, y, z), start.rotation)
        return move_to(stage, target, *speeds)

    monkeypatch.setattr(MockStage, "move_to", move)
    cell.connect()
    assert cell.insert_part(1).phase is SkillPhase.DONE
    np.testing.assert_allclose(np.array(taken[:20]), np.array(reported[:20]), atol=3e-7)


@pytest.mark.slow
def test_beliefs_and_the_truth_about_them_are_logged(tmp_path: Path) -> None:
    cell, notes, path = cell_of(3), Notes(), tmp_path / "run.mcap"
    about = metadata(cell._config, "look_ahead", 1, 3, real_time=False)
    recorder = Recorder(LogFile(path, about))
    for subscriber in (recorder, TruthProbe(cell.world, recorder), notes):
        cell.follow(subscriber)
    cell.connect()
    outcome = cell.insert_part(1)
    error = cell.world._error[[0, 1, 3, 4]]
    recorder.close()
    log = read_log(path)
    assert log.beliefs == tuple(notes.beliefs)
    assert len(log.beliefs) == outcome.steps
    seen = {observation.stamp_ns: observation for observation in log.observations}
    truths = {truth.stamp_ns: truth for truth in log.contact_states}
    for belief in log.beliefs:
        shaft, stage = truths[belief.stamp_ns].shaft, seen[belief.stamp_ns].pose
        offset = np.subtract(shaft.position, stage.position)[:2]
        tilt = np.subtract(shaft.rotation, stage.rotation)[:2]
        np.testing.assert_allclose([*offset, *tilt], error, atol=1e-12)
    foreseen = [p.expected_force for p in log.proposals if p.source == "look_ahead"]
    assert np.any(foreseen)
    commanded = [observation.commanded for observation in log.observations]
    assert commanded[0] == log.observations[0].pose
    assert commanded[1:] == [sent.target for sent in log.sent][:-1]


@pytest.mark.parametrize(
    ("change", "problem"),
    [
        (
            {"axial_step_m": (5e-6, 61e-6)},
            "axial_step_um = [5, 61] is not valid: must not exceed the limit "
            "step_box_um = [20, 20, 60] along z",
        ),
        (
            {"clearance_m": (-1e-3, 1e-5)},
            "clearance_um = [-1000, 10] is not valid: must be greater than -1000, "
            "at which the narrowest hole is closed",
        ),
    ],
)
def test_what_does_not_fit_limits_or_part_is_refused(
    change: dict[str, tuple[float, float]], problem: str
) -> None:
    def spoil(config: CellConfig) -> CellConfig:
        choice = config.controllers["look_ahead"].model_copy(update=change)  # type: ignore[union-attr]
        return replace(config, controllers={**config.controllers, "look_ahead": choice})

    with pytest.raises(ConfigurationError) as caught:
        cell_of(1, change=spoil)
    assert str(caught.value) == f"{CONFIG / 'mock_cell.yaml'}: controllers.look_ahead.{problem}"
