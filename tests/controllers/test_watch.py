"""The supervisor's view of the cell's state. Limits are restated here as literals."""

import math
from typing import Any

import pytest

from controllers.faults import Load, Memory
from controllers.messages import FilterHealth, Rule, Severity
from controllers.supervisor import watch
from drivers.contract.messages import Pose, SensorStatus, Vector3
from tests.controllers.builders import (
    HOLD_POSE,
    LIMITS,
    MS,
    NOT_FINITE,
    NOW,
    arm,
    estimate,
    gripper,
    load,
    running,
    sample,
    snapshot,
    stage,
    watched,
)


def up(value: float) -> float:
    return math.nextafter(value, math.inf)


def down(value: float) -> float:
    return math.nextafter(value, -math.inf)


def fires(rule: Rule, severity: Severity, **changes: Any) -> bool:
    verdict, _ = watched(**changes)
    fired = [reason for reason in verdict.reasons if reason.rule is rule]
    if not fired:
        assert verdict.severity is Severity.PASS, verdict
        return False
    assert fired[0].severity is severity
    assert verdict.severity is severity
    return True


def test_a_cell_in_order_passes() -> None:
    verdict, memory = watched()
    assert verdict.reasons == ()
    assert verdict.severity is Severity.PASS
    assert memory.latched == ()


@pytest.mark.parametrize(("axis", "limit_N"), [(0, 0.070), (1, 0.100), (2, 1.000)])
@pytest.mark.parametrize("sign", [-1.0, 1.0])
@pytest.mark.parametrize(
    ("share", "stops"), [(0.0, False), (0.9, False), (1.0, False), (up(1.0), True), (2.0, True)]
)
def test_force_limit(axis: int, limit_N: float, sign: float, share: float, stops: bool) -> None:
    force = [0.0, 0.0, 0.0]
    force[axis] = sign * limit_N * share
    before = Memory(NOW - MS, load(NOW - MS, (force[0], force[1], force[2]), 0.0, 0.0))
    verdict, memory = watched(before, sample=sample((force[0], force[1], force[2])))
    fired = [r for r in verdict.reasons if r.rule is Rule.FORCE]
    assert bool(fired) is stops
    assert (verdict.severity is Severity.STOP) is stops
    assert bool(memory.latched) is stops
    if stops:
        assert f"f_{'xyz'[axis]} = {force[axis] * 1e3:.1f} mN" in fired[0].detail
        assert f"limit {limit_N * 1e3:.1f} mN" in fired[0].detail


def test_force_limit_is_taken_on_the_raw_sample_less_the_bias() -> None:
    bias = (0.050, 0.0, 0.0, 0.0, 0.0, 0.0)
    assert not fires(Rule.FORCE, Severity.STOP, sample=sample((0.119, 0.0, 0.0)), bias=bias)
    assert fires(Rule.FORCE, Severity.STOP, sample=sample((0.121, 0.0, 0.0)), bias=bias)
    assert fires(Rule.FORCE, Severity.STOP, sample=sample((-0.021, 0.0, 0.0)), bias=bias)


@pytest.mark.parametrize("axis", [0, 1, 2])
@pytest.mark.parametrize("sign", [-1.0, 1.0])
@pytest.mark.parametrize(("growth_N", "holds"), [(0.0199, False), (0.0201, True)])
def test_force_rate(axis: int, sign: float, growth_N: float, holds: bool) -> None:
    """40 N/s over half a millisecond is 20 mN."""
    before = Memory(NOW - MS, load(NOW - MS // 2, (0.0, 0.0, 0.0), 0.0, 0.0))
    force = [0.0, 0.0, 0.0]
    force[axis] = sign * growth_N
    seen = sample((force[0], force[1], force[2]))
    assert fires(Rule.FORCE_RATE, Severity.HOLD, memory=before, sample=seen) is holds


def test_the_same_sample_twice_has_no_rate() -> None:
    before = Memory(NOW - MS, load(NOW, (0.060, 0.0, 0.0), 0.0, 0.0))
    assert not fires(Rule.FORCE_RATE, Severity.HOLD, memory=before, sample=sample())


def test_impulse_counts_what_exceeds_the_gentle_force() -> None:
    """30 and 40 mN make 50 mN: 6 mN above 44 mN, so 10 mN s are full after 1.667 s."""
    memory = Memory()
    times_ms = []
    for ms in range(0, 2000, 10):
        now = NOW + ms * MS
        verdict, memory = watched(
            memory,
            now_ns=now,
            sample=sample((0.030, 0.040, 0.0), stamp_ns=now),
            stage=stage(stamp_ns=now),
            arm=arm(stamp_ns=now),
            gripper=gripper(stamp_ns=now),
        )
        if verdict.severity is Severity.RETREAT:
            times_ms.append(ms)
        else:
            assert verdict.severity is Severity.PASS
    assert times_ms[0] == 1670
    assert times_ms == list(range(1670, 2000, 10))


def test_impulse_starts_anew_once_the_load_is_gentle() -> None:
    before = Memory(NOW - MS, load(NOW - MS, (0.050, 0.0, 0.0), 0.0, 9.9e-3))
    _, memory = watched(before, sample=sample((0.0439, 0.0, 0.0)))
    assert memory.load is not None
    assert memory.load.impulse_N_s == 0.0


def test_impulse_ignores_the_axial_force() -> None:
    before = Memory(NOW - MS, load(NOW - MS, (0.0, 0.0, 0.9), 0.0, 0.0))
    _, memory = watched(before, sample=sample((0.0, 0.0, 0.9)))
    assert memory.load is not None
    assert memory.load.impulse_N_s == 0.0


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


@pytest.mark.parametrize(("speed_mm_s", "stops"), [(5.0, False), (5.0999, False), (5.1001, True)])
def test_measured_speed(speed_mm_s: float, stops: bool) -> None:
    """2 % above 5 mm/s, along any direction."""
    for direction in ((1.0, 0.0, 0.0), (0.0, -1.0, 0.0), (0.0, 0.6, 0.8)):
        velocity = tuple(speed_mm_s * 1e-3 * d for d in direction)
        assert fires(Rule.SPEED, Severity.STOP, stage=stage(velocity=velocity)) is stops


@pytest.mark.parametrize(("speed_deg_s", "stops"), [(1.0, False), (1.0199, False), (1.0201, True)])
def test_measured_angular_speed(speed_deg_s: float, stops: bool) -> None:
    for direction in ((1.0, 0.0, 0.0), (0.0, 0.6, -0.8)):
        velocity = tuple(math.radians(speed_deg_s) * d for d in direction)
        assert fires(Rule.SPEED, Severity.STOP, stage=stage(angular_velocity=velocity)) is stops


@pytest.mark.parametrize(
    ("axis", "low_um", "high_um"), [(0, -200, 200), (1, -200, 200), (2, -1000, 3600)]
)
def test_measured_place_may_leave_the_workspace_by_one_micrometre(
    axis: int, low_um: float, high_um: float
) -> None:
    for place_um, stops in (
        (low_um - 1.01, True),
        (low_um - 0.99, False),
        (high_um + 0.99, False),
        (high_um + 1.01, True),
    ):
        position = [0.0, 0.0, 0.0]
        position[axis] = place_um * 1e-6
        state = stage(pose=Pose((position[0], position[1], position[2])))
        assert fires(Rule.WORKSPACE, Severity.STOP, stage=state) is stops


@pytest.mark.parametrize(("tilt_deg", "stops"), [(0.5999, False), (0.6001, True)])
def test_measured_tilt(tilt_deg: float, stops: bool) -> None:
    rotation = (math.radians(tilt_deg) * 0.6, math.radians(tilt_deg) * -0.8, 0.0)
    state = stage(pose=Pose((0.0, 0.0, 0.0), rotation))
    assert fires(Rule.WORKSPACE, Severity.STOP, stage=state) is stops


@pytest.mark.parametrize(("depth_um", "inside"), [(-100.01, False), (-99.99, True)])
def test_inside_the_part_the_arm_stays_and_the_part_is_held(depth_um: float, inside: bool) -> None:
    state = stage(depth_um * 1e-6)
    away = arm(pose=Pose((0.0, 3.1e-6, 4.1e-6)))
    near = arm(pose=Pose((0.0, 2.9e-6, 3.9e-6)))
    assert fires(Rule.KEEP_OUT, Severity.STOP, stage=state, arm=away) is inside
    assert not fires(Rule.KEEP_OUT, Severity.STOP, stage=state, arm=near)
    assert fires(Rule.KEEP_OUT, Severity.STOP, stage=state, arm=arm(moving=True)) is inside
    lost = gripper(part_held=False)
    assert fires(Rule.VACUUM, Severity.STOP, stage=state, gripper=lost) is inside
    let_go = gripper(valve_open=False, part_held=False)
    assert not fires(Rule.VACUUM, Severity.STOP, stage=state, gripper=let_go)


def test_a_stop_stays_until_it_is_cleared_and_keeps_its_first_cause() -> None:
    _, memory = watched(sample=sample((0.071, 0.0, 0.0)))
    verdict, memory = watched(memory, sample=sample((0.0, 0.101, 0.0)))
    assert verdict.severity is Severity.STOP
    assert [r.detail for r in memory.latched] == ["f_x = 71.0 mN, limit 70.0 mN"]
    verdict, memory = watched(memory)
    assert verdict.severity is Severity.STOP
    assert [r.rule for r in verdict.reasons] == [Rule.FORCE]
    assert len(memory.latched) == 1


def test_two_stops_of_one_tick_are_both_kept() -> None:
    _, memory = watched(sample=sample((0.071, 0.0, 0.0)), stage=stage(velocity=(0.006, 0.0, 0.0)))
    assert {r.rule for r in memory.latched} == {Rule.FORCE, Rule.SPEED}


def test_reasons_of_all_severities_are_told() -> None:
    verdict, _ = watched(sample=None, stage=stage(velocity=(0.006, 0.0, 0.0)))
    assert {r.rule for r in verdict.reasons} == {Rule.MISSING_DATA, Rule.SPEED}
    assert verdict.severity is Severity.STOP


def test_a_running_move_is_slowed_when_the_governor_says_so() -> None:
    """At 50 mN of 70 mN there are 1.25 um left across the hole: 0.5495 mm/s, with 10 % of play."""
    loaded: dict[str, Any] = {
        "memory": Memory(NOW - MS, load(NOW - MS, (0.050, 0.0, 0.0), 0.0, 0.0)),
        "sample": sample((0.050, 0.0, 0.0)),
    }
    verdict, _ = watched(running=running(0.612e-3), **loaded)
    assert verdict.speed_cap_m_s == pytest.approx(0.5495e-3, abs=0.0005e-3)
    assert [r.rule for r in verdict.reasons] == [Rule.GOVERNOR]
    assert verdict.severity is Severity.REDUCE
    verdict, _ = watched(running=running(0.609e-3), **loaded)
    assert verdict.severity is Severity.PASS


def test_without_a_running_move_there_is_no_cap() -> None:
    verdict, _ = watched(sample=sample((0.050, 0.0, 0.0)))
    assert verdict.speed_cap_m_s == math.inf


def test_the_governor_creeps_when_the_load_is_unknown() -> None:
    verdict, _ = watched(running=running(1e-3), sample=None)
    assert verdict.speed_cap_m_s == pytest.approx(0.1e-3)
    verdict, _ = watched(running=running(1e-3), estimate=None)
    assert verdict.speed_cap_m_s == pytest.approx(0.1e-3)


def test_memory_keeps_the_load_when_a_sample_is_missing() -> None:
    _, memory = watched(sample=sample((0.010, 0.0, 0.0)))
    _, later = watched(memory, sample=None)
    assert later.load == memory.load
    assert snapshot().now_ns == later.now_ns


def test_what_is_told_is_exact() -> None:
    """Rule, severity and text of each reason, with value and limit in people's units."""
    turned = Pose((0.0, 0.0, 0.0), (0.0, math.radians(0.7), 0.0))
    cases: list[tuple[dict[str, Any], str, Severity]] = [
        (
            {"memory": Memory(NOW - 21 * MS)},
            "late tick: since the tick before 21.000 ms, limit 20.000 ms",
            Severity.HOLD,
        ),
        (
            {"memory": Memory(NOW - MS, load(NOW, (0.0, 0.0, 0.0), 0.0, 0.011))},
            "impulse limit: 11.00 mN s, limit 10.00 mN s",
            Severity.RETREAT,
        ),
        (
            {"stage": stage(angular_velocity=(0.0, 0.0, math.radians(1.1)))},
            "speed limit: stage at 1.100 deg/s, limit 1.000 deg/s",
            Severity.STOP,
        ),
        (
            {"stage": stage(velocity=(0.0, 0.006, 0.0))},
            "speed limit: stage at 6.00 mm/s, limit 5.00 mm/s",
            Severity.STOP,
        ),
        (
            {"stage": stage(pose=turned)},
            "workspace: tilt 0.700 deg, limit 0.600 deg",
            Severity.STOP,
        ),
    ]
    for changes, text, severity in cases:
        verdict, _ = watched(**changes)
        assert [(str(r), r.severity) for r in verdict.reasons] == [(text, severity)]


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_a_load_that_stays_has_no_rate(axis: int) -> None:
    """60 mN in half a millisecond would be 120 N/s."""
    force = [0.0, 0.0, 0.0]
    force[axis] = 0.060
    steady = (force[0], force[1], force[2])
    before = Memory(NOW - MS, load(NOW - MS // 2, steady, 0.0, 0.0))
    assert not fires(Rule.FORCE_RATE, Severity.HOLD, memory=before, sample=sample(steady))


@pytest.mark.parametrize(("force_N", "holds"), [(0.04, False), (up(0.04), True)])
def test_force_rate_at_its_limit(force_N: float, holds: bool) -> None:
    before = Memory(NOW - MS, load(NOW - MS, (0.0, 0.0, 0.0), 0.0, 0.0))
    seen = sample((0.0, 0.0, force_N))
    assert fires(Rule.FORCE_RATE, Severity.HOLD, memory=before, sample=seen) is holds


@pytest.mark.parametrize("before", [None, load(NOW, (0.06, 0.0, 0.0), 5.0, 0.0)])
def test_a_first_or_repeated_sample_has_the_rate_zero(before: Load | None) -> None:
    _, memory = watched(Memory(NOW - MS, before))
    assert memory.load == load(NOW, (0.0, 0.0, 0.0), 0.0, 0.0)


@pytest.mark.parametrize(("impulse_N_s", "retreats"), [(0.010, False), (up(0.010), True)])
def test_impulse_at_its_limit(impulse_N_s: float, retreats: bool) -> None:
    """A sample that is seen twice leaves the impulse as it was."""
    before = Memory(NOW - MS, load(NOW, (0.060, 0.0, 0.0), 0.0, impulse_N_s))
    assert fires(Rule.IMPULSE, Severity.RETREAT, memory=before) is retreats


@pytest.mark.parametrize(("force_N", "impulse_N_s"), [(0.044, 0.0), (0.0440001, 0.005)])
def test_a_load_at_the_gentle_force_is_gentle(force_N: float, impulse_N_s: float) -> None:
    before = Memory(NOW - MS, load(NOW - MS, (force_N, 0.0, 0.0), 0.0, 0.005))
    _, memory = watched(before, sample=sample((force_N, 0.0, 0.0)))
    assert memory.load is not None
    assert memory.load.impulse_N_s == pytest.approx(impulse_N_s, abs=1e-9)


@pytest.mark.parametrize("axis", range(3))
def test_each_axis_has_its_own_bias(axis: int) -> None:
    bias = [0.0] * 6
    bias[axis] = 0.010
    _, memory = watched(sample=sample((0.020, 0.030, 0.040)), bias=tuple(bias))
    expected = [0.020, 0.030, 0.040]
    expected[axis] -= 0.010
    assert memory.load is not None
    assert memory.load.force == pytest.approx(tuple(expected))


@pytest.mark.parametrize("value", NOT_FINITE)
def test_a_load_that_is_no_number_is_not_remembered(value: float) -> None:
    kept = load(NOW - MS, (0.010, 0.0, 0.0), 0.0, 0.0)
    before = Memory(NOW - MS, kept)
    _, memory = watched(before, sample=sample((value, 0.0, 0.0)))
    assert memory.load == kept
    _, memory = watched(before, bias=(0.0, value, 0.0, 0.0, 0.0, 0.0))
    assert memory.load == kept


@pytest.mark.parametrize(
    ("distance_m", "stops"), [(4.99e-6, False), (5e-6, False), (5.01e-6, True)]
)
def test_distance_of_the_arm(distance_m: float, stops: bool) -> None:
    away = arm(pose=Pose((0.0, -distance_m, 0.0)))
    assert fires(Rule.KEEP_OUT, Severity.STOP, arm=away) is stops


@pytest.mark.parametrize(("depth_m", "inside"), [(-100e-6, False), (up(-100e-6), True)])
def test_the_clear_depth_itself_is_clear(depth_m: float, inside: bool) -> None:
    moving = arm(moving=True)
    assert fires(Rule.KEEP_OUT, Severity.STOP, stage=stage(depth_m), arm=moving) is inside


@pytest.mark.parametrize(("speed_m_s", "stops"), [(5.1e-3, False), (up(5.1e-3), True)])
def test_measured_speed_at_its_limit(speed_m_s: float, stops: bool) -> None:
    state = stage(velocity=(speed_m_s, 0.0, 0.0))
    assert fires(Rule.SPEED, Severity.STOP, stage=state) is stops


@pytest.mark.parametrize(("share", "stops"), [(1.02, False), (up(1.02), True)])
def test_measured_angular_speed_at_its_limit(share: float, stops: bool) -> None:
    state = stage(angular_velocity=(math.radians(1.0) * share, 0.0, 0.0))
    assert fires(Rule.SPEED, Severity.STOP, stage=state) is stops


@pytest.mark.parametrize(
    ("x_m", "stops"),
    [
        (-200.999e-6, False),
        (-200e-6 - 1e-6, False),
        (down(-200e-6 - 1e-6), True),
        (-201.001e-6, True),
        (200.999e-6, False),
        (200e-6 + 1e-6, False),
        (up(200e-6 + 1e-6), True),
        (201.001e-6, True),
    ],
)
def test_measured_place_at_its_limit(x_m: float, stops: bool) -> None:
    state = stage(pose=Pose((x_m, 0.0, 0.0)))
    assert fires(Rule.WORKSPACE, Severity.STOP, stage=state) is stops


@pytest.mark.parametrize(("tilt_rad", "stops"), [(math.radians(0.6), False), (0.0104719756, True)])
def test_measured_tilt_at_its_limit(tilt_rad: float, stops: bool) -> None:
    state = stage(pose=Pose((0.0, 0.0, 0.0), (0.0, tilt_rad, 0.0)))
    assert fires(Rule.WORKSPACE, Severity.STOP, stage=state) is stops


def test_a_stop_is_told_once() -> None:
    verdict, _ = watched(sample=sample((0.071, 0.0, 0.0)))
    assert [r.rule for r in verdict.reasons] == [Rule.FORCE]


def test_a_cap_at_nine_tenths_of_the_speed_is_play() -> None:
    """The creep speed of 0.1 mm/s is exactly nine tenths of 0.111... mm/s."""
    at_limit = 1e-4 / 0.9
    verdict, _ = watched(running=running(at_limit), estimate=None)
    assert Rule.GOVERNOR not in {r.rule for r in verdict.reasons}
    verdict, _ = watched(running=running(up(up(at_limit))), estimate=None)
    assert Rule.GOVERNOR in {r.rule for r in verdict.reasons}


UNTARED = estimate(health=FilterHealth.UNTARED)
BIASED = sample((0.080, -0.150, 1.500))


@pytest.mark.parametrize(
    ("health", "depth_m", "judged"),
    [
        (FilterHealth.UNTARED, -300e-6, False),
        (FilterHealth.UNTARED | FilterHealth.REJECTED, -300e-6, False),
        (FilterHealth.UNTARED, -100e-6, False),
        (FilterHealth.UNTARED, up(-100e-6), True),
        (FilterHealth.UNTARED, 1e-3, True),
        (FilterHealth.OK, -300e-6, True),
        (FilterHealth.REJECTED, -300e-6, True),
    ],
)
def test_clear_of_the_part_a_bias_not_yet_taken_is_no_load(
    health: FilterHealth, depth_m: float, judged: bool
) -> None:
    before = Memory(NOW - MS, Load(NOW - MS, BIASED.wrench[:3], BIASED.wrench[:3], 0.0, 0.011))
    verdict, memory = watched(
        before, sample=BIASED, estimate=estimate(health=health), stage=stage(depth_m)
    )
    fired = {r.rule for r in verdict.reasons}
    assert fired == ({Rule.FORCE, Rule.IMPULSE} if judged else set())
    assert bool(memory.latched) is judged


@pytest.mark.parametrize("missing", ["estimate", "stage"])
def test_a_force_counts_where_nobody_knows_whether_it_is_bias(missing: str) -> None:
    seen: dict[str, Any] = {"estimate": UNTARED, "stage": stage(-300e-6), missing: None}
    verdict, _ = watched(sample=BIASED, **seen)
    assert Rule.FORCE in {r.rule for r in verdict.reasons}


def test_before_the_first_tare_everything_but_force_and_impulse_counts() -> None:
    clear: dict[str, Any] = {"estimate": UNTARED, "stage": stage(-300e-6)}
    growing = Memory(NOW - MS, load(NOW - MS, (0.0, 0.0, 0.0)))
    jump = sample((0.041, 0.0, 0.0))
    assert fires(Rule.FORCE_RATE, Severity.HOLD, memory=growing, sample=jump, **clear)
    full = sample(status=SensorStatus.SATURATED)
    assert fires(Rule.SENSOR_STATUS, Severity.STOP, sample=full, **clear)
    old = sample(stamp_ns=NOW - 6 * MS)
    assert fires(Rule.STALE_SAMPLE, Severity.HOLD, sample=old, **clear)
    broken = sample((math.nan, 0.0, 0.0))
    assert fires(Rule.NON_FINITE, Severity.STOP, sample=broken, **clear)


def test_taking_the_bias_is_no_growth_of_the_force() -> None:
    """150 mN in a millisecond would be 150 N/s."""
    before = Memory(NOW - MS, Load(NOW - MS, BIASED.wrench[:3], BIASED.wrench[:3], 0.0, 5e-3))
    verdict, memory = watched(before, sample=BIASED, bias=BIASED.wrench)
    assert verdict.reasons == ()
    assert memory.load == Load(NOW, BIASED.wrench[:3], (0.0, 0.0, 0.0), 0.0, 0.0)


@pytest.mark.parametrize(
    ("rotation", "y_um", "stops"),
    [
        # 5 um on a lever of 4 mm are 1.25 mrad
        ((1.249e-3, 0.0, 0.0), 0.0, False),
        ((1.251e-3, 0.0, 0.0), 0.0, True),
        ((0.0, -1.251e-3, 0.0), 0.0, True),
        ((0.0, 0.0, 1.251e-3), 0.0, True),
        ((0.0, 0.75e-3, -1.0e-3), 0.01, True),
        ((0.5e-3, 0.0, 0.0), 2.99, False),
        ((0.5e-3, 0.0, 0.0), 3.01, True),
        ((0.5, 0.0, 0.0), 0.0, True),
        ((2.0 * math.pi, -4.0 * math.pi, 1e-3), 0.0, False),
    ],
)
def test_a_turn_of_the_arm_counts_with_the_lever(
    rotation: Vector3, y_um: float, stops: bool
) -> None:
    turned = arm(pose=Pose((0.0, y_um * 1e-6, 0.0), rotation))
    assert fires(Rule.KEEP_OUT, Severity.STOP, arm=turned) is stops


def test_the_turn_of_the_arm_is_told_and_taken_from_its_hold_pose() -> None:
    turned = snapshot(arm=arm(pose=Pose((0.0, 3e-6, 4e-6), (0.0, math.radians(0.5), 0.0))))
    verdict, _ = watch(LIMITS, HOLD_POSE, Memory(), turned, None)
    assert [str(r) for r in verdict.reasons] == [
        "arm and stage keep-out: stage in the part, "
        "arm 5.0 um and 0.500 deg from where it holds the part"
    ]
    aslant = Pose((1.0, 2.0, 3.0), (0.3, -0.5, 0.7))
    verdict, _ = watch(LIMITS, aslant, Memory(), snapshot(arm=arm(pose=aslant)), None)
    assert verdict.reasons == ()


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


@pytest.mark.parametrize("axis", range(3))
@pytest.mark.parametrize("sign", [-1.0, 1.0])
@pytest.mark.parametrize(
    ("way_um", "turn_mrad", "stops"),
    [
        # 4 ms at 5.1 mm/s and 1 um; 4 ms at 1.02 deg/s and 0.25 mrad
        (21.39, 0.0, False),
        (21.41, 0.0, True),
        (1000.0, 0.0, True),
        (0.0, 0.3211, False),
        (0.0, 0.3213, True),
    ],
)
def test_a_stage_that_is_where_it_cannot_be_yet_stops(
    axis: int, sign: float, way_um: float, turn_mrad: float, stops: bool
) -> None:
    """Whatever speed it reports; time counts from its state before to now."""
    position, rotation = [0.0, 0.0, 1e-3], [0.0, 0.0, 0.0]
    position[axis] += sign * way_um * 1e-6
    rotation[axis] = sign * turn_mrad * 1e-3
    before = Memory(NOW - MS, stage=stage(stamp_ns=NOW - 4 * MS))
    there = Pose((position[0], position[1], position[2]), (rotation[0], rotation[1], rotation[2]))
    seen = stage(pose=there, stamp_ns=NOW - 2 * MS)
    assert fires(Rule.SPEED, Severity.STOP, memory=before, stage=seen) is stops


@pytest.mark.parametrize(
    ("there", "stops"),
    [
        (Pose((1e-6, 0.0, 0.0)), False),
        (Pose((up(1e-6), 0.0, 0.0)), True),
        (Pose((0.0, 0.0, 0.0), (0.0, 1e-6 / 4e-3, 0.0)), False),
        (Pose((0.0, 0.0, 0.0), (0.0, up(1e-6 / 4e-3), 0.0)), True),
    ],
)
def test_a_leap_at_its_limit(there: Pose, stops: bool) -> None:
    before = Memory(NOW - MS, stage=stage(pose=Pose()))
    assert fires(Rule.SPEED, Severity.STOP, memory=before, stage=stage(pose=there)) is stops


def test_a_leap_of_the_stage_is_told() -> None:
    before = Memory(NOW - MS, stage=stage(stamp_ns=NOW - MS))
    verdict, memory = watched(before, stage=stage(2e-3))
    assert [str(r) for r in verdict.reasons] == [
        "speed limit: stage displaced by 1000.0 um and 0.0000 deg, faster than its limit"
    ]
    assert memory.stage == stage(2e-3)


def test_the_last_place_of_the_stage_outlasts_a_missing_state() -> None:
    _, memory = watched(Memory(NOW - MS, stage=stage(stamp_ns=NOW - MS)), stage=None)
    assert memory.stage == stage(stamp_ns=NOW - MS)


def test_a_state_from_the_future_makes_no_way_of_its_own() -> None:
    """A second ahead is too far for a state to be believed, but the stage has not moved."""
    before = Memory(NOW - MS, stage=stage(stamp_ns=NOW + 1000 * MS))
    assert not fires(Rule.SPEED, Severity.STOP, memory=before)
