"""Expert and residual together."""

import dataclasses
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from controllers.messages import Observation
from controllers.proportional import ProportionalController
from controllers.settings import ProportionalSettings
from drivers.contract.messages import Pose, Vector3
from learning.policy.expert import Approach, Expert
from learning.policy.inputs import Input, Output
from learning.policy.policy import Layer, Policy
from learning.skill_controller import SkillController
from tests.learning.policy.policies import inputs, outputs, random_policy, zero_policy

EXPERT = Expert(gain_m_N=160e-6, axial_step_m=50e-6, step_box_m=(20e-6, 20e-6, 60e-6))


def seen(force: Vector3, depth_m: float = 1e-3, step: int = 0) -> Observation:
    wrench = (*force, 0.0, 0.0, 0.0)
    pose = Pose((0.0, 0.0, depth_m))
    return Observation(0, step, wrench, (0.0,) * 6, pose, (0.0, 0.0, depth_m), pose)


def constant(**answers: float) -> Policy:
    """Answers so many SI units, whatever it sees; each at most 40 um or 0.8 mrad."""
    scales = {name: 8e-4 if name.startswith("turn") else 40e-6 for name in answers}
    bias = np.array([math.atanh(value / scales[name]) for name, value in answers.items()])
    return Policy(
        inputs("force_x"),
        tuple(Output(name, scale) for name, scale in scales.items()),
        2.0,
        (Layer(np.zeros((len(bias), 1)), bias),),
        EXPERT,
    )


def test_the_residual_is_added_to_the_expert() -> None:
    controller = SkillController(constant(step_x=3e-6, step_y=-1e-6, step_z=-20e-6, turn_x=2e-4))
    move = controller.step(seen((0.010, -0.020, 0.5)))
    assert move.translation == pytest.approx((1.4e-6, 2.2e-6, 30e-6), abs=1e-11)
    assert move.rotation == pytest.approx((2e-4, 0.0, 0.0), abs=1e-10)


def test_outputs_go_where_their_names_say_in_any_order() -> None:
    move = SkillController(constant(turn_y=-3e-4, step_z=5e-6)).step(seen((0.0, 0.0, 0.0)))
    assert move.translation == pytest.approx((0.0, 0.0, 55e-6), abs=1e-11)
    assert move.rotation == pytest.approx((0.0, -3e-4, 0.0), abs=1e-10)


@pytest.mark.parametrize(
    ("residual", "force", "translation_um"),
    [
        ({"step_x": 25e-6}, (0.0, 0.0, 0.0), (20.0, 0.0, 50.0)),
        ({"step_x": 25e-6}, (0.1, 0.0, 0.0), (9.0, 0.0, 50.0)),
        ({"step_y": -25e-6}, (0.0, 0.0, 0.0), (0.0, -20.0, 50.0)),
        ({"step_z": 15e-6}, (0.0, 0.0, 0.0), (0.0, 0.0, 60.0)),
        ({"step_z": -30e-6}, (0.0, 0.0, 0.0), (0.0, 0.0, 20.0)),
        ({"step_z": 0.0}, (0.2, -0.2, 0.0), (-20.0, 20.0, 50.0)),
    ],
)
def test_the_sum_is_cut_to_the_step_box(
    residual: dict[str, float], force: Vector3, translation_um: Vector3
) -> None:
    move = SkillController(constant(**residual)).step(seen(force))
    assert move.translation == pytest.approx([v * 1e-6 for v in translation_um], abs=1e-11)


@given(st.integers(0, 2**32 - 1), st.tuples(*[st.floats(-2.0, 2.0)] * 3), st.floats(-1e-3, 4e-3))
def test_whatever_is_seen_no_move_leaves_the_step_box(
    seed: int, force: Vector3, depth_m: float
) -> None:
    policy = random_policy(seed, answered=("step_x", "step_y", "step_z", "turn_x", "turn_y"))
    move = SkillController(policy).step(seen(force, depth_m))
    for value, box in zip(move.translation, (20e-6, 20e-6, 60e-6), strict=True):
        assert abs(value) <= box
    assert all(abs(value) <= 8e-4 for value in move.rotation)


@pytest.mark.parametrize("axis", range(3))
@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
def test_what_is_not_finite_is_not_made_so(axis: int, value: float) -> None:
    """The expert does not look at the axial force: an infinite one is cut to the policy's bound."""
    force = [0.0, 0.0, 0.0]
    force[axis] = value
    move = SkillController(zero_policy()).step(seen((force[0], force[1], force[2])))
    is_seen = axis < 2 or math.isnan(value)
    assert all(map(math.isfinite, move.translation)) is not is_seen


@given(st.tuples(*[st.floats(-0.1, 0.1)] * 3))
def test_without_a_residual_it_is_the_expert_within_its_box(force: Vector3) -> None:
    settings = ProportionalSettings.model_validate(
        {"kind": "proportional", "force_jacobian_um_N": 800.0, "lambda": 0.2}
    )
    expert = ProportionalController(settings, 50e-6).step(seen(force))
    move = SkillController(zero_policy()).step(seen(force))
    assert move.translation == expert.translation
    assert move.rotation == expert.rotation


def test_it_sees_what_its_policy_names() -> None:
    policy = dataclasses.replace(
        constant(step_x=0.0),
        inputs=(Input("depth", 1e-3),),
        outputs=outputs("step_x"),
        layers=(Layer(np.ones((1, 1)), np.zeros(1)),),
    )
    move = SkillController(policy).step(seen((0.0, 0.0, 0.0), depth_m=0.5e-3))
    assert move.translation[0] == pytest.approx(20e-6 * math.tanh(0.5))


PLACES = Policy(
    (Input("force_z", 1.0),),
    (Output("step_x", 1e-5),),
    10.0,
    (Layer(np.array([[0.1, 0.01, 0.001]]), np.zeros(1)),),
    EXPERT,
    history=3,
)
"""Answers three axial forces, the newest first, as the digits of a number."""


def digits(controller: SkillController, step: int, force_N: float) -> float:
    """What the controller sees at `step` with a new axial force."""
    move = controller.step(seen((0.0, 0.0, force_N), step=step))
    return math.atanh(move.translation[0] / 1e-5)


def test_frames_are_kept_newest_first_and_begin_with_zeros() -> None:
    controller = SkillController(PLACES)
    found = [digits(controller, step, force) for step, force in enumerate([1.0, 2.0, 3.0, 4.0])]
    assert found == pytest.approx([0.1, 0.21, 0.321, 0.432], rel=1e-5)


def test_a_new_insertion_has_not_seen_the_one_before() -> None:
    controller = SkillController(PLACES)
    for step in range(4):
        digits(controller, step, 9.0)
    assert digits(controller, 0, 1.0) == pytest.approx(0.1, rel=1e-5)
    assert digits(controller, 1, 2.0) == pytest.approx(0.21, rel=1e-5)


def test_there_is_one_frame_for_each_step() -> None:
    """While a step is held, the newest observation before it is the one that counts."""
    controller = SkillController(PLACES)
    found = [digits(controller, step, force) for step, force in [(0, 9.0), (0, 1.0), (1, 9.0)]]
    assert found == pytest.approx([0.9, 0.1, 0.91], rel=1e-5)
    assert digits(controller, 1, 2.0) == pytest.approx(0.21, rel=1e-5)
    assert digits(controller, 2, 3.0) == pytest.approx(0.321, rel=1e-5)


def test_two_controllers_of_a_policy_keep_frames_of_their_own() -> None:
    one, two = SkillController(PLACES), SkillController(PLACES)
    digits(one, 0, 9.0)
    assert digits(two, 1, 1.0) == pytest.approx(0.1, rel=1e-5)


@given(st.integers(0, 2**32 - 1), st.integers(1, 5), st.lists(st.booleans(), max_size=12))
def test_whatever_came_before_it_answers_from_the_insertions_own_frames(
    seed: int, history: int, begins: list[bool]
) -> None:
    """Compared with the policy on frames that are put together here; 4 inputs each."""
    policy = random_policy(seed, history=history, expert=EXPERT._replace(gain_m_N=0.0))
    controller, generator = SkillController(policy), np.random.default_rng(seed)
    frames: list[float] = []
    step = 0
    for is_new in begins:
        step = 0 if is_new else step + 1
        force = generator.uniform(-0.2, 0.2, 3).tolist()
        observation = seen(tuple(force), generator.uniform(0.0, 3e-3), step)
        frames = policy.read(observation) + ([] if is_new else frames)
        values = (frames + [0.0] * policy.n_values)[: policy.n_values]
        move = controller.step(observation)
        assert move.translation[:2] == tuple(policy.residual(values)[:2].tolist())


@pytest.mark.parametrize(
    ("depth_um", "axial_um"), [(-60.0, 50.0), (-20.0, 20.0), (0.0, 2.0), (29.0, 2.0), (31.0, 50.0)]
)
def test_near_the_first_rim_the_expert_approaches(depth_um: float, axial_um: float) -> None:
    expert = EXPERT._replace(approach=Approach(2e-6, 30e-6))
    controller = SkillController(zero_policy(expert))
    assert controller.step(seen((0.0, 0.0, 0.0), depth_um * 1e-6)).translation == pytest.approx(
        (0.0, 0.0, axial_um * 1e-6), rel=1e-12
    )
    assert controller.step(seen((0.01, 0.0, 0.0), 0.0)).translation[0] == pytest.approx(-1.6e-6)
