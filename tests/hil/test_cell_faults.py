"""The whole mock cell on simulated time, with one thing wrong."""

from collections.abc import Callable
from typing import cast

import numpy as np
import pytest

from controllers.control_loop import Subscriber
from controllers.messages import (
    Move,
    PhaseChange,
    ResetRecord,
    Rule,
    Sent,
    Severity,
    SkillPhase,
    Tick,
)
from controllers.proportional import ProportionalController
from drivers.contract.errors import DeviceError, DeviceTimeoutError, SafetyError
from drivers.contract.messages import ForceSample, Pose, StageCommand
from drivers.force_sensor.mock import MockForceSensor
from drivers.stage.mock import MockStage
from tests.hil.watched_cell import LIMITS_N, Watcher, make_cell


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
