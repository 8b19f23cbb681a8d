"""Functions of numbers against their definitions."""

import math

import numpy as np
import pytest

from simulator.engine.direction import NEAR, direction, near_direction
from simulator.engine.states import bit_count
from simulator.engine.trigonometry import sin_cos


def test_sine_and_cosine() -> None:
    rng = np.random.default_rng(1)
    angles = np.concatenate([rng.uniform(-1.5707963, 1.5707963, 2000), rng.normal(size=500) * 1e-8])
    for angle in (*angles, 0.0, math.pi / 4, -math.pi / 2, math.pi / 2):
        sin, cos = sin_cos(angle)
        assert sin == pytest.approx(math.sin(angle), rel=2.3e-16, abs=0.0)
        assert cos == pytest.approx(math.cos(angle), rel=2.3e-16, abs=0.0)


@pytest.mark.parametrize("ratio", [0.0, 1e-9, 1e-3, 0.5 * NEAR, NEAR])
def test_the_near_direction_is_the_direction(ratio: float) -> None:
    for angle in np.random.default_rng(2).uniform(-math.pi, math.pi, 300):
        m1, m2 = 1e-5 * math.cos(angle), 1e-5 * math.sin(angle)
        e1, e2, found = near_direction(m1, m2, ratio * 1e-5)
        assert found == pytest.approx(ratio)
        assert (e1, e2) == pytest.approx(direction(m1, m2, ratio * 1e-5), abs=1e-14)


def test_a_centred_circle_is_not_near() -> None:
    assert near_direction(0.0, 0.0, 0.0)[2] == math.inf
    assert direction(0.0, 0.0, 1e-9) == (1.0, 0.0)


def test_bits_are_counted() -> None:
    for bits in (0, 1, 6, (1 << 64) - 1, 1 << 63, 0x123456789ABCDEF0):
        assert bit_count(np.uint64(bits)) == bits.bit_count()
