"""What a policy computes, and what it refuses to be made of."""

import dataclasses
import math

import numpy as np
import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st

from controllers.messages import Observation
from drivers.contract.messages import Pose
from learning.policy.expert import Expert
from learning.policy.inputs import READINGS, Input, Output
from learning.policy.policy import Layer, Policy
from tests.learning.policy.policies import EXPERT, inputs, random_policy, zero_policy

SEEN = Observation(
    0,
    3,
    (0.01, -0.02, 0.3, 1e-3, -2e-3, 3e-3),
    (0.0,) * 6,
    Pose((1e-6, -2e-6, 1.5e-3), (1e-3, 2e-3, 0.0)),
    (4e-6, -5e-6, 1.8e-3),
    Pose((1e-6, -2e-6, 1.5e-3), (1e-3, 2e-3, 0.0)),
)


def test_a_worked_example() -> None:
    """One input of 0.14 N is 2 by its scale, cut to 1.5; ReLU lets one of two units through."""
    policy = Policy(
        (Input("force_x", 0.07),),
        (Output("step_x", 2e-5), Output("turn_y", 1e-3)),
        1.5,
        (
            Layer(np.array([[2.0], [-1.0]]), np.array([-1.0, 0.25])),
            Layer(np.array([[0.25, 9.0], [-0.5, 9.0]]), np.array([0.0, 1.5])),
        ),
        EXPERT,
    )
    assert policy.residual([0.14]) == pytest.approx([2e-5 * math.tanh(0.5), 1e-3 * math.tanh(0.5)])
    assert policy.residual([-0.14]) == pytest.approx(
        [2e-5 * math.tanh(9.0 * 1.75), 1e-3 * math.tanh(1.5 + 9.0 * 1.75)]
    )


def test_every_input_reads_its_own_number() -> None:
    expected = {
        "force_x": 0.01,
        "force_y": -0.02,
        "force_z": 0.3,
        "torque_x": 1e-3,
        "torque_y": -2e-3,
        "torque_z": 3e-3,
        "depth": 1.5e-3,
        "turn_x": 1e-3,
        "turn_y": 2e-3,
        "displacement_x": 4e-6,
        "displacement_y": -5e-6,
        "displacement_z": 1.8e-3,
    }
    assert {name: reading.read(SEEN) for name, reading in READINGS.items()} == expected
    names = tuple(reversed(expected))
    assert random_policy(seen=names).read(SEEN) == [expected[name] for name in names]


def test_all_inputs_of_the_newest_observation_come_first() -> None:
    """Two inputs of scales 2 and 4, seen three times: each weight meets its own value."""
    policy = Policy(
        (Input("force_x", 2.0), Input("depth", 4.0)),
        (Output("step_x", 1.0),),
        10.0,
        (Layer(np.array([[1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6]]), np.zeros(1)),),
        EXPERT,
        history=3,
    )
    assert policy.n_values == 6
    values = [2.0, 8.0, 6.0, 16.0, 10.0, 24.0]
    expected = math.tanh(0.123456)
    assert policy.residual(values) == pytest.approx([expected], rel=1e-6)
    assert policy.residuals([values])[0] == pytest.approx([expected], rel=1e-6)


@given(st.integers(0, 2**32 - 1), st.integers(1, 3), st.integers(1, 40), st.floats(0.1, 10.0))
def test_one_by_one_as_in_a_batch_and_within_the_scales(
    seed: int, depth: int, width: int, bound: float
) -> None:
    policy = random_policy(seed, (width,) * depth, bound=bound)
    values = np.random.default_rng(seed).uniform(-1.0, 1.0, (20, 4)) * [0.3, 0.3, 0.3, 0.01]
    batch = policy.residuals(values)
    scales = np.array([scale for _, scale in policy.outputs])
    assert (abs(batch) <= scales).all()
    for row, expected in zip(values, batch, strict=True):
        assert policy.residual(row) / scales == pytest.approx(expected / scales, abs=2e-6)


def test_as_torch_computes_it() -> None:
    policy = random_policy(5, (64, 64))
    values = np.random.default_rng(5).uniform(-0.2, 0.2, (100, 4))
    signal = torch.tensor(values / [0.07, 0.07, 0.07, 2.3e-3], dtype=torch.float32).clamp(-2.0, 2.0)
    for number, (weight, bias) in enumerate(policy.layers):
        signal = torch.nn.functional.linear(signal, torch.tensor(weight), torch.tensor(bias))
        signal = signal.relu() if number < 2 else signal.tanh()
    assert policy.residuals(values) == pytest.approx(signal.numpy() * 2e-5, abs=1e-10)


def test_what_is_not_a_number_is_not_hidden() -> None:
    assert np.isnan(random_policy().residual([math.nan, 0.0, 0.0, 0.0])).all()
    assert np.isnan(zero_policy().residual([0.0, 0.0, 0.0, math.nan])).all()


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ([0.0] * 3, r"inputs have shape \(3,\); it must be \(4,\)"),
        ([[0.0] * 4], r"inputs have shape \(1, 4\); it must be \(4,\)"),
    ],
)
def test_inputs_of_another_shape(values: list[float], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        random_policy().residual(values)


def test_inputs_of_fewer_observations_than_the_history() -> None:
    with pytest.raises(ValueError, match=r"inputs have shape \(4,\); it must be \(12,\)"):
        random_policy(history=3).residual([0.0] * 4)
    with pytest.raises(ValueError, match=r"inputs have shape \(2, 4\); it must be \(n, 12\)"):
        random_policy(history=3).residuals(np.zeros((2, 4)))


@pytest.mark.parametrize("shape", [(4,), (2, 3), (1, 1, 4)])
def test_batches_of_another_shape(shape: tuple[int, ...]) -> None:
    with pytest.raises(ValueError, match=r"it must be \(n, 4\)"):
        random_policy().residuals(np.zeros(shape))


def test_it_keeps_copies_that_nobody_can_write() -> None:
    weight = np.ones((3, 4), np.float32)
    policy = dataclasses.replace(zero_policy(), layers=(Layer(weight, np.zeros(3)),))
    weight[:] = 7.0
    assert (policy.layers[0].weight == 1.0).all()
    with pytest.raises(ValueError, match="read-only"):
        policy.layers[0].bias[0] = 1.0
    with pytest.raises(dataclasses.FrozenInstanceError):
        policy.bound = 3.0  # type: ignore[misc]  # must fail: it is frozen


W3x4, B3 = np.zeros((3, 4)), np.zeros(3)
INFINITE = np.full((3, 4), 1e39)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"inputs": ()}, "there is no input; there must be at least one"),
        ({"outputs": ()}, "there is no output; there must be at least one"),
        (
            {"inputs": (Input("force_w", 1.0),)},
            "input 'force_w' is not known; valid are force_x, force_y, force_z, torque_x",
        ),
        (
            {"outputs": (Output("force_x", 1.0),)},
            "output 'force_x' is not known; valid are step_x, step_y, step_z, turn_x, turn_y",
        ),
        (
            {"inputs": inputs("depth", "force_x", "depth")},
            "input 'depth' is there 2 times; it must be once",
        ),
        ({"inputs": (Input("depth", 0.0),)}, "scale of input 'depth' is 0.0; it must be at least"),
        ({"inputs": (Input("depth", math.nan),)}, "scale of input 'depth' is nan"),
        ({"outputs": (Output("step_x", -1.0),)}, r"scale of output 'step_x' is -1\.0"),
        ({"outputs": (Output("step_x", math.inf),)}, "scale of output 'step_x' is inf"),
        ({"bound": 0.0}, "bound is 0.0; it must be finite and greater than 0"),
        ({"bound": math.nan}, "bound is nan"),
        ({"layers": ()}, "there is no layer"),
        ({"layers": ((np.zeros((3, 5)), B3),)}, r"shape \(3, 5\); it must be \(outputs, 4\)"),
        ({"layers": ((W3x4, np.zeros(4)),)}, r"bias of layer 0 has shape \(4,\); it must be \(3,"),
        ({"layers": ((W3x4, B3), (W3x4, B3))}, r"weight of layer 1 has shape \(3, 4\)"),
        (
            {"layers": ((np.zeros((2, 4)), np.zeros(2)),)},
            "last layer has 2 outputs; it must have 3",
        ),
        ({"layers": ((np.zeros((0, 4)), np.zeros(0)),)}, r"weight of layer 0 has shape \(0, 4\)"),
        ({"layers": ((W3x4 * math.nan, B3),)}, "weight of layer 0 has 12 values that are not fin"),
        (
            {"layers": ((INFINITE, B3),)},
            "weight of layer 0 has 12 values that are not finite in si",
        ),
        ({"layers": ((W3x4, np.array([0.0, math.inf, 0.0])),)}, "bias of layer 0 has 1 values"),
        ({"expert": EXPERT._replace(gain_m_N=math.nan)}, "gain_m_N of the expert is nan"),
        ({"expert": EXPERT._replace(gain_m_N=-1.0)}, "gain_m_N of the expert is -1.0"),
        ({"expert": EXPERT._replace(axial_step_m=-1e-9)}, "axial_step_m of the expert is -1e-09"),
        ({"expert": EXPERT._replace(axial_step_m=6.1e-5)}, "at most 6e-05, the step box along z"),
        ({"history": 0}, "history is 0; it must be a whole number from 1 to 64"),
        ({"history": 65}, "history is 65; it must be a whole number from 1 to 64"),
        ({"history": 2.0}, r"history is 2\.0; it must be a whole number from 1 to 64"),
        ({"history": 2}, r"weight of layer 0 has shape \(3, 4\); it must be \(outputs, 8\)"),
        ({"expert": Expert(1e-4, 5e-5, (2e-5, 0.0, 6e-5))}, r"step_box_m \(y\) of the expert is 0"),
    ],
)
def test_what_no_policy_can_be_made_of(changes: dict[str, object], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        dataclasses.replace(zero_policy(), **changes)


@pytest.mark.parametrize(
    ("seen", "place"),
    [
        ("force_x", (0.0, 0.0, 0.04)),
        ("torque_x", None),
        ("torque_x", (0.0, 0.0, math.inf)),
        ("torque_x", (0.0, 0.0)),
    ],
)
def test_whoever_reads_torque_says_about_which_place(
    seen: str, place: tuple[float, ...] | None
) -> None:
    policy = random_policy(seen=(seen,))
    with pytest.raises(ValueError, match=r"torque_origin_m is .*; it must be"):
        dataclasses.replace(policy, torque_origin_m=place)
