"""How fast a proposed step may go. Limits are restated here as literals."""

import math

import pytest

from controllers.messages import Rule, Severity, Verdict
from controllers.supervisor import judge
from drivers.contract.messages import Vector3
from tests.controllers.builders import (
    HOLD_POSE,
    LIMITS,
    NOW,
    estimate,
    judged,
    proposal,
    rules,
    sample,
    snapshot,
)


@pytest.mark.parametrize(
    ("translation", "load", "speed_mm_s"),
    [
        # 17.5 um may be covered along the hole, 4.375 um across it, 3.5 um both ways at once
        ((0.0, 0.0, 60e-6), (0.0, 0.0, 0.0), 4.2450),
        ((20e-6, 0.0, 0.0), (0.0, 0.0, 0.0), 1.5707),
        ((0.0, -20e-6, 0.0), (0.0, 0.0, 0.0), 1.5707),
        ((12e-6, 16e-6, 0.0), (0.0, 0.0, 0.0), 1.5707),
        ((20e-6, 0.0, 0.0), (0.035, 0.0, 0.0), 0.8940),
        ((20e-6, 0.0, 0.0), (-0.035, 0.0, 0.0), 0.8940),
        ((20e-6, 0.0, 0.0), (0.0, 0.065, 0.0), 0.8940),
        ((20e-6, 0.0, 0.0), (0.0, -0.065, 0.0), 0.8940),
        ((0.0, 0.0, 60e-6), (0.0, 0.0, 0.930), 4.2450),
        ((0.0, 0.0, 60e-6), (0.0, 0.0, -0.965), 2.6368),
        ((0.0, 0.0, 60e-6), (0.0, 0.0, 0.965), 2.6368),
        ((20e-6, 0.0, 0.0), (0.0699, 0.0, 0.0), 0.1),
    ],
)
def test_governor(translation: Vector3, load: Vector3, speed_mm_s: float) -> None:
    """The speed from which 2 ms and 1 m/s^2 still stop within the way that the force leaves."""
    _, step = judged(proposal(translation), sample=sample(load))
    assert step is not None
    assert step.speed_m_s == pytest.approx(speed_mm_s * 1e-3, abs=1e-7)


def test_governor_takes_the_larger_of_raw_and_estimate_and_adds_three_sigma() -> None:
    sideways = proposal((20e-6, 0.0, 0.0))
    for changes in (
        {"sample": sample((0.035, 0.0, 0.0))},
        {"estimate": estimate(wrench=(-0.035, 0.0, 0.0, 0.0, 0.0, 0.0))},
        {
            "sample": sample((0.005, 0.0, 0.0)),
            "estimate": estimate(std=(0.010, 0.0, 0.0, 0.0, 0.0, 0.0)),
        },
        {
            "sample": sample((0.0, 0.005, 0.0)),
            "estimate": estimate(std=(0.0, 0.020, 0.0, 0.0, 0.0, 0.0)),
        },
    ):
        _, step = judged(sideways, **changes)
        assert step is not None
        assert step.speed_m_s == pytest.approx(0.8940e-3, abs=1e-7)


@pytest.mark.parametrize(
    ("load_mN", "expected_mN", "speed_mm_s"),
    [
        (0.0, 0.0, 1.5707),
        (0.0, 35.0, 0.8940),
        (0.0, -35.0, 0.8940),
        (35.0, 0.0, 0.8940),  # a belief that foresees less than there is loosens nothing
        (35.0, 20.0, 0.8940),
        (-35.0, 20.0, 0.8940),
        (10.0, 35.0, 0.8940),
        (0.0, 69.9, 0.1),
        (0.0, 1e9, 0.1),
    ],
)
def test_governor_takes_the_larger_of_measured_and_expected_force(
    load_mN: float, expected_mN: float, speed_mm_s: float
) -> None:
    sideways = proposal((20e-6, 0.0, 0.0), expected_force=(expected_mN * 1e-3, 0.0, 0.0))
    verdict, step = judged(sideways, sample=sample((load_mN * 1e-3, 0.0, 0.0)))
    assert step is not None
    assert step.speed_m_s == pytest.approx(speed_mm_s * 1e-3, abs=1e-7)
    assert rules(verdict) == ({Rule.GOVERNOR} if speed_mm_s < 1.5 else set())


@pytest.mark.parametrize("sign", [-1.0, 1.0])
@pytest.mark.parametrize(
    ("axis", "translation", "expected_mN", "speed_mm_s"),
    [
        (0, (20e-6, 0.0, 0.0), 35.0, 0.8940),
        (1, (20e-6, 0.0, 0.0), 65.0, 0.8940),
        (2, (20e-6, 0.0, 0.0), 930.0, 1.5707),
        (2, (0.0, 0.0, 60e-6), 965.0, 2.6368),
    ],
)
def test_the_expected_force_is_held_against_the_limit_of_its_axis(
    axis: int, sign: float, translation: Vector3, expected_mN: float, speed_mm_s: float
) -> None:
    expected = [0.0, 0.0, 0.0]
    expected[axis] = sign * expected_mN * 1e-3
    _, step = judged(proposal(translation, expected_force=tuple(expected)))
    assert step is not None
    assert step.speed_m_s == pytest.approx(speed_mm_s * 1e-3, abs=1e-7)


def test_rotation_is_governed_by_its_lever_and_the_angular_limit() -> None:
    """0.05 deg on 4 mm are 3.49 um across the hole; 1 deg/s on 4 mm is 69.8 um/s."""
    turn = math.radians(0.05)
    _, step = judged(proposal((0.0, 0.0, 0.0), rotation=(turn, 0.0, 0.0)))
    assert step is not None
    assert step.travel.radial_m == pytest.approx(3.4907e-6, abs=1e-10)
    assert step.speed_m_s == pytest.approx(69.813e-6, abs=1e-9)


@pytest.mark.parametrize("sign", [-1.0, 1.0])
@pytest.mark.parametrize(
    ("axis", "translation", "load_N", "std_N", "speed_mm_s"),
    [
        (0, (20e-6, 0.0, 0.0), 0.035, 0.0, 0.8940),
        (1, (20e-6, 0.0, 0.0), 0.065, 0.0, 0.8940),
        (2, (0.0, 0.0, 60e-6), 0.965, 0.0, 2.6368),
        (0, (20e-6, 0.0, 0.0), 0.005, 0.010, 0.8940),
        (1, (20e-6, 0.0, 0.0), 0.035, 0.010, 0.8940),
        (2, (0.0, 0.0, 60e-6), 0.935, 0.010, 2.6368),
    ],
)
def test_governor_on_the_estimate_alone(
    axis: int, sign: float, translation: Vector3, load_N: float, std_N: float, speed_mm_s: float
) -> None:
    wrench, std = [0.0] * 6, [0.0] * 6
    wrench[axis], std[axis] = sign * load_N, std_N
    seen = estimate(wrench=tuple(wrench), std=tuple(std))
    _, step = judged(proposal(translation), estimate=seen)
    assert step is not None
    assert step.speed_m_s == pytest.approx(speed_mm_s * 1e-3, abs=1e-7)


@pytest.mark.parametrize(
    ("translation", "load_mN", "is_told"),
    [
        # without load 4.2450 mm/s along the hole and 1.5707 mm/s across it; 10 % less is told
        ((0.0, 0.0, 60e-6), 10.2, False),
        ((0.0, 0.0, 60e-6), 10.3, True),
        ((20e-6, 0.0, 0.0), 8.7, False),
        ((20e-6, 0.0, 0.0), -8.7, False),
        ((20e-6, 0.0, 0.0), 8.8, True),
        ((20e-6, 0.0, 0.0), -8.8, True),
    ],
)
def test_a_step_is_reduced_once_the_load_takes_a_tenth_of_its_speed(
    translation: Vector3, load_mN: float, is_told: bool
) -> None:
    verdict, step = judged(proposal(translation), sample=sample((load_mN * 1e-3, 0.0, 0.0)))
    assert step is not None
    assert verdict.severity is (Severity.REDUCE if is_told else Severity.PASS)
    assert rules(verdict) == ({Rule.GOVERNOR} if is_told else set())


def test_exactly_a_tenth_slower_is_not_told() -> None:
    brisk = {"speed_m_s": 1.0, "creep_speed_m_s": 0.9, "deceleration_m_s2": 1e6, "reaction_s": 0.0}
    limits = LIMITS.model_copy(update=brisk)
    loaded = snapshot(sample=sample((0.0699999, 0.0, 0.0)))
    wish = proposal((20e-6, 0.0, 0.0))
    verdict, step = judge(limits, HOLD_POSE, Verdict(NOW), loaded, wish, NOW)
    assert step is not None
    assert step.speed_m_s == 0.9
    assert verdict.severity is Severity.PASS


def test_a_turn_at_the_angular_limit_is_not_slowed_by_a_load() -> None:
    turn = proposal((0.0, 0.0, 0.0), rotation=(math.radians(0.05), 0.0, 0.0))
    verdict, step = judged(turn, sample=sample((0.069, 0.0, 0.0)))
    assert step is not None
    assert step.speed_m_s == pytest.approx(4e-3 * math.radians(1.0))
    assert verdict.severity is Severity.PASS
