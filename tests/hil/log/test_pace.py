"""Which calls become messages, and with which times."""

from dataclasses import replace
from pathlib import Path

import pytest
from mcap.reader import make_reader
from mcap.records import Message

from controllers.messages import (
    FilterHealth,
    ForceEstimate,
    PhaseChange,
    Reason,
    ResetRecord,
    Rule,
    Severity,
    SkillPhase,
    Snapshot,
    Tick,
    Verdict,
)
from drivers.contract.messages import ArmState, ForceSample, GripperState, Pose, StageState
from hil.log_file import LogFile, Topic
from hil.log_reader import Log, read_log
from hil.recorder import Recorder
from hil.ros_messages import ContactTruth
from tests.hil.log import scenario

MS = 1_000_000
ZERO = (0.0,) * 6
REDUCE = Reason(Rule.GOVERNOR, Severity.REDUCE, "4 mm/s over 2 mm/s")
HOLD = Reason(Rule.FORCE, Severity.HOLD, "80 mN over 70 mN")


def _estimate(now_ns: int, health: FilterHealth = FilterHealth.OK) -> ForceEstimate:
    return ForceEstimate(now_ns, ZERO, ZERO, ZERO, 6.0, health)


def _tick(ms: int, *reasons: Reason, took_ns: int = 20_000, **seen: object) -> Tick:
    now_ns = ms * MS
    snapshot = Snapshot(now_ns, None, ZERO, None, None, None, None)._replace(**seen)
    return Tick(snapshot, Verdict(now_ns, reasons), now_ns, now_ns + took_ns)


def _record(path: Path, ticks: list[Tick]) -> Log:
    recorder = Recorder(LogFile(path, {}))
    for tick in ticks:
        recorder.on_tick(tick)
    recorder.close()
    return read_log(path)


def _messages(path: Path, topic: Topic) -> list[Message]:
    with path.open("rb") as stream:
        return [message for _, _, message in make_reader(stream).iter_messages([topic])]


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return tmp_path / "run.mcap"


def test_every_tenth_estimate_and_each_change_of_health(path: Path) -> None:
    health = {13: FilterHealth.REJECTED, 27: FilterHealth.STUCK, 28: FilterHealth.STUCK}
    ticks = [
        _tick(ms, estimate=_estimate(ms * MS, health.get(ms, FilterHealth.OK))) for ms in range(40)
    ]
    stamps_ms = [estimate.stamp_ns // MS for estimate in _record(path, ticks).estimates]
    assert stamps_ms == [0, 10, 13, 14, 20, 27, 29, 30]


def test_an_estimate_that_stays_is_recorded_once(path: Path) -> None:
    ticks = [_tick(ms, estimate=_estimate(0)) for ms in range(40)]
    assert len(_record(path, ticks).estimates) == 1


def test_stage_states_at_100_hz_at_most_and_only_new_ones(path: Path) -> None:
    def stage(stamp_ms: int) -> StageState:
        return StageState(stamp_ms * MS, Pose(), (0.0,) * 3, (0.0,) * 3, moving=False)

    ticks = [_tick(ms, stage=stage(min(ms, 34))) for ms in range(80)]
    log = _record(path, ticks)
    assert [stamp // MS for stamp in log.stage_pose.stamps_ns.tolist()] == [0, 10, 20, 30, 34]
    assert log.stage_twist.stamps_ns.tolist() == log.stage_pose.stamps_ns.tolist()


def test_arm_states_at_10_hz_at_most(path: Path) -> None:
    ticks = [_tick(ms, arm=ArmState(ms * MS, Pose(), moving=False)) for ms in range(250)]
    stamps_ns = _record(path, ticks).arm_pose.stamps_ns.tolist()
    assert [stamp // MS for stamp in stamps_ns] == [0, 100, 200]


def test_verdicts_when_the_rules_change(path: Path) -> None:
    softer = replace(REDUCE, detail="3 mm/s over 2 mm/s")
    fired: list[tuple[Reason, ...]] = [
        (),
        (),
        (REDUCE,),
        (softer,),
        (REDUCE, HOLD),
        (HOLD, REDUCE),
        (replace(HOLD, severity=Severity.STOP), REDUCE),
        (),
    ]
    log = _record(path, [_tick(ms, *reasons) for ms, reasons in enumerate(fired)])
    assert [verdict.stamp_ns // MS for verdict in log.verdicts] == [0, 2, 4, 6, 7]
    assert [verdict.severity for verdict in log.verdicts] == [0, 1, 2, 4, 0]


def test_the_bias_when_it_changes(path: Path) -> None:
    biases = [ZERO, ZERO, (0.1, *ZERO[1:]), (0.1, *ZERO[1:])]
    log = _record(path, [_tick(ms, bias=bias) for ms, bias in enumerate(biases)])
    assert log.force_bias.stamps_ns.tolist() == [0, 2 * MS]


def test_diagnostics_at_10_hz_and_on_change(path: Path) -> None:
    def gripper(ms: int) -> GripperState:
        return GripperState(ms * MS, valve_open=True, part_held=ms != 42)

    log = _record(path, [_tick(ms, gripper=gripper(ms)) for ms in range(130)])
    stamps_ms = [s.stamp_ns // MS for s in log.device_statuses if s.device == "gripper"]
    assert stamps_ms == [0, 42, 43, 100]


def test_loop_timing_of_each_100_ms_and_of_the_rest(path: Path) -> None:
    took_ns = {5: 3 * MS, 6: 1_000_001, 7: MS}
    log = _record(path, [_tick(ms, took_ns=took_ns.get(ms, 20_000)) for ms in range(150)])
    first, rest = log.timings
    assert (first.stamp_ns, first.window_s, first.ticks) == (100_020_000, 0.10002, 101)
    assert (first.max_s, first.median_s) == (0.003, 0.00002)
    assert first.mean_s == pytest.approx((98 * 20e-6 + 5_000_001e-9) / 101)
    assert (first.deadline_s, first.missed_deadlines) == (0.001, 2)
    assert (rest.ticks, rest.max_s, rest.missed_deadlines) == (49, 0.00002, 0)


def test_contact_truth_at_100_hz_and_on_change(path: Path) -> None:
    recorder = Recorder(LogFile(path, {}))
    for ms in range(40):
        contacts = 2 if ms in (13, 14) else 1
        recorder.on_truth(ContactTruth(ms * MS, "b", "upper hole", contacts, 0.0, ZERO, Pose()))
    recorder.close()
    stamps_ms = [truth.stamp_ns // MS for truth in read_log(path).contact_states]
    assert stamps_ms == [0, 10, 13, 15, 20, 30]


def test_log_time_is_the_host_time_and_publish_time_the_stamp(path: Path) -> None:
    recorder = Recorder(LogFile(path, {}))
    times_ns = [(7, 10), (9, 12), (5, 11), (-3, 13)]
    for number, (stamp_ns, receipt_ns) in enumerate(times_ns):
        recorder.on_sample(ForceSample(stamp_ns, receipt_ns, number, ZERO))
    recorder.close()
    messages = _messages(path, Topic.RAW_FORCE)
    assert [message.log_time for message in messages] == [10, 12, 12, 13]
    assert [message.publish_time for message in messages] == [7, 9, 5, 0]
    assert [message.sequence for message in messages] == [0, 1, 2, 3]


def test_what_a_tick_shows_is_heard_at_the_tick_and_older(path: Path) -> None:
    _record(
        path,
        [
            _tick(
                5,
                estimate=_estimate(4 * MS),
                stage=StageState(3 * MS, Pose(), (0.0,) * 3, (0.0,) * 3, moving=False),
                arm=ArmState(2 * MS, Pose(), moving=False),
            )
        ],
    )
    stamps_ms = {
        Topic.FORCE_ESTIMATE: 4,
        Topic.STAGE_POSE: 3,
        Topic.STAGE_TWIST: 3,
        Topic.ARM_POSE: 2,
        Topic.FORCE_BIAS: 5,
        Topic.DIAGNOSTICS: 5,
    }
    for topic, stamp_ms in stamps_ms.items():
        (message,) = _messages(path, topic)
        assert (message.publish_time, message.log_time) == (stamp_ms * MS, 5 * MS)


def test_the_same_calls_make_the_same_bytes(tmp_path: Path) -> None:
    contents = []
    for name in ("one.mcap", "two.mcap"):
        recorder = Recorder(LogFile(tmp_path / name, scenario.METADATA))
        for call in scenario.calls(seed=3, milliseconds=500):
            call.make(recorder)
        recorder.close()
        contents.append((tmp_path / name).read_bytes())
    assert contents[0] == contents[1]


@pytest.mark.parametrize("step_ms", [1, 20])
def test_ticks_alone_bring_the_log_to_the_disk(path: Path, step_ms: int) -> None:
    recorder = Recorder(LogFile(path, {}))
    recorder.on_sample(ForceSample(0, 0, 0, ZERO))
    recorder.on_sample(ForceSample(MS, MS, 1, ZERO))
    assert read_log(path).raw_force.sequences.tolist() == [0]
    for ms in range(2, 72, step_ms):
        recorder.on_tick(_tick(ms))
    assert read_log(path).raw_force.sequences.tolist() == [0, 1]
    recorder.close()


def test_a_clock_that_jumps_back_does_not_keep_the_log_off_the_disk(path: Path) -> None:
    recorder = Recorder(LogFile(path, {}))
    for number, ms in enumerate([10_000, 5, 6, 40, 56]):
        recorder.on_sample(ForceSample(ms * MS, ms * MS, number, ZERO))
    assert read_log(path).raw_force.sequences.tolist() == [0, 1, 2, 3, 4]
    recorder.close()


def test_phases_and_resets_are_on_the_disk_at_once(path: Path) -> None:
    recorder = Recorder(LogFile(path, {}))
    recorder.on_sample(ForceSample(0, 0, 0, ZERO))
    recorder.on_phase(PhaseChange(MS, 1, SkillPhase.DONE, "", 53))
    assert len(read_log(path).phases) == 1
    recorder.on_reset(ResetRecord(2 * MS, "operator", (HOLD,)))
    assert len(read_log(path).resets) == 1
    recorder.close()
