"""The raw force of an insertion, with bias and depth at each sample."""

from pathlib import Path

import numpy as np
import pytest

from controllers.messages import PhaseChange, SkillPhase, Snapshot, Tick, Verdict
from drivers.contract.errors import LogError
from drivers.contract.messages import ForceSample, Pose, StageState
from hil.log_file import LogFile
from hil.log_reader import Log, read_log
from hil.recorder import Recorder

MS = 1_000_000
START_NS = 1_700_000_000_000_000_000
ZERO = (0.0,) * 6
BIAS = (0.5, 0.0, 0.0, 0.0, 0.0, 0.0)

PHASES = {
    0: (1, SkillPhase.APPROACH),
    20: (1, SkillPhase.INSERT),
    50: (1, SkillPhase.DONE),
    60: (2, SkillPhase.APPROACH),
    70: (2, SkillPhase.INSERT),
    80: (2, SkillPhase.RETRACT),
    85: (2, SkillPhase.FAILED),
}


@pytest.fixture
def log(tmp_path: Path) -> Log:
    """Samples from 0 ms on, ticks from 15 ms on; f_x is the time in ms, depth falls 1 um per ms."""
    recorder = Recorder(LogFile(tmp_path / "run.mcap", {}))
    for ms in range(100):
        now_ns = START_NS + ms * MS
        if ms in PHASES:
            recorder.on_phase(PhaseChange(now_ns, *PHASES[ms], "", 0))
        recorder.on_sample(ForceSample(now_ns, now_ns, ms, (float(ms), *ZERO[1:])))
        if ms >= 15:
            stage = StageState(now_ns, Pose((0.0, 0.0, ms * 1e-6)), ZERO[:3], ZERO[:3], moving=True)
            bias = BIAS if ms >= 30 else ZERO
            snapshot = Snapshot(now_ns, None, bias, None, stage, None, None)
            recorder.on_tick(Tick(snapshot, Verdict(now_ns), now_ns, now_ns))
    recorder.close()
    return read_log(tmp_path / "run.mcap")


def test_insertions_by_number(log: Log) -> None:
    assert log.insertions == (1, 2)


@pytest.mark.parametrize(
    ("insertion", "phase", "first_ms", "end_ms"),
    [
        (1, SkillPhase.APPROACH, 0, 20),
        (1, SkillPhase.INSERT, 20, 50),
        (2, SkillPhase.INSERT, 70, 80),
        (2, SkillPhase.FAILED, 85, 100),
        (1, SkillPhase.FAILED, 0, 0),
    ],
)
def test_a_phase_lasts_until_the_next(
    log: Log, insertion: int, phase: SkillPhase, first_ms: int, end_ms: int
) -> None:
    trace = log.trace(insertion, phase)
    assert trace.raw[:, 0].tolist() == list(range(first_ms, end_ms))
    assert ((trace.stamps_ns - START_NS) // MS).tolist() == list(range(first_ms, end_ms))


def test_the_insert_phase_is_meant_unless_another_is_named(log: Log) -> None:
    assert log.trace(1).stamps_ns.tolist() == log.trace(1, SkillPhase.INSERT).stamps_ns.tolist()


def test_depth_is_interpolated_between_the_stage_poses(log: Log) -> None:
    assert log.stage_pose.stamps_ns.size < 12
    assert log.trace(1).depth_m == pytest.approx(np.arange(20, 50) * 1e-6, abs=1e-12)


def test_depth_is_unknown_before_the_first_pose_and_held_after_the_last(log: Log) -> None:
    approach = log.trace(1, SkillPhase.APPROACH).depth_m
    assert np.isnan(approach[:15]).all()
    assert not np.isnan(approach[15:]).any()
    assert log.trace(2, SkillPhase.FAILED).depth_m[-1] == log.stage_pose.position[-1, 2]


def test_the_bias_is_the_newest_one_and_before_the_first_that_one(log: Log) -> None:
    assert log.trace(1).bias[:, 0].tolist() == [0.0] * 10 + [0.5] * 20
    assert log.trace(1, SkillPhase.APPROACH).bias[:, 0].tolist() == [0.0] * 20
    assert log.trace(2).wrench[:, 0].tolist() == [ms - 0.5 for ms in range(70, 80)]


def test_without_ticks_bias_and_depth_are_unknown(tmp_path: Path) -> None:
    recorder = Recorder(LogFile(tmp_path / "run.mcap", {}))
    recorder.on_phase(PhaseChange(0, 1, SkillPhase.INSERT, "", 0))
    recorder.on_sample(ForceSample(1, 1, 1, ZERO))
    recorder.close()
    trace = read_log(tmp_path / "run.mcap").trace(1)
    assert np.isnan(trace.depth_m).tolist() == [True]
    assert np.isnan(trace.bias).all()


def test_an_unknown_insertion_is_refused(log: Log) -> None:
    with pytest.raises(LogError, match=r"run\.mcap has no insertion 3; it has 1, 2"):
        log.trace(3)
