"""A tilted shaft across one hole: when two points touch, their forces, and when it stays stuck."""

import numpy as np
import pytest

from simulator.checks import FloatArray
from simulator.contact import ContactLaw, solve
from simulator.geometry import Hole, Part, Shaft
from simulator.stick import StickLaw, advance, relaxed
from simulator.wrench import move_torque

STILL = np.zeros(3)
HOLE, WALL = 1.01e-3, 5e-4


def axis_and_normal(tilt: float) -> tuple[FloatArray, FloatArray]:
    """The shaft's axis, and the direction across it in the plane y = 0, towards +x."""
    return (
        np.array([np.sin(tilt), 0.0, np.cos(tilt)]),
        np.array([np.cos(tilt), 0.0, -np.sin(tilt)]),
    )


def through(tilt: float, wall: float) -> FloatArray:
    """The pose of a shaft whose axis goes through the middle of a wall's hole."""
    axis, _ = axis_and_normal(tilt)
    return np.array([*(np.array([0.0, 0.0, 0.5 * wall]) + 1e-3 * axis), 0.0, tilt])


def wedging_tilt(hole: float, shaft: float, wall: float) -> float:
    """The root of hole cos(t) - wall sin(t) = shaft: both rims touch the shaft."""
    return float(np.arccos(shaft / np.hypot(hole, wall)) - np.arctan2(wall, hole))


@pytest.mark.parametrize("diameter", [1.0e-3, 1.005e-3, 1.0099e-3])
@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_both_rims_touch_from_the_wedging_tilt_on(diameter: float, sign: float) -> None:
    """D cos(t) - l sin(t) = d, for a shaft through the whole wall."""
    part, shaft = Part((Hole(HOLE, WALL),)), Shaft(diameter, 4e-3)
    tilt = wedging_tilt(HOLE, diameter, WALL)
    below = solve(part, shaft, through(sign * tilt * (1 - 1e-9), WALL), STILL)
    above = solve(part, shaft, through(sign * tilt * (1 + 1e-9), WALL), STILL)
    assert not (below.penetration > 0.0).any()
    assert (above.penetration > 0.0).sum() == 2


def test_two_rims_of_a_wedged_shaft_push_as_a_couple() -> None:
    """Each penetration is half the overlap; the arm is D sin(t) + l cos(t)."""
    part, shaft, tilt = Part((Hole(HOLE, WALL),)), Shaft(1e-3, 4e-3), 0.022
    found = solve(part, shaft, through(tilt, WALL), STILL)
    each = 0.5 * (1e-3 - HOLE * np.cos(tilt) + WALL * np.sin(tilt))
    assert each > 4e-7
    arm = HOLE * np.sin(tilt) + WALL * np.cos(tilt)
    couple = [0.0, 0.0, 0.0, 0.0, 4e3 * each * arm, 0.0]
    np.testing.assert_allclose(found.wrench, couple, rtol=1e-9, atol=1e-15)


@pytest.mark.parametrize("tilt", [5e-3, 1e-2, 2e-2])
@pytest.mark.parametrize("engaged", [2e-4, 4e-4])
@pytest.mark.parametrize("overlaps", [(0.0, 0.0), (4e-7, 1e-7), (1e-7, 5e-7)])
def test_rim_and_leading_edge_of_a_tilted_shaft(
    tilt: float, engaged: float, overlaps: tuple[float, float]
) -> None:
    """D = d cos(t) + s sin(t) - overlaps, s the distance from the leading plane to the upper rim.

    The upper rim touches at -x, the leading edge at +x, the shaft slides in along its axis.
    """
    (axis, across), (at_rim, at_edge) = axis_and_normal(tilt), overlaps
    radius = 0.5 * (HOLE + at_edge + at_rim * np.cos(tilt) - engaged * np.sin(tilt)) / np.cos(tilt)
    rim = np.array([-0.5 * HOLE, 0.0, 0.0])
    tip = rim + engaged * axis + (radius - at_rim) * across
    edge = tip + radius * across
    assert edge[0] == pytest.approx(0.5 * HOLE + at_edge, abs=1e-18)
    pose = np.array([*tip, 0.0, tilt])
    found = solve(Part((Hole(HOLE, WALL),)), Shaft(2.0 * radius, 4e-3), pose, axis)
    np.testing.assert_allclose(
        np.sort(found.penetration)[-2:], np.sort(overlaps), rtol=0, atol=1e-17
    )
    rim_force = 4e3 * at_rim * (-across + 0.2 * axis)
    edge_force = 4e3 * at_edge * np.array([1.0, 0.0, 0.2])
    torque = np.cross(rim, rim_force) + np.cross(edge, edge_force)
    expected = [*(rim_force + edge_force), *torque]
    np.testing.assert_allclose(found.wrench, expected, rtol=0, atol=1e-12)


def least_moment(wall: float, friction: float) -> tuple[float, float]:
    """Least moment about the hole's middle [N m] while a wedged shaft is turned back free.

    With it the tilt there. A moment below 0 has to pull the shaft free: it stays stuck without.
    """
    hole, shaft = 1.0001e-3, Shaft(1e-3, 4e-3)
    part, tilt = Part((Hole(hole, wall),)), wedging_tilt(1.0001e-3, 1e-3, wall)
    law = StickLaw(ContactLaw(friction=friction))
    state = relaxed(part, shaft, through(tilt, wall))
    moments = []
    for more in [1.0, *np.linspace(1.0, 0.0, 61)]:
        pose = through(tilt * (1.0 + more), wall)
        found = advance(part, shaft, pose, state, law)
        state = found.state
        moments.append(move_torque(found.wrench, [0.0, 0.0, 0.5 * wall])[4])
        np.testing.assert_allclose(found.wrench[:3], 0.0, rtol=0, atol=1e-12)
    return min(moments), tilt


@pytest.mark.parametrize("friction", [0.1, 0.2, 0.4])
def test_wedging_needs_friction_cones_that_contain_each_other(friction: float) -> None:
    """A shaft wedges for l/d <= mu (Whitney 1982): the line between the points is in both cones.

    With the tilt t at which the points touch: D sin(t) + l cos(t) = mu (D cos(t) - l sin(t)).
    """
    low, high = 0.5 * friction * 1e-3, 1.5 * friction * 1e-3
    assert least_moment(low, friction)[0] < -1e-9
    assert least_moment(high, friction)[0] >= 0.0
    for _ in range(7):
        middle = 0.5 * (low + high)
        wedges = least_moment(middle, friction)[0] < -1e-12
        low, high = (middle, high) if wedges else (low, middle)
    tilt = least_moment(low, friction)[1]
    exact = (friction * 1.0001e-3 * np.cos(tilt) - 1.0001e-3 * np.sin(tilt)) / (
        np.cos(tilt) + friction * np.sin(tilt)
    )
    assert 0.5 * (low + high) == pytest.approx(exact, rel=5e-3)
    assert exact == pytest.approx(friction * 1e-3, rel=2e-2)
