"""The supervisor's view of a proposed step. Limits are restated here as literals."""

import math
from typing import Any

import pytest

from controllers.governor import Travel
from controllers.messages import FilterHealth, Reason, Rule, Severity, Verdict
from controllers.supervisor import Step, displaced, judge
from drivers.contract.messages import Pose, Vector3
from tests.controllers.builders import (
    HOLD_POSE,
    LIMITS,
    MS,
    NOT_FINITE,
    NOW,
    arm,
    estimate,
    gripper,
    judged,
    proposal,
    rules,
    sample,
    snapshot,
    stage,
)


def standing(severity: Severity) -> Verdict:
    return Verdict(NOW, (Reason(Rule.IMPULSE, severity, "for the test"),))


def test_an_ordinary_step_is_sent_as_proposed() -> None:
    verdict, step = judged(proposal((1e-6, -2e-6, 60e-6)))
    assert step is not None
    assert step.translation == (1e-6, -2e-6, 60e-6)
    assert verdict.severity is Severity.PASS


@pytest.mark.parametrize(
    ("translation_um", "allowed_um"),
    [
        ((20.0, 20.0, 60.0), (20.0, 20.0, 60.0)),
        ((20.001, 0.0, 0.0), (20.0, 0.0, 0.0)),
        ((-20.001, 0.0, 0.0), (-20.0, 0.0, 0.0)),
        ((0.0, 21.0, 0.0), (0.0, 20.0, 0.0)),
        ((0.0, -21.0, 0.0), (0.0, -20.0, 0.0)),
        ((0.0, 0.0, 60.001), (0.0, 0.0, 60.0)),
        ((0.0, 0.0, -60.001), (0.0, 0.0, -60.0)),
        ((1e9, -1e9, 1e9), (20.0, -20.0, 60.0)),
    ],
)
def test_step_box(translation_um: Vector3, allowed_um: Vector3) -> None:
    x, y, z = translation_um
    verdict, step = judged(proposal((x * 1e-6, y * 1e-6, z * 1e-6)))
    assert step is not None
    assert step.translation == pytest.approx(tuple(v * 1e-6 for v in allowed_um), rel=1e-12)
    is_cut = translation_um != allowed_um
    assert verdict.severity is (Severity.REDUCE if is_cut else Severity.PASS)
    assert rules(verdict) == ({Rule.STEP_BOX} if is_cut else set())


@pytest.mark.parametrize("axis", range(3))
@pytest.mark.parametrize("sign", [-1.0, 1.0])
@pytest.mark.parametrize(("turn_deg", "sent_deg"), [(0.0499, 0.0499), (0.0501, 0.05), (90.0, 0.05)])
def test_rotation_step(axis: int, sign: float, turn_deg: float, sent_deg: float) -> None:
    rotation = [0.0, 0.0, 0.0]
    rotation[axis] = sign * math.radians(turn_deg)
    verdict, step = judged(proposal((0.0, 0.0, 0.0), rotation=tuple(rotation)))
    assert step is not None
    assert step.rotation[axis] == pytest.approx(sign * math.radians(sent_deg))
    assert sum(map(abs, step.rotation)) == abs(step.rotation[axis])
    assert (Rule.STEP_BOX in rules(verdict)) is (turn_deg > 0.05)


@pytest.mark.parametrize("axis", range(3))
@pytest.mark.parametrize("sign", [-1.0, 1.0])
def test_a_turn_at_its_limit_is_not_cut_and_the_next_number_is(axis: int, sign: float) -> None:
    limit = math.radians(0.05)
    for turn, is_cut in ((limit, False), (math.nextafter(limit, 1.0), True)):
        rotation = [0.0, 0.0, 0.0]
        rotation[axis] = sign * turn
        verdict, step = judged(proposal((0.0, 0.0, 0.0), rotation=tuple(rotation)))
        assert step is not None
        assert step.rotation[axis] == sign * limit
        assert (Rule.STEP_BOX in rules(verdict)) is is_cut


def test_a_move_that_turns_is_cut_along_and_about_each_axis() -> None:
    """20 um and 0.05 deg on 4 mm are 23.49 um across the hole; 1 deg/s allows 0.05 s for it."""
    turn = tuple(math.radians(v) for v in (0.0, -0.3, 0.0))
    verdict, step = judged(proposal((25e-6, 0.0, 0.0), rotation=turn))
    assert step is not None
    assert step.translation == pytest.approx((20e-6, 0.0, 0.0))
    assert step.rotation == pytest.approx((0.0, -8.7266e-4, 0.0), abs=1e-8)
    assert step.travel.radial_m == pytest.approx(23.4907e-6, abs=1e-10)
    assert step.speed_m_s == pytest.approx(469.81e-6, abs=1e-8)
    assert [r.rule for r in verdict.reasons].count(Rule.STEP_BOX) == 2


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


@pytest.mark.parametrize(
    ("axis", "expected_mN", "speed_mm_s"), [(1, 65.0, 0.8940), (2, 930.0, 1.5707)]
)
def test_the_expected_force_is_held_against_the_limit_of_its_axis(
    axis: int, expected_mN: float, speed_mm_s: float
) -> None:
    expected = [0.0, 0.0, 0.0]
    expected[axis] = expected_mN * 1e-3
    _, step = judged(proposal((20e-6, 0.0, 0.0), expected_force=tuple(expected)))
    assert step is not None
    assert step.speed_m_s == pytest.approx(speed_mm_s * 1e-3, abs=1e-7)


def test_rotation_is_governed_by_its_lever_and_the_angular_limit() -> None:
    """0.05 deg on 4 mm are 3.49 um across the hole; 1 deg/s on 4 mm is 69.8 um/s."""
    turn = math.radians(0.05)
    _, step = judged(proposal((0.0, 0.0, 0.0), rotation=(turn, 0.0, 0.0)))
    assert step is not None
    assert step.travel.radial_m == pytest.approx(3.4907e-6, abs=1e-10)
    assert step.speed_m_s == pytest.approx(69.813e-6, abs=1e-9)


@pytest.mark.parametrize(
    ("position_um", "translation_um", "inside"),
    [
        ((190.0, 0.0, 0.0), (9.9, 0.0, 0.0), True),
        ((190.0, 0.0, 0.0), (10.1, 0.0, 0.0), False),
        ((0.0, -190.0, 0.0), (0.0, -9.9, 0.0), True),
        ((0.0, -190.0, 0.0), (0.0, -10.1, 0.0), False),
        ((0.0, 0.0, 3550.0), (0.0, 0.0, 49.9), True),
        ((0.0, 0.0, 3550.0), (0.0, 0.0, 50.1), False),
        ((0.0, 0.0, -950.0), (0.0, 0.0, -49.9), True),
        ((0.0, 0.0, -950.0), (0.0, 0.0, -50.1), False),
    ],
)
def test_workspace(position_um: Vector3, translation_um: Vector3, inside: bool) -> None:
    x, y, z = (v * 1e-6 for v in position_um)
    dx, dy, dz = (v * 1e-6 for v in translation_um)
    verdict, step = judged(proposal((dx, dy, dz)), stage=stage(pose=Pose((x, y, z))))
    assert (step is not None) is inside
    assert (Rule.WORKSPACE in rules(verdict)) is not inside
    assert (verdict.severity is Severity.HOLD) is not inside


@pytest.mark.parametrize(("tilt_deg", "inside"), [(0.559, True), (0.561, False)])
def test_tilt(tilt_deg: float, inside: bool) -> None:
    state = stage(pose=Pose((0.0, 0.0, 0.0), (math.radians(tilt_deg), 0.0, 0.0)))
    turn = proposal((0.0, 0.0, 0.0), rotation=(math.radians(0.04), 0.0, 0.0))
    _, step = judged(turn, stage=state)
    assert (step is not None) is inside


@pytest.mark.parametrize(("tilt_deg", "inside"), [(0.599, True), (0.601, False)])
@pytest.mark.parametrize("signs", [(1.0, 1.0, 1.0), (-1.0, 1.0, -1.0), (1.0, -1.0, -1.0)])
def test_tilt_counts_all_axes_together(signs: Vector3, tilt_deg: float, inside: bool) -> None:
    """Shares 2, 3 and 6 of 7 about x, y and z; the last 0.04 deg about each are asked for."""
    there = [
        math.radians(tilt_deg) * s * share / 7.0 for s, share in zip(signs, (2, 3, 6), strict=True)
    ]
    step = [s * math.radians(0.04) for s in signs]
    x, y, z = (t - s for t, s in zip(there, step, strict=True))
    state = stage(pose=Pose((0.0, 0.0, 0.0), (x, y, z)))
    verdict, sent = judged(proposal((0.0, 0.0, 0.0), rotation=tuple(step)), stage=state)
    assert (sent is not None) is inside
    assert (Rule.WORKSPACE in rules(verdict)) is not inside


@pytest.mark.parametrize(
    ("age_ms", "sent"),
    [(-0.001, False), (0.0, True), (50.0, True), (50.001, False)],
)
def test_stale_proposal(age_ms: float, sent: bool) -> None:
    verdict, step = judged(proposal(stamp_ns=NOW - round(age_ms * MS)))
    assert (step is not None) is sent
    assert (Rule.STALE_PROPOSAL in rules(verdict)) is not sent
    if not sent:
        assert verdict.severity is Severity.HOLD


@pytest.mark.parametrize(("late_ms", "sent"), [(0.0, True), (20.0, True), (20.001, False)])
def test_stale_snapshot(late_ms: float, sent: bool) -> None:
    now_ns = NOW + round(late_ms * MS)
    verdict, step = judged(proposal(stamp_ns=now_ns), now_ns=now_ns)
    assert (step is not None) is sent
    assert (Rule.HEARTBEAT in rules(verdict)) is not sent


@pytest.mark.parametrize("value", NOT_FINITE)
@pytest.mark.parametrize("axis", range(3))
def test_non_finite_proposal_stops(axis: int, value: float) -> None:
    broken = [0.0, 0.0, 0.0]
    broken[axis] = value
    vector = (broken[0], broken[1], broken[2])
    still = (0.0, 0.0, 0.0)
    for wrong in (
        proposal(vector),
        proposal(still, rotation=vector),
        proposal(still, expected_force=vector),
    ):
        verdict, step = judged(wrong)
        assert step is None
        assert verdict.severity is Severity.STOP
        assert rules(verdict) == {Rule.NON_FINITE}


@pytest.mark.parametrize("severity", [Severity.HOLD, Severity.STOP])
@pytest.mark.parametrize("dz_um", [-60.0, 0.0, 60.0])
def test_nothing_is_sent_under_a_hold_or_a_stop(severity: Severity, dz_um: float) -> None:
    verdict, step = judged(proposal((0.0, 0.0, dz_um * 1e-6)), standing(severity))
    assert step is None
    assert verdict.severity is severity


OUT_OR_NOT = [
    ((0.0, 0.0, -1e-6), True),
    ((0.0, 0.0, 0.0), False),
    ((0.0, 0.0, 1e-6), False),
    ((3e-6, 4e-6, -5.001e-6), True),
    ((5e-6, 0.0, -5e-6), True),
    ((3e-6, -4e-6, -4.999e-6), False),
    ((20e-6, 0.0, -1e-14), False),
    ((0.0, 0.0, -1e-16), False),  # no stage moves by so little
    ((1.0, 0.0, -60e-6), True),  # what counts is what would be sent: 20 um against 60 um
    ((20e-6, 20e-6, -28e-6), False),
]


@pytest.mark.parametrize(("translation", "sent"), OUT_OR_NOT)
def test_in_retreat_only_steps_out_are_sent(translation: Vector3, sent: bool) -> None:
    """A step is one out if it goes no farther sideways than out."""
    verdict, step = judged(proposal(translation), standing(Severity.RETREAT))
    assert (step is not None) is sent
    assert verdict.severity is Severity.RETREAT
    assert (Rule.RETREATING in rules(verdict)) is not sent


def test_in_retreat_nothing_is_sent_while_something_holds_as_well() -> None:
    both = (*standing(Severity.RETREAT).reasons, *standing(Severity.HOLD).reasons)
    for reasons in (both, both[::-1]):
        verdict, step = judged(proposal((0.0, 0.0, -60e-6)), Verdict(NOW, reasons))
        assert step is None
        assert verdict.severity is Severity.RETREAT


@pytest.mark.parametrize(("dz_um", "sent"), [(-3.48, False), (-3.50, True)])
def test_a_turn_on_the_way_out_counts_with_its_lever(dz_um: float, sent: bool) -> None:
    """0.05 deg on 4 mm are 3.49 um sideways; a larger turn is cut to that."""
    turn = proposal((0.0, 0.0, dz_um * 1e-6), rotation=(0.0, math.radians(0.1), 0.0))
    _, step = judged(turn, standing(Severity.RETREAT))
    assert (step is not None) is sent


@pytest.mark.parametrize(("translation", "sent"), OUT_OR_NOT)
def test_without_a_part_only_steps_out_are_sent(translation: Vector3, sent: bool) -> None:
    let_go = gripper(valve_open=False, part_held=False)
    verdict, step = judged(proposal(translation), gripper=let_go)
    assert (step is not None) is sent
    assert (Rule.VACUUM in rules(verdict)) is not sent


@pytest.mark.parametrize("severity", [Severity.PASS, Severity.REDUCE])
def test_steps_are_sent_under_pass_and_reduce(severity: Severity) -> None:
    reasons = () if severity is Severity.PASS else standing(severity).reasons
    _, step = judged(proposal(), Verdict(NOW, reasons))
    assert step is not None


def test_a_step_is_sent_only_from_rest() -> None:
    verdict, step = judged(proposal(), stage=stage(moving=True))
    assert step is None
    assert rules(verdict) == {Rule.BUSY}
    assert verdict.severity is Severity.HOLD


@pytest.mark.parametrize("missing", ["stage", "arm", "gripper", "estimate"])
def test_without_data_the_standing_hold_refuses(missing: str) -> None:
    verdict, step = judged(proposal(), standing(Severity.HOLD), **{missing: None})
    assert step is None
    assert verdict.severity is Severity.HOLD


GOING_IN: list[tuple[dict[str, Any], Rule]] = [
    ({"estimate": estimate(health=FilterHealth.UNTARED)}, Rule.UNTARED),
    ({"gripper": gripper(part_held=False)}, Rule.VACUUM),
    ({"gripper": gripper(valve_open=False)}, Rule.VACUUM),
    ({"gripper": gripper(valve_open=False, part_held=False)}, Rule.VACUUM),
    ({"arm": arm(moving=True)}, Rule.KEEP_OUT),
    ({"arm": arm(pose=Pose((5.1e-6, 0.0, 0.0)))}, Rule.KEEP_OUT),
    ({"arm": arm(pose=Pose((0.0, 0.0, 0.0), (0.5, 0.0, 0.0)))}, Rule.KEEP_OUT),
]


@pytest.mark.parametrize(("changes", "rule"), GOING_IN)
@pytest.mark.parametrize(
    ("depth_um", "dz_um", "sent"),
    [
        (-161.0, 60.0, True),
        (-159.0, 60.0, False),
        (1000.0, 60.0, False),
        (1000.0, 0.0, False),
        (1000.0, -60.0, True),
    ],
)
def test_conditions_for_going_in(
    changes: dict[str, Any], rule: Rule, depth_um: float, dz_um: float, sent: bool
) -> None:
    """A step that ends deeper than -100 um needs tare, part and arm; a step out does not."""
    verdict, step = judged(
        proposal((0.0, 0.0, dz_um * 1e-6)), stage=stage(depth_um * 1e-6), **changes
    )
    assert (step is not None) is sent
    assert (rule in rules(verdict)) is not sent
    if not sent:
        assert verdict.severity is Severity.HOLD


@pytest.mark.parametrize(("is_open", "text"), [(True, "no part held"), (False, "valve closed")])
def test_what_is_wrong_with_the_vacuum_is_told(is_open: bool, text: str) -> None:
    verdict, _ = judged(proposal(), gripper=gripper(valve_open=is_open, part_held=not is_open))
    assert [str(r) for r in verdict.reasons] == [f"vacuum lost: {text}"]


def test_the_verdict_on_a_proposal_carries_the_standing_reasons() -> None:
    verdict, _ = judged(proposal((30e-6, 0.0, 0.0)), standing(Severity.REDUCE))
    assert rules(verdict) == {Rule.IMPULSE, Rule.STEP_BOX}
    assert verdict.speed_cap_m_s == pytest.approx(1.5707e-3, abs=1e-7)


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


def test_a_step_within_all_limits_passes_without_a_reason() -> None:
    verdict, step = judged(proposal((0.0, 0.0, 0.0)))
    assert step is not None
    assert verdict.reasons == ()
    assert verdict.speed_cap_m_s == 0.005


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


def test_clipping_reduces_and_does_no_more() -> None:
    for wish in (
        proposal((21e-6, 0.0, 0.0)),
        proposal((0.0, 0.0, 0.0), rotation=(math.radians(0.06), 0.0, 0.0)),
    ):
        verdict, step = judged(wish)
        assert step is not None
        assert [(r.rule, r.severity) for r in verdict.reasons] == [(Rule.STEP_BOX, Severity.REDUCE)]


def test_the_refusal_of_a_step_in_during_a_retreat_is_a_hold() -> None:
    verdict, _ = judged(proposal(), standing(Severity.RETREAT))
    assert [(r.rule, r.severity) for r in verdict.reasons] == [
        (Rule.IMPULSE, Severity.RETREAT),
        (Rule.RETREATING, Severity.HOLD),
    ]


def test_a_proposal_that_is_no_number_is_judged_no_further() -> None:
    verdict, _ = judged(proposal((math.nan, 0.0, 0.0), stamp_ns=NOW - 60 * MS))
    assert rules(verdict) == {Rule.NON_FINITE}


@pytest.mark.parametrize(
    ("depth_m", "sent"),
    [(-100.5e-6, True), (-100e-6, True), (math.nextafter(-100e-6, 0.0), False), (-99.5e-6, False)],
)
def test_a_step_may_end_at_the_clear_depth(depth_m: float, sent: bool) -> None:
    _, step = judged(
        proposal((1e-6, 0.0, 0.0)), stage=stage(depth_m), gripper=gripper(part_held=False)
    )
    assert (step is not None) is sent


def test_without_a_stage_state_nothing_is_sent_whatever_stands() -> None:
    _, step = judged(proposal(), Verdict(NOW), stage=None)
    assert step is None


def test_a_step_is_added_to_the_pose() -> None:
    pose = Pose((1.0, 2.0, 3.0), (4.0, 5.0, 6.0))
    step = Step((0.1, 0.2, 0.3), (0.4, 0.5, 0.6), Travel(0.0, 0.0, 0.0, 0.0), 0.0)
    moved = displaced(pose, step)
    assert moved.position == pytest.approx((1.1, 2.2, 3.3))
    assert moved.rotation == pytest.approx((4.4, 5.5, 6.6))
