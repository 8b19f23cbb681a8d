"""What the recorder is told comes back from the log, to the last bit and nanosecond."""

import math
import struct
from pathlib import Path
from tempfile import TemporaryDirectory

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from controllers.messages import (
    ContactBelief,
    FilterHealth,
    ForceEstimate,
    Observation,
    PhaseChange,
    Proposal,
    Reason,
    ResetRecord,
    Rule,
    Sent,
    Severity,
    SkillPhase,
    Snapshot,
    Tick,
    Verdict,
)
from drivers.contract.messages import (
    ArmState,
    ForceSample,
    GripperState,
    Pose,
    SensorStatus,
    StageState,
    Vector3,
    Wrench,
)
from hil.log_file import LogFile
from hil.log_reader import Log, read_log
from hil.recorder import Recorder
from hil.ros_messages import ContactTruth, quaternion

in_files = settings(max_examples=50)
"""How long a file takes to write and read is the machine's matter."""

stamps = st.integers(0, 2**31 * 10**9 - 1)
numbers = st.floats(allow_nan=False)
counts = st.integers(0, 2**32 - 1)
texts = st.text(max_size=20)
vectors = st.tuples(numbers, numbers, numbers)
wrenches = st.tuples(*[numbers] * 6)
angles = st.floats(-1.5, 1.5)
poses = st.builds(Pose, vectors, vectors)
reasons = st.builds(Reason, st.sampled_from(Rule), st.sampled_from(Severity), texts)
verdicts = st.builds(Verdict, stamps, st.lists(reasons, max_size=3).map(tuple), numbers)
estimates = st.builds(
    ForceEstimate,
    stamps,
    wrenches,
    wrenches,
    wrenches,
    numbers,
    st.integers(0, 15).map(FilterHealth),
)
QUIET = Snapshot(0, None, (0.0,) * 6, None, None, None, None)


def _tell(method: str, *arguments: object) -> Log:
    with TemporaryDirectory() as folder:
        recorder = Recorder(LogFile(Path(folder) / "run.mcap", {}))
        getattr(recorder, method)(*arguments)
        recorder.close()
        return read_log(Path(folder) / "run.mcap")


def _tick(**seen: object) -> Log:
    return _tell("on_tick", Tick(QUIET._replace(**seen), Verdict(0), 0, 0))


@in_files
@given(
    stamp_ns=st.integers(-(10**9), 2**31 * 10**9 - 1),
    receipt_ns=stamps,
    sequence=st.integers(0, 2**40),
    wrench=st.tuples(*[st.floats()] * 6),
)
def test_raw_sample(stamp_ns: int, receipt_ns: int, sequence: int, wrench: Wrench) -> None:
    raw = _tell("on_sample", ForceSample(stamp_ns, receipt_ns, sequence, wrench)).raw_force
    assert raw.stamps_ns.tolist() == [stamp_ns]
    assert raw.receipts_ns.tolist() == [receipt_ns]
    assert raw.sequences.tolist() == [sequence % 2**32]
    assert raw.wrench.tobytes() == struct.pack("<6d", *wrench)


@in_files
@given(estimate=estimates)
def test_estimate(estimate: ForceEstimate) -> None:
    assert _tick(estimate=estimate).estimates == (estimate,)


@in_files
@given(stamp_ns=stamps, bias=wrenches)
def test_bias(stamp_ns: int, bias: Wrench) -> None:
    track = _tick(now_ns=stamp_ns, bias=bias).force_bias
    assert track.stamps_ns.tolist() == [stamp_ns]
    assert track.wrench.tolist() == [list(bias)]


@in_files
@given(
    stamp_ns=stamps,
    position=vectors,
    rotation=st.tuples(angles, angles, angles),
    velocity=vectors,
    angular_velocity=vectors,
)
def test_stage_and_arm(
    stamp_ns: int,
    position: Vector3,
    rotation: Vector3,
    velocity: Vector3,
    angular_velocity: Vector3,
) -> None:
    pose = Pose(position, rotation)
    log = _tick(
        stage=StageState(stamp_ns, pose, velocity, angular_velocity, moving=True),
        arm=ArmState(stamp_ns, pose, moving=False),
    )
    for track in (log.stage_pose, log.arm_pose):
        assert track.stamps_ns.tolist() == [stamp_ns]
        assert track.position.tolist() == [list(position)]
        assert track.rotation[0] == pytest.approx(rotation, abs=1e-12)
    assert log.stage_twist.velocity.tolist() == [list(velocity)]
    assert log.stage_twist.angular_velocity.tolist() == [list(angular_velocity)]


@in_files
@given(
    observation=st.builds(Observation, stamps, counts, wrenches, wrenches, poses, vectors, poses),
    proposal=st.builds(Proposal, stamps, counts, texts, vectors, vectors, vectors),
)
def test_observation_and_proposal(observation: Observation, proposal: Proposal) -> None:
    log = _tell("on_proposal", observation, proposal)
    assert log.observations == (observation,)
    assert log.proposals == (proposal,)


@in_files
@given(
    belief=st.builds(
        ContactBelief,
        stamps,
        st.tuples(*[numbers] * 7),
        st.lists(st.floats(0.0), min_size=49, max_size=49).map(tuple),
        texts,
        numbers,
        numbers,
        counts,
    )
)
def test_belief(belief: ContactBelief) -> None:
    assert _tell("on_belief", belief).beliefs == (belief,)


@in_files
@given(verdict=verdicts)
def test_verdict(verdict: Verdict) -> None:
    assert _tell("on_tick", Tick(QUIET, verdict, 0, 0)).verdicts == (verdict,)


@in_files
@given(sent=st.builds(Sent, stamps, counts, verdicts, st.none() | poses, vectors, vectors, numbers))
def test_sent(sent: Sent) -> None:
    assert _tell("on_sent", sent).sent == (sent,)


@in_files
@given(change=st.builds(PhaseChange, stamps, counts, st.sampled_from(SkillPhase), texts, counts))
def test_phase(change: PhaseChange) -> None:
    assert _tell("on_phase", change).phases == (change,)


@in_files
@given(record=st.builds(ResetRecord, stamps, texts, st.lists(reasons, max_size=3).map(tuple)))
def test_reset(record: ResetRecord) -> None:
    assert _tell("on_reset", record).resets == (record,)


@in_files
@given(truth=st.builds(ContactTruth, stamps, texts, texts, counts, numbers, wrenches, poses))
def test_contact_truth(truth: ContactTruth) -> None:
    assert _tell("on_truth", truth).contact_states == (truth,)


def test_metadata(tmp_path: Path) -> None:
    metadata = {
        "limits": {"file": "limits.yaml", "sha256": "ab" * 32},
        "empty": {},
        "run": {"": "µ"},
    }
    Recorder(LogFile(tmp_path / "run.mcap", metadata)).close()
    assert read_log(tmp_path / "run.mcap").metadata == metadata


def test_devices_heard_and_not_heard() -> None:
    silent = _tick(now_ns=5).device_statuses
    names = ["force_sensor", "force_filter", "stage", "arm", "gripper"]
    assert [status.device for status in silent] == names
    assert {(s.stamp_ns, s.level, s.message) for s in silent} == {(5, 3, "nothing heard yet")}

    statuses = _tick(
        now_ns=5,
        sample=ForceSample(1, 2, 3, (0.0,) * 6, SensorStatus.SATURATED | SensorStatus.FAULT),
        estimate=ForceEstimate(
            1, *[(0.0,) * 6] * 3, 6.25, FilterHealth.REJECTED | FilterHealth.UNTARED
        ),
        stage=StageState(1, Pose(), (0.0,) * 3, (0.0,) * 3, moving=True),
        arm=ArmState(1, Pose(), moving=False),
        gripper=GripperState(1, valve_open=True, part_held=False),
    ).device_statuses
    found = [(status.level, status.message, dict(status.values)) for status in statuses]
    assert found == [
        (2, "saturated, fault", {"sequence": "3"}),
        (1, "rejected, untared", {"nis": "6.25"}),
        (0, "ok", {"moving": "true"}),
        (0, "ok", {"moving": "false"}),
        (0, "ok", {"valve_open": "true", "part_held": "false"}),
    ]


def test_arrays_are_read_only() -> None:
    log = _tell("on_sample", ForceSample(1, 2, 3, (0.0,) * 6))
    with pytest.raises(ValueError, match="read-only"):
        log.raw_force.wrench[0, 0] = math.pi
    with pytest.raises(ValueError, match="read-only"):
        log.raw_force.stamps_ns[0] = 0


@in_files
@given(rotation=st.tuples(angles, angles, angles))
def test_a_rotation_is_about_fixed_x_then_y_then_z(rotation: Vector3) -> None:
    found = quaternion(rotation)
    expected = Rotation.from_euler("xyz", rotation).as_quat()
    assert [found.x, found.y, found.z, found.w] == pytest.approx(expected, abs=1e-12)
