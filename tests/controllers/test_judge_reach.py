"""How far a proposed step may go. Limits are restated here as literals."""

import math

import pytest

from controllers.governor import Travel
from controllers.messages import Rule, Severity
from controllers.supervisor import Step, displaced
from drivers.contract.messages import Pose, Vector3
from tests.controllers.builders import judged, proposal, rules, stage


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


def test_clipping_reduces_and_does_no_more() -> None:
    for wish in (
        proposal((21e-6, 0.0, 0.0)),
        proposal((0.0, 0.0, 0.0), rotation=(math.radians(0.06), 0.0, 0.0)),
    ):
        verdict, step = judged(wish)
        assert step is not None
        assert [(r.rule, r.severity) for r in verdict.reasons] == [(Rule.STEP_BOX, Severity.REDUCE)]


def test_a_step_is_added_to_the_pose() -> None:
    pose = Pose((1.0, 2.0, 3.0), (4.0, 5.0, 6.0))
    step = Step((0.1, 0.2, 0.3), (0.4, 0.5, 0.6), Travel(0.0, 0.0, 0.0, 0.0), 0.0)
    moved = displaced(pose, step)
    assert moved.position == pytest.approx((1.1, 2.2, 3.3))
    assert moved.rotation == pytest.approx((4.4, 5.5, 6.6))
