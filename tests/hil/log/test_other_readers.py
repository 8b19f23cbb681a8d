"""The log says the same to the readers that other people's tools use."""

import struct
from collections import Counter
from pathlib import Path

import pytest
from rosbags.highlevel import AnyReader

from hil.log_file import Topic
from hil.log_reader import Log, read_log
from tests.hil.log import node_reader

pytestmark = pytest.mark.slow

Sample = tuple[int, tuple[str, ...]]


@pytest.fixture(scope="module")
def log(finished_log: Path) -> Log:
    return read_log(finished_log)


def _bits(wrench: list[float]) -> tuple[str, ...]:
    return tuple(struct.pack(">d", number).hex() for number in wrench)


def _raw_force(log: Log) -> list[Sample]:
    stamps_ns, wrenches = log.raw_force.stamps_ns.tolist(), log.raw_force.wrench.tolist()
    return [(stamp, _bits(wrench)) for stamp, wrench in zip(stamps_ns, wrenches, strict=True)]


def _counts(log: Log) -> dict[str, int]:
    counts = {
        Topic.RAW_FORCE: log.raw_force.stamps_ns.size,
        Topic.FORCE_BIAS: log.force_bias.stamps_ns.size,
        Topic.FORCE_ESTIMATE: len(log.estimates),
        Topic.STAGE_POSE: log.stage_pose.stamps_ns.size,
        Topic.STAGE_TWIST: log.stage_twist.stamps_ns.size,
        Topic.ARM_POSE: log.arm_pose.stamps_ns.size,
        Topic.OBSERVATION: len(log.observations),
        Topic.BELIEF: len(log.beliefs),
        Topic.PROPOSAL: len(log.proposals),
        Topic.PHASE: len(log.phases),
        Topic.VERDICT: len(log.verdicts),
        Topic.SENT: len(log.sent),
        Topic.RESET: len(log.resets),
        Topic.LOOP_TIMING: len(log.timings),
        Topic.CONTACT_STATE: len(log.contact_states),
        Topic.DIAGNOSTICS: len(log.device_statuses) // 5,
    }
    return {str(topic): count for topic, count in counts.items()}


def test_the_log_has_every_kind_of_message(log: Log) -> None:
    assert log.complete
    assert set(_counts(log)) == set(map(str, Topic))
    assert all(_counts(log).values())


def test_rosbags_reads_the_same_with_the_types_that_the_log_brings(
    log: Log, finished_log: Path
) -> None:
    counts: Counter[str] = Counter()
    raw_force: list[Sample] = []
    times_ns: list[int] = []
    with AnyReader([finished_log]) as reader:
        for connection, time_ns, data in reader.messages():
            message = reader.deserialize(data, connection.msgtype)
            counts[connection.topic] += 1
            times_ns.append(time_ns)
            if connection.topic == "/force/raw":
                stamp, force, torque = (
                    message.header.stamp,
                    message.wrench.force,
                    message.wrench.torque,
                )
                wrench = [force.x, force.y, force.z, torque.x, torque.y, torque.z]
                raw_force.append((stamp.sec * 10**9 + stamp.nanosec, _bits(wrench)))
    assert counts == _counts(log)
    assert raw_force == _raw_force(log)
    assert times_ns == sorted(times_ns)


@pytest.mark.parametrize("mode", ["stream", "indexed"])
def test_web_viewers_read_the_same(
    log: Log, finished_log: Path, node_folder: Path, mode: str
) -> None:
    found = node_reader.read(node_folder, mode, [finished_log])[finished_log]
    assert found.complete
    assert found.counts == _counts(log)
    assert found.raw_force == _raw_force(log)
