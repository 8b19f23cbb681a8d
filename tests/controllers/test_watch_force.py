"""The supervisor's rules on force, its growth and its impulse. Limits are literals."""

import math
from typing import Any

import pytest

from controllers.faults import Load, Memory
from controllers.messages import FilterHealth, Rule, Severity
from drivers.contract.messages import SensorStatus
from tests.controllers.builders import (
    MS,
    NOT_FINITE,
    NOW,
    arm,
    estimate,
    fires,
    gripper,
    load,
    sample,
    stage,
    up,
    watched,
)


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
