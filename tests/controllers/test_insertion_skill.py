"""The insertion skill, shown one observation at a time."""

import pytest

from controllers.insertion import InsertionSkill
from controllers.messages import Move, Observation, Reason, Rule, Severity, SkillPhase, Verdict
from controllers.proportional import ProportionalController
from controllers.settings import InsertionSettings, ProportionalSettings, SkillSettings
from drivers.contract.messages import Pose, Vector3

MS = 1_000_000
BOX = (20e-6, 20e-6, 60e-6)
SKILL = SkillSettings.model_validate(
    {
        "start_depth_um": -300.0,
        "settle_time_ms": 10.0,
        "hold_timeout_ms": 500.0,
        "contact_force_mN": 10.0,
    }
)
INSERTION = InsertionSettings.model_validate(
    {"stroke_um": 3200.0, "steps_max": 100, "finish_force_mN": 1000.0, "axial_step_um": 60.0}
)


TURN = (3e-4, -4e-4, 0.0)


class Straight:
    """Goes in by 50 um and a little sideways, and turns a little."""

    def step(self, observation: Observation) -> Move:
        return Move((1e-6, 2e-6, 50e-6), TURN)


def new_skill() -> InsertionSkill:
    return InsertionSkill(SKILL, INSERTION, Straight(), BOX)


def seen(depth_um: float, force_mN: Vector3 = (0.0, 0.0, 0.0)) -> Observation:
    fx, fy, fz = (f * 1e-3 for f in force_mN)
    wrench = (fx, fy, fz, 0.0, 0.0, 0.0)
    pose = Pose((0.0, 0.0, depth_um * 1e-6))
    return Observation(0, 0, wrench, (0.0,) * 6, pose, (0.0,) * 3, pose)


def straight(dz_m: float) -> Move:
    """What the skill itself proposes: along z, without a turn."""
    return Move((0.0, 0.0, pytest.approx(dz_m)), (0.0, 0.0, 0.0))


def verdict(severity: Severity, at_ms: float = 0.0) -> Verdict:
    reasons = () if severity is Severity.PASS else (Reason(Rule.FORCE, severity, "too much"),)
    return Verdict(round(at_ms * MS), reasons)


def inserting() -> InsertionSkill:
    skill = new_skill()
    skill.next_step(seen(0.0))
    assert skill.phase is SkillPhase.INSERT
    return skill


def test_it_approaches_by_whole_steps_and_stops_short_at_the_rim() -> None:
    skill = new_skill()
    for depth, dz in ((-300.0, 60e-6), (-81.0, 60e-6), (-45.0, 25e-6)):
        assert skill.next_step(seen(depth)) == straight(dz)
        assert skill.phase is SkillPhase.APPROACH
    assert skill.next_step(seen(-20.0, (30.0, 0.0, 0.0))) is not None
    assert skill.phase is SkillPhase.RETRACT, "nothing can touch at 20 um above the rim"
    skill = new_skill()
    assert skill.next_step(seen(-20.0)) == Move((1e-6, 2e-6, 50e-6), TURN)
    assert skill.phase is SkillPhase.INSERT


@pytest.mark.parametrize(("force_mN", "contact"), [(9.9, False), (10.1, True)])
@pytest.mark.parametrize("axis", range(3))
@pytest.mark.parametrize("sign", [-1.0, 1.0])
def test_contact_in_the_approach(axis: int, sign: float, force_mN: float, contact: bool) -> None:
    force = [0.0, 0.0, 0.0]
    force[axis] = sign * force_mN
    skill = new_skill()
    step = skill.next_step(seen(-150.0, (force[0], force[1], force[2])))
    assert (skill.phase is SkillPhase.RETRACT) is contact
    assert step is not None
    assert (step.translation[2] < 0.0) is contact
    assert step.rotation == (0.0, 0.0, 0.0)
    if contact:
        assert skill.reason == "contact in the approach: 10.1 mN"


def test_the_last_step_ends_at_the_stroke_and_the_insertion_is_done() -> None:
    skill = inserting()
    move = skill.next_step(seen(3180.0))
    assert move is not None
    assert move.translation == pytest.approx((1e-6, 2e-6, 20e-6))
    assert move.rotation == TURN, "it may turn to its end"
    assert skill.next_step(seen(3200.0)) is None
    assert (skill.phase, skill.reason) == (SkillPhase.DONE, "")


@pytest.mark.parametrize(("force_mN", "blocked"), [(999.0, False), (1000.0, True)])
def test_blocked(force_mN: float, blocked: bool) -> None:
    skill = inserting()
    skill.next_step(seen(1234.0, (0.0, 0.0, force_mN)))
    assert (skill.phase is SkillPhase.RETRACT) is blocked
    if blocked:
        assert skill.reason == "blocked at 1234 um: axial force 1000 mN"


def test_only_sent_steps_of_the_insert_phase_count_and_there_is_a_limit() -> None:
    skill = new_skill()
    skill.next_step(seen(-300.0))
    skill.heed(verdict(Severity.PASS), was_sent=True)
    assert skill.steps == 0
    skill.next_step(seen(0.0))
    for number in range(1, 101):
        skill.heed(verdict(Severity.HOLD, number), was_sent=False)
        skill.heed(verdict(Severity.REDUCE, number), was_sent=True)
        assert skill.steps == number
        assert skill.phase is SkillPhase.INSERT
        skill.next_step(seen(500.0))
    assert (skill.phase, skill.reason) == (SkillPhase.RETRACT, "not inserted after 100 steps")


def test_after_a_failure_it_leads_back_out_and_keeps_the_reason() -> None:
    skill = inserting()
    skill.heed(verdict(Severity.RETREAT), was_sent=True)
    assert (skill.phase, skill.reason) == (SkillPhase.RETRACT, "force limit: too much")
    assert skill.next_step(seen(500.0)) == straight(-60e-6)
    skill.heed(verdict(Severity.RETREAT), was_sent=True)
    assert skill.next_step(seen(-280.0)) == straight(-20e-6)
    assert skill.next_step(seen(-300.0)) is None
    assert (skill.phase, skill.reason) == (SkillPhase.FAILED, "force limit: too much")


@pytest.mark.parametrize("phase", [SkillPhase.APPROACH, SkillPhase.INSERT, SkillPhase.RETRACT])
def test_a_stop_ends_it_where_it_is(phase: SkillPhase) -> None:
    skill = new_skill() if phase is SkillPhase.APPROACH else inserting()
    if phase is SkillPhase.RETRACT:
        skill.heed(verdict(Severity.RETREAT), was_sent=True)
    assert skill.phase is phase
    skill.heed(verdict(Severity.STOP), was_sent=False)
    assert (skill.phase, skill.reason) == (SkillPhase.FAILED, "force limit: too much")
    assert skill.next_step(seen(500.0)) is None


def test_a_hold_is_waited_for_but_not_for_ever() -> None:
    skill = inserting()
    skill.heed(verdict(Severity.HOLD, 0.0), was_sent=False)
    skill.heed(verdict(Severity.HOLD, 500.0), was_sent=False)
    assert skill.phase is SkillPhase.INSERT
    skill.heed(verdict(Severity.PASS, 501.0), was_sent=True)
    skill.heed(verdict(Severity.HOLD, 502.0), was_sent=False)
    skill.heed(verdict(Severity.HOLD, 1002.0), was_sent=False)
    assert skill.phase is SkillPhase.INSERT, "the hold before does not count"
    skill.heed(verdict(Severity.HOLD, 1002.1), was_sent=False)
    assert skill.phase is SkillPhase.RETRACT
    assert skill.reason == "held too long: force limit: too much"
    skill.heed(verdict(Severity.HOLD, 1003.0), was_sent=False)
    assert skill.phase is SkillPhase.RETRACT
    skill.heed(verdict(Severity.HOLD, 1504.0), was_sent=False)
    assert skill.phase is SkillPhase.FAILED


def test_a_way_out_that_is_refused_is_not_tried_for_ever() -> None:
    skill = inserting()
    skill.heed(verdict(Severity.RETREAT, 0.0), was_sent=False)
    skill.heed(verdict(Severity.RETREAT, 500.0), was_sent=False)
    assert (skill.phase, skill.reason) == (SkillPhase.RETRACT, "force limit: too much")
    skill.heed(verdict(Severity.RETREAT, 500.1), was_sent=False)
    assert skill.phase is SkillPhase.FAILED
    assert skill.reason == "held too long: force limit: too much"


@pytest.mark.parametrize(
    ("gain_factor", "force_mN", "step_um"),
    [
        (0.2, (10.0, 0.0, 5.0), (-1.6, 0.0, 60.0)),
        (0.2, (0.0, -40.0, 5.0), (0.0, 6.4, 60.0)),
        (1.0, (10.0, -5.0, 900.0), (-8.0, 4.0, 60.0)),
    ],
)
def test_expert_and_conventional_controller(
    gain_factor: float, force_mN: Vector3, step_um: Vector3
) -> None:
    """Eq. (6): 160 um/N for the expert, 800 um/N for the conventional one."""
    controller = ProportionalController(
        ProportionalSettings.model_validate(
            {"kind": "proportional", "force_jacobian_um_N": 800.0, "lambda": gain_factor}
        ),
        60e-6,
    )
    step = controller.step(seen(100.0, force_mN))
    assert step.translation == pytest.approx(tuple(v * 1e-6 for v in step_um), abs=1e-18)
    assert step.rotation == (0.0, 0.0, 0.0)
