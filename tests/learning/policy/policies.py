"""Policies made for tests."""

from itertools import pairwise

import numpy as np

from learning.policy.expert import Expert
from learning.policy.inputs import OUTPUT_UNITS, READINGS, Input, Output
from learning.policy.policy import Layer, Policy

SCALES = {"N": 0.07, "N m": 3e-3, "m": 2.3e-3, "rad": 8e-4}
EXPERT = Expert(0.2 * 8e-4, 5e-5, (2e-5, 2e-5, 6e-5))


def inputs(*names: str) -> tuple[Input, ...]:
    return tuple(Input(name, SCALES[READINGS[name].unit]) for name in names)


def outputs(*names: str) -> tuple[Output, ...]:
    return tuple(
        Output(name, 2e-5 if OUTPUT_UNITS[name] == "m" else SCALES["rad"]) for name in names
    )


def random_policy(
    seed: int = 0,
    hidden: tuple[int, ...] = (16, 16),
    seen: tuple[str, ...] = ("force_x", "force_y", "force_z", "depth"),
    answered: tuple[str, ...] = ("step_x", "step_y", "step_z"),
    bound: float = 2.0,
    expert: Expert = EXPERT,
    history: int = 1,
) -> Policy:
    """Of random weights, large enough that its answers cover much of their range."""
    generator = np.random.default_rng(seed)
    widths = (len(seen) * history, *hidden, len(answered))
    layers = tuple(
        Layer(
            generator.normal(0.0, 1.5 / np.sqrt(n), (m, n)).astype(np.float32),
            generator.normal(0.0, 0.3, m).astype(np.float32),
        )
        for n, m in pairwise(widths)
    )
    place = (0.0, 0.0, 0.04) if any(name.startswith("torque") for name in seen) else None
    return Policy(inputs(*seen), outputs(*answered), bound, layers, expert, history, place)


def zero_policy(expert: Expert = EXPERT) -> Policy:
    """Whose residual is zero: what it leads is the expert alone."""
    layers = (Layer(np.zeros((3, 4), np.float32), np.zeros(3, np.float32)),)
    seen = inputs("force_x", "force_y", "force_z", "depth")
    return Policy(seen, outputs("step_x", "step_y", "step_z"), 2.0, layers, expert)


def same(a: Policy, b: Policy) -> bool:
    """Whether all that two policies are made of is the same, to the bit."""
    arrays = zip(a.layers, b.layers, strict=True)
    return (a.inputs, a.outputs, a.bound, a.expert, a.history, a.torque_origin_m) == (
        b.inputs,
        b.outputs,
        b.bound,
        b.expert,
        b.history,
        b.torque_origin_m,
    ) and all(np.array_equal(x, y) for one, two in arrays for x, y in zip(one, two, strict=True))
