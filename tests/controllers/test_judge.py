"""The supervisor's view of a proposed step: whether it is sent. Limits are literals."""

import math
from typing import Any

import pytest

from controllers.messages import FilterHealth, Reason, Rule, Severity, Verdict
from drivers.contract.messages import Pose, Vector3
from tests.controllers.builders import (
    MS,
    NOT_FINITE,
    NOW,
    arm,
    estimate,
    gripper,
    judged,
    proposal,
    rules,
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


def test_a_step_within_all_limits_passes_without_a_reason() -> None:
    verdict, step = judged(proposal((0.0, 0.0, 0.0)))
    assert step is not None
    assert verdict.reasons == ()
    assert verdict.speed_cap_m_s == 0.005


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
