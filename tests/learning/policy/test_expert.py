"""The expert's step over force and depth, and the approaches that it cannot be given."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from learning.environments import PAPER
from learning.policy.expert import Approach, Expert
from learning.training.evaluation import insert_all
from tests.learning.policy.policies import random_policy, zero_policy

UM = 1e-6
PLAIN = Expert(gain_m_N=160e-6, axial_step_m=50e-6, step_box_m=(20e-6, 20e-6, 60e-6))
SLOW = PLAIN._replace(approach=Approach(step_m=2e-6, depth_m=30e-6))


def both(expert: Expert, force_xy_N: tuple[float, float], depth_m: float) -> list[float]:
    """The step by numbers, which must be that by arrays, to the bit."""
    step_m = expert.step(force_xy_N, depth_m)
    array = expert.step(np.array([force_xy_N, (9.0, 9.0)]), np.array([depth_m, 1.0]))
    assert array.shape == (2, 3)
    assert np.array_equal(array[0], step_m, equal_nan=True)
    return list(step_m)


@pytest.mark.parametrize("depth_m", [-1e-3, 0.0, 1e-3, math.nan])
def test_without_an_approach_the_axial_step_is_the_same_at_every_depth(depth_m: float) -> None:
    assert both(PLAIN, (0.010, -0.020), depth_m) == pytest.approx([-1.6e-6, 3.2e-6, 50e-6])


@pytest.mark.parametrize(
    ("depth_um", "axial_um"),
    [
        (-1000.0, 50.0),
        (-50.1, 50.0),
        (-50.0, 50.0),
        (-49.9, 49.9),
        (-20.0, 20.0),
        (-2.1, 2.1),
        (-2.0, 2.0),
        (-1.9, 2.0),
        (0.0, 2.0),
        (29.9, 2.0),
        (30.0, 50.0),
        (30.1, 50.0),
        (3000.0, 50.0),
    ],
)
def test_the_approach_goes_to_the_rim_and_on_in_short_steps(
    depth_um: float, axial_um: float
) -> None:
    step_m = both(SLOW, (0.010, -0.020), depth_um / 1e6)
    assert step_m == pytest.approx([-1.6e-6, 3.2e-6, axial_um * UM], rel=1e-12)


def test_an_insertion_meets_the_rim_and_leaves_the_short_steps_where_it_should() -> None:
    depth_m, depths_um = -120e-6, []
    while depth_m < 100e-6:
        depth_m += SLOW.step((0.0, 0.0), depth_m)[2]
        depths_um.append(depth_m / UM)
    short = [2.0 * k for k in range(1, 16)]
    assert depths_um == pytest.approx([-70.0, -20.0, 0.0, *short, 80.0, 130.0], abs=1e-6)


def test_a_depth_that_is_no_number_is_not_hidden() -> None:
    x, y, z = both(SLOW, (0.010, math.nan), math.nan)
    assert x == pytest.approx(-1.6e-6)
    assert math.isnan(y)
    assert math.isnan(z)


@given(
    st.floats(1e-9, 50e-6),
    st.floats(1e-9, 1e-3),
    st.tuples(*[st.floats(-1.0, 1.0)] * 2),
    st.floats(-1e-2, 1e-2),
)
def test_arrays_are_answered_as_numbers_are_and_never_backwards(
    step_m: float, until_m: float, force_xy_N: tuple[float, float], depth_m: float
) -> None:
    expert = PLAIN._replace(approach=Approach(step_m, until_m))
    axial_m = both(expert, force_xy_N, depth_m)[2]
    assert step_m <= axial_m <= 50e-6
    if depth_m < 0.0:
        assert depth_m + axial_m <= max(0.0, depth_m + step_m)


def test_one_observation_as_an_array() -> None:
    step_m = SLOW.step(np.array([0.010, -0.020]), np.array(1e-6))
    assert step_m == pytest.approx([-1.6e-6, 3.2e-6, 2e-6])


def test_whole_insertions_are_led_by_it() -> None:
    """A straight shaft on the axis touches nothing: its steps are those of the depth alone."""
    expert = SLOW._replace(approach=Approach(step_m=2e-6, depth_m=31e-6))
    start_m, steps = PAPER.start_depth_m, 0
    depth_m = start_m
    while depth_m < PAPER.stroke_m:
        depth_m += expert.step((0.0, 0.0), depth_m)[2]
        steps += 1
    poses = np.array([[0.0, 0.0, start_m, 0.0, 0.0]])
    assert insert_all(zero_policy(expert), PAPER, poses).steps == [steps]
    assert insert_all(zero_policy(PLAIN), PAPER, poses).steps == [47]
    with pytest.raises(ValueError, match=r"inputs have shape \(1, 4\); it must be \(n, 12\)"):
        insert_all(random_policy(history=3), PAPER, poses)


@pytest.mark.parametrize(
    ("approach", "axial_step_m", "message"),
    [
        (Approach(0.0, 1e-5), 50e-6, r"step_m of the expert's approach is 0\.0; it must be great"),
        (Approach(-1e-6, 1e-5), 50e-6, "step_m of the expert's approach is -1e-06"),
        (Approach(math.nan, 1e-5), 50e-6, "step_m of the expert's approach is nan"),
        (Approach(math.inf, 1e-5), 50e-6, "is inf; it must be greater than 0 and at most 5e-05, t"),
        (Approach(51e-6, 1e-5), 50e-6, "is 5.1e-05; it must be greater than 0 and at most 5e-05"),
        (Approach(1e-6, 1e-5), 0.0, r"is 1e-06; it must be greater than 0 and at most 0\.0, the e"),
        (Approach(1e-6, 0.0), 50e-6, r"depth_m of the expert's approach is 0\.0; it must be fini"),
        (Approach(1e-6, -1e-5), 50e-6, "depth_m of the expert's approach is -1e-05"),
        (Approach(1e-6, math.nan), 50e-6, "depth_m of the expert's approach is nan"),
        (Approach(1e-6, math.inf), 50e-6, "is inf; it must be finite and greater than 0"),
    ],
)
def test_what_is_no_approach(approach: Approach, axial_step_m: float, message: str) -> None:
    expert = PLAIN._replace(axial_step_m=axial_step_m, approach=approach)
    with pytest.raises(ValueError, match=message):
        replace(zero_policy(), expert=expert)


def test_the_shortest_step_may_be_the_longest() -> None:
    expert = PLAIN._replace(approach=Approach(50e-6, 1e-5))
    assert replace(zero_policy(), expert=expert).expert.step((0.0, 0.0), 0.0) == (0.0, 0.0, 50e-6)
