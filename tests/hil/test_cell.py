"""The whole mock cell on simulated time: what its users see of it."""

import re
import shutil
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import cast

import numpy as np
import pytest
from numpy.typing import NDArray

from controllers.control_loop import Subscriber
from controllers.messages import (
    Move,
    Observation,
    PhaseChange,
    Proposal,
    ResetRecord,
    Rule,
    Sent,
    Severity,
    SkillPhase,
    Tick,
)
from controllers.proportional import ProportionalController
from drivers.contract.clock import ManualClock
from drivers.contract.errors import (
    ConfigurationError,
    DeviceError,
    DeviceTimeoutError,
    SafetyError,
)
from drivers.contract.messages import ForceSample, Pose, StageCommand, Vector3
from drivers.force_sensor.mock import MockForceSensor
from drivers.stage.mock import MockStage
from hil.cell import Cell
from hil.config import CellConfig, load_cell

CONFIG = Path(__file__).parents[2] / "config"
LIMITS_N = np.array([0.070, 0.100, 1.000])


@dataclass
class Watcher(Subscriber):
    """Keeps raw force less bias, verdicts and phases of every tick."""

    forces: list[Vector3] = field(default_factory=list)
    severities: list[Severity] = field(default_factory=list)
    depths: list[float] = field(default_factory=list)

    def on_tick(self, tick: Tick) -> None:
        sample, stage = tick.snapshot.sample, tick.snapshot.stage
        if sample is not None and stage is not None:
            fx, fy, fz = (
                w - b for w, b in zip(sample.wrench[:3], tick.snapshot.bias[:3], strict=True)
            )
            self.forces.append((fx, fy, fz))
            self.severities.append(tick.verdict.severity)
            self.depths.append(stage.pose.position[2])

    @property
    def force(self) -> NDArray[np.float64]:
        return np.array(self.forces)


def make_cell(
    controller: str = "expert",
    seed: int = 1,
    part: str = "paper_online",
    change: Callable[[CellConfig], CellConfig] = lambda config: config,
) -> tuple[Cell, Watcher, ManualClock]:
    clock = ManualClock()
    config = change(load_cell(CONFIG / "mock_cell.yaml", CONFIG / "parts" / f"{part}.yaml"))
    cell = Cell(config, controller, clock, np.random.default_rng(seed))
    watcher = Watcher()
    cell.follow(watcher)
    cell.connect()
    return cell, watcher, clock


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
        ConfigurationError, match="controller 'ddpg' is not valid: one of expert, look_ahead, p"
    ):
        make_cell("ddpg")


def at(ms: int, watcher: Watcher, act: Callable[[], None]) -> Subscriber:
    """Do something once, so many samples after the shaft has gone in."""

    class Once(Subscriber):
        def on_tick(self, tick: Tick) -> None:
            inside = sum(depth > 0.0 for depth in watcher.depths[-ms:])
            if inside == ms:
                watcher.depths.append(-1.0)
                act()

    return Once()


def test_a_silent_sensor_holds_the_cell_and_the_insertion_is_given_up(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    cell, watcher, clock = make_cell()
    ticks: list[Tick] = []

    class Keeper(Subscriber):
        def on_tick(self, tick: Tick) -> None:
            ticks.append(tick)

    cell.follow(Keeper())

    def silence() -> None:
        def read(sensor: MockForceSensor, timeout_s: float) -> None:
            clock.sleep_until_ns(clock.now_ns() + round(timeout_s * 1e9))
            raise DeviceTimeoutError("unplugged")

        monkeypatch.setattr(MockForceSensor, "read", read)

    cell.follow(at(100, watcher, silence))
    outcome = cell.insert_part(1)
    assert outcome.phase is SkillPhase.FAILED
    assert outcome.reason.startswith("held too long: ")
    assert not outcome.is_clear
    stage = ticks[-1].snapshot.stage
    assert stage is not None
    assert not stage.moving
    held = next(i for i, t in enumerate(ticks) if t.verdict.severity is Severity.HOLD)
    silent_since = ticks[held - 1].end_ns
    assert ticks[held].start_ns - silent_since <= 3_000_000
    assert "filter health" in str(ticks[held].verdict.reasons)


def test_a_lost_part_stops_the_cell() -> None:
    cell, watcher, _ = make_cell()
    gripper = cell._devices[3]
    cell.follow(at(100, watcher, lambda: setattr(gripper, "_held_from_ns", None)))
    outcome = cell.insert_part(1)
    assert outcome.phase is SkillPhase.FAILED
    # the valve's telemetry follows within 8 ms
    assert outcome.reason == "vacuum lost: stage in the part, part not held"
    assert not outcome.is_clear


def test_after_a_stop_nothing_more_is_done_until_a_reset() -> None:
    cell, watcher, _ = make_cell()
    gripper = cell._devices[3]
    cell.follow(at(100, watcher, lambda: setattr(gripper, "_held_from_ns", None)))
    cell.insert_part(1)
    with pytest.raises(SafetyError, match="vacuum lost"):
        cell.insert_part(2)


def test_an_operators_reset_is_told_and_clears_the_stop() -> None:
    """Force beyond the limit once, clear of the part; then the same cell inserts."""
    cell, _, clock = make_cell()
    records: list[ResetRecord] = []

    class Resets(Subscriber):
        def on_reset(self, record: ResetRecord) -> None:
            records.append(record)

    cell.follow(Resets())
    assert cell.insert_part(1).is_clear
    sensor = cast(MockForceSensor, cell._devices[0])
    read = sensor.read

    def pushed(timeout_s: float) -> ForceSample:
        sensor.read = read  # type: ignore[method-assign]
        return read(timeout_s)._replace(wrench=(1.0, 0.0, 0.0, 0.0, 0.0, 0.0))

    sensor.read = pushed  # type: ignore[method-assign]
    for _ in range(2):
        with pytest.raises(SafetyError, match="force limit: f_x = "):
            cell.insert_part(2)
    assert cell.reset("A. Operator") is records[0]
    assert (records[0].operator, records[0].stamp_ns) == ("A. Operator", clock.now_ns())
    assert [reason.rule for reason in records[0].cleared] == [Rule.FORCE]
    assert cell.insert_part(2).phase is SkillPhase.DONE


def test_a_device_that_fails_ends_the_run_and_the_cell_is_held(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    cell, watcher, _ = make_cell()
    halts: list[int] = []
    halt = MockStage.halt

    def noted(stage: MockStage) -> None:
        halts.append(1)
        halt(stage)

    def broken(stage: MockStage, *_: object) -> StageCommand:
        raise DeviceError("controller error 1024")

    monkeypatch.setattr(MockStage, "halt", noted)
    cell.follow(at(100, watcher, lambda: monkeypatch.setattr(MockStage, "move_to", broken)))
    with pytest.raises(DeviceError, match="1024"):
        cell.insert_part(1)
    cell.close()
    assert halts


def test_a_controller_that_goes_mad_is_stopped(monkeypatch: pytest.MonkeyPatch) -> None:
    cell, _, _ = make_cell()
    monkeypatch.setattr(
        ProportionalController, "step", lambda self, observation: Move((float("nan"), 0.0, 60e-6))
    )
    outcome = cell.insert_part(1)
    assert outcome.phase is SkillPhase.FAILED
    assert outcome.reason.startswith("non-finite value: proposal (nan, 0.0, ")


def test_a_part_off_its_place_is_felt_and_led_back_out(monkeypatch: pytest.MonkeyPatch) -> None:
    """Far beside the hole the shaft presses: it ends softly, or is stopped at the limit."""
    cell, watcher, _ = make_cell()
    monkeypatch.setattr(
        "drivers.mock_world.initial_poses",
        lambda *_: np.array([[14e-6, 0.0, 0.0, 0.0, 0.0]]),
    )
    outcome = cell.insert_part(1)
    assert outcome.phase in (SkillPhase.FAILED, SkillPhase.DONE)
    growth = np.abs(np.diff(watcher.force, axis=0)).max(axis=0)
    inside = watcher.force[np.array(watcher.depths[: len(watcher.forces)]) > -250e-6]
    assert (np.abs(inside).max(axis=0) <= LIMITS_N + growth).all()


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


def test_a_cell_that_does_not_become_calm_says_what_holds_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    cell, _, clock = make_cell()

    def read(sensor: MockForceSensor, timeout_s: float) -> None:
        clock.sleep_until_ns(clock.now_ns() + round(timeout_s * 1e9))
        raise DeviceTimeoutError("unplugged")

    monkeypatch.setattr(MockForceSensor, "read", read)
    with pytest.raises(DeviceTimeoutError) as caught:
        cell.insert_part(1)
    assert str(caught.value) == (
        "the cell does not become calm (waited 1 s); missing data: no force sample yet; "
        "missing data: no force estimate yet"
    )


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


def lame(at_move: int, share: float) -> Callable[..., StageCommand]:
    """A stage that from a move on accepts every step and makes only a share of its way."""
    move_to, moves = MockStage.move_to, 0

    def move(stage: MockStage, target: Pose, *speeds: float) -> StageCommand:
        nonlocal moves
        moves += 1
        if moves >= at_move:
            start = stage.state().pose
            x, y, z = (
                s + share * (t - s) for s, t in zip(start.position, target.position, strict=True)
            )
            target = Pose((x, y, z), start.rotation)
        return move_to(stage, target, *speeds)

    return move


@pytest.mark.parametrize(("at_move", "phase"), [(1, "approach"), (10, "insert"), (60, "done")])
def test_a_stage_that_accepts_steps_but_does_not_move_ends_the_run(
    at_move: int, phase: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """On the way in, inside the part, and on the way out: after five steps."""
    cell, _, _ = make_cell()
    phases: list[str] = []
    sent: list[Sent] = []

    class Keeper(Subscriber):
        def on_phase(self, change: PhaseChange) -> None:
            phases.append(change.phase)

        def on_sent(self, answer: Sent) -> None:
            sent.append(answer)

    cell.follow(Keeper())
    monkeypatch.setattr(MockStage, "move_to", lame(at_move, 0.09))
    with pytest.raises(DeviceError, match="the stage has not followed 5 steps in a row"):
        cell.insert_part(1)
    assert phases[-1] == phase
    assert len(sent) == at_move + 4


def test_a_stage_that_falls_short_is_followed_up(monkeypatch: pytest.MonkeyPatch) -> None:
    cell, _, _ = make_cell()
    monkeypatch.setattr(MockStage, "move_to", lame(1, 0.5))
    assert cell.insert_part(1).phase is SkillPhase.DONE


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
