"""The supervisor's rules on what devices say, how old it is and whether it is a number."""

import pytest

from controllers.faults import Memory
from controllers.messages import FilterHealth, Rule, Severity
from drivers.contract.messages import Pose, SensorStatus
from tests.controllers.builders import (
    MS,
    NOT_FINITE,
    NOW,
    arm,
    estimate,
    fires,
    gripper,
    sample,
    stage,
    watched,
)


@pytest.mark.parametrize(
    ("age_ms", "holds"), [(-0.001, True), (0.0, False), (5.0, False), (5.001, True), (1e3, True)]
)
def test_stale_sample(age_ms: float, holds: bool) -> None:
    seen = sample(stamp_ns=NOW - round(age_ms * MS))
    assert fires(Rule.STALE_SAMPLE, Severity.HOLD, sample=seen) is holds


@pytest.mark.parametrize("device", ["stage", "arm", "gripper"])
@pytest.mark.parametrize(
    ("age_ms", "holds"), [(-0.001, True), (0.0, False), (29.999, False), (30.001, True)]
)
def test_stale_device(device: str, age_ms: float, holds: bool) -> None:
    states = {"stage": stage, "arm": arm, "gripper": gripper}
    seen = {device: states[device](stamp_ns=NOW - round(age_ms * MS))}
    assert fires(Rule.STALE_DEVICE, Severity.HOLD, **seen) is holds


@pytest.mark.parametrize(("gap_ms", "holds"), [(0.0, False), (20.0, False), (20.001, True)])
def test_heartbeat(gap_ms: float, holds: bool) -> None:
    before = Memory(NOW - round(gap_ms * MS))
    assert fires(Rule.HEARTBEAT, Severity.HOLD, memory=before) is holds


def test_clock_that_runs_backwards_stops() -> None:
    assert fires(Rule.CLOCK, Severity.STOP, memory=Memory(NOW + 1))


@pytest.mark.parametrize("missing", ["sample", "estimate", "stage", "arm", "gripper"])
def test_missing_data_holds(missing: str) -> None:
    assert fires(Rule.MISSING_DATA, Severity.HOLD, **{missing: None})


@pytest.mark.parametrize("value", NOT_FINITE)
@pytest.mark.parametrize("axis", range(6))
def test_non_finite_sample_bias_or_estimate_stops(axis: int, value: float) -> None:
    wrench = [0.0] * 6
    wrench[axis] = value
    broken = tuple(wrench)
    assert fires(Rule.NON_FINITE, Severity.STOP, sample=sample(wrench=broken))
    assert fires(Rule.NON_FINITE, Severity.STOP, bias=broken)
    assert fires(Rule.NON_FINITE, Severity.STOP, estimate=estimate(wrench=broken))
    assert fires(Rule.NON_FINITE, Severity.STOP, estimate=estimate(std=broken))


@pytest.mark.parametrize("value", NOT_FINITE)
@pytest.mark.parametrize("axis", range(3))
def test_non_finite_device_state_stops(axis: int, value: float) -> None:
    broken = [0.0, 0.0, 0.0]
    broken[axis] = value
    vector = (broken[0], broken[1], broken[2])
    zero = (0.0, 0.0, 0.0)
    for state in (
        stage(pose=Pose(vector, zero)),
        stage(pose=Pose(zero, vector)),
        stage(velocity=vector),
        stage(angular_velocity=vector),
    ):
        assert fires(Rule.NON_FINITE, Severity.STOP, stage=state)
    assert fires(Rule.NON_FINITE, Severity.STOP, arm=arm(pose=Pose(vector, zero)))
    assert fires(Rule.NON_FINITE, Severity.STOP, arm=arm(pose=Pose(zero, vector)))


@pytest.mark.parametrize("status", [SensorStatus.SATURATED, SensorStatus.FAULT])
def test_sensor_status_stops(status: SensorStatus) -> None:
    assert fires(Rule.SENSOR_STATUS, Severity.STOP, sample=sample(status=status))


@pytest.mark.parametrize(
    ("health", "holds"),
    [
        (FilterHealth.OK, False),
        (FilterHealth.REJECTED, False),
        (FilterHealth.UNTARED, False),
        (FilterHealth.STUCK, True),
        (FilterHealth.SILENT, True),
        (FilterHealth.STUCK | FilterHealth.UNTARED, True),
    ],
)
def test_filter_health(health: FilterHealth, holds: bool) -> None:
    assert fires(Rule.FILTER_HEALTH, Severity.HOLD, estimate=estimate(health=health)) is holds


def test_a_sample_from_before_the_last_one_holds_until_time_goes_on() -> None:
    _, memory = watched(sample=sample((0.010, 0.0, 0.0)))
    kept = memory.load
    for ms, stamp_ms, holds in ((1, -2, True), (2, -1, True), (3, 0, False), (4, 4, False)):
        now = NOW + ms * MS
        verdict, memory = watched(
            memory,
            now_ns=now,
            sample=sample((0.011, 0.0, 0.0), stamp_ns=NOW + stamp_ms * MS),
            stage=stage(stamp_ns=now),
            arm=arm(stamp_ns=now),
            gripper=gripper(stamp_ns=now),
        )
        told = [str(r) for r in verdict.reasons]
        assert told == (
            [f"stale force sample: stamped {-stamp_ms}.000 ms before the last one"] * holds
        )
        assert verdict.severity is (Severity.HOLD if holds else Severity.PASS)
        assert (memory.load == kept) is holds
