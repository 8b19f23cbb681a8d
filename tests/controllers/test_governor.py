"""The braking law and the cap that follows from it. Limits are restated here as literals."""

import math

import pytest

from controllers.governor import Travel, braking_speed, speed_cap
from tests.controllers.builders import LIMITS

ZERO = (0.0, 0.0, 0.0)
ACROSS = Travel(1e-5, 0.0, 1e-5, 0.0)


@pytest.mark.parametrize("distance_m", [0.0, -1e-12, -1e-6, -1.0, -math.inf])
def test_without_a_way_left_there_is_no_speed(distance_m: float) -> None:
    assert braking_speed(distance_m, 2e-3, 1.0) == 0.0


@pytest.mark.parametrize("distance_m", [1e-9, 1e-6, 17.5e-6, 1e-3])
@pytest.mark.parametrize("reaction_s", [0.5e-3, 2e-3])
@pytest.mark.parametrize("deceleration_m_s2", [0.3, 1.0, 7.0])
def test_reaction_way_and_braking_way_fill_the_distance(
    distance_m: float, reaction_s: float, deceleration_m_s2: float
) -> None:
    speed = braking_speed(distance_m, reaction_s, deceleration_m_s2)
    way = speed * reaction_s + speed * speed / (2.0 * deceleration_m_s2)
    assert speed > 0.0
    assert way == pytest.approx(distance_m, rel=1e-9)


@pytest.mark.parametrize("sign", [-1.0, 1.0])
def test_travel_has_no_sign(sign: float) -> None:
    """3 and 4 um across, 2 mrad on a lever of 4 mm, 12 um along."""
    travel = Travel.of((3e-6, sign * 4e-6, sign * 12e-6), (0.0, sign * 2e-3, 0.0), 4e-3)
    assert travel.radial_m == pytest.approx(13e-6)
    assert travel.axial_m == pytest.approx(12e-6)
    assert travel.linear_m == pytest.approx(13e-6)
    assert travel.angle_rad == pytest.approx(2e-3)
    assert travel.length_m == pytest.approx(math.hypot(13e-6, 12e-6))


def test_no_travel_has_the_speed_limit() -> None:
    assert speed_cap(LIMITS, (9.0, 9.0, 9.0), ZERO, Travel(0.0, 0.0, 0.0, 0.0)) == 0.005


def test_the_cap_never_exceeds_5_mm_s_nor_falls_below_0_1_mm_s() -> None:
    soft = LIMITS.model_copy(update={"radial_stiffness_N_m": 1.0})
    assert speed_cap(soft, ZERO, ZERO, ACROSS) == 0.005
    for force in ((0.07, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, -0.1, 0.0), (0.0, 0.0, 2.0)):
        assert speed_cap(LIMITS, force, ZERO, ACROSS) == 1e-4


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_a_load_counts_the_same_in_both_directions(axis: int) -> None:
    force = [0.0, 0.0, 0.0]
    force[axis] = 0.99 * (0.070, 0.100, 1.000)[axis]
    free = speed_cap(LIMITS, ZERO, ZERO, ACROSS)
    pushed = speed_cap(LIMITS, (force[0], force[1], force[2]), ZERO, ACROSS)
    pulled = speed_cap(LIMITS, (-force[0], -force[1], -force[2]), ZERO, ACROSS)
    assert pushed == pulled < free


def test_the_cap_falls_steadily_as_the_load_grows() -> None:
    caps = [speed_cap(LIMITS, (mN * 1e-3, 0.0, 0.0), ZERO, ACROSS) for mN in range(71)]
    assert caps == sorted(caps, reverse=True)
    assert caps[0] == pytest.approx(1.5707e-3, abs=1e-7)
    assert caps[35] == pytest.approx(0.8940e-3, abs=1e-7)
    assert caps[70] == 1e-4
