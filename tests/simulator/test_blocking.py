"""An end beside its hole stands on the face, stays there, and slides in once it fits."""

from collections.abc import Iterable

import numpy as np
import pytest

from simulator.blocking import update_entered
from simulator.candidates import Station
from simulator.checks import FloatArray
from simulator.contact import ContactLaw, Contacts, solve
from simulator.geometry import Hole, Part, Shaft
from simulator.profile import Chamfer, Rounding
from simulator.states import touching_stations

PART = Part((Hole(1.01e-3, 5e-4), Hole(1.01e-3, 5e-4, 1.5e-3)))
SHAFT = Shaft(1e-3, 4e-3)
DOWN, STILL = np.array([0.0, 0.0, 1.0]), np.zeros(3)
SMOOTH = ContactLaw(friction=0.0)


def at(x_um: float, z_um: float, ry: float = 0.0) -> FloatArray:
    return np.array([x_um * 1e-6, 0.0, z_um * 1e-6, 0.0, ry])


def walk(
    part: Part, shaft: Shaft, poses: Iterable[FloatArray]
) -> tuple[list[Contacts], list[list[bool]]]:
    """Contacts and states along a path that begins outside."""
    entered = np.zeros(len(part.holes), dtype=np.bool_)
    contacts, states = [], []
    for pose in poses:
        entered = update_entered(part, shaft, pose, entered)
        contacts.append(solve(part, shaft, pose, DOWN, SMOOTH, entered=entered))
        states.append(entered.tolist())
    return contacts, states


def test_an_end_beside_the_hole_lands_and_presses_on_the_face() -> None:
    found, states = walk(PART, SHAFT, [at(8, z) for z in (-2, 0, 2, 5)])
    axial = [contact.wrench[2] for contact in found]
    np.testing.assert_allclose(axial, [0.0, 0.0, 8e-3, 20e-3], atol=1e-15)
    np.testing.assert_allclose([contact.wrench[:2] for contact in found], 0.0, atol=1e-15)
    assert not np.any(states)
    last = found[-1]
    np.testing.assert_allclose(last.point[4], [508e-6, 0.0, 5e-6], atol=1e-15)
    np.testing.assert_array_equal(last.normal[4], [0.0, 0.0, 1.0])
    assert last.energy == pytest.approx(0.5 * 4e3 * 5e-6**2)
    assert touching_stations(last)[0].tolist() == [Station.UPPER == 1, Station.LOWER == 1]


def test_it_stays_until_the_offset_falls_below_the_clearance_and_then_slides_in() -> None:
    path = [at(8, -1), at(8, 4), at(5.1, 4), at(4.9, 4), at(8, 4)]
    found, states = walk(PART, SHAFT, path)
    assert [state[0] for state in states] == [False, False, False, True, True]
    np.testing.assert_allclose([f.wrench[2] for f in found[:4]], [0, 0.016, 0.016, 0], atol=1e-15)
    # Once inside, the same pose pushes against the wall.
    np.testing.assert_allclose(found[4].wrench[:3], [2 * 4e3 * 3e-6, 0.0, 0.0], atol=1e-15)


def test_it_leaves_on_withdrawal_and_lands_again() -> None:
    _, states = walk(PART, SHAFT, [at(0, 10), at(8, 10), at(8, 0), at(8, 10)])
    assert [state[0] for state in states] == [True, True, False, False]


def test_each_wall_has_its_own_face() -> None:
    path = [at(0, 100), at(8, 1900), at(8, 2003), at(0, 2003), at(8, 2003)]
    found, states = walk(PART, SHAFT, path)
    assert states == [[True, False]] * 3 + [[True, True]] * 2
    np.testing.assert_allclose(found[2].wrench[[0, 2]], [0.024, 0.012], atol=1e-15)
    np.testing.assert_allclose(found[4].wrench[[0, 2]], [0.048, 0.0], atol=1e-15)


def test_friction_holds_a_standing_end_along_its_motion() -> None:
    wrench = solve(PART, SHAFT, at(8, 5), [1.0, 0.0, 0.0], entered=np.zeros(2, np.bool_)).wrench
    np.testing.assert_allclose(wrench[:3], [0.2 * 0.02, 0.0, 0.02], atol=1e-15)


def test_an_entered_wall_has_the_elastic_forces() -> None:
    poses = np.random.default_rng(1).uniform(-1, 1, (200, 5)) * [1e-5, 1e-5, 2e-3, 5e-3, 5e-3]
    elastic = solve(PART, SHAFT, poses, DOWN)
    inside = solve(PART, SHAFT, poses, DOWN, entered=np.ones((200, 2), np.bool_))
    np.testing.assert_array_equal(inside.wrench, elastic.wrench)
    assert elastic.wrench.any(axis=1).sum() > 50


def test_a_chamfered_nose_slides_in_where_a_sharp_one_stands() -> None:
    shaft = Shaft(1e-3, 4e-3, Chamfer(2e-5, 2e-5))
    found, states = walk(PART, shaft, [at(10, 5), at(20, 18), at(26, 18)])
    assert [state[0] for state in states] == [True, True, True]
    assert found[1].wrench[0] > 0.0
    assert found[1].wrench[2] == pytest.approx(found[1].wrench[0])
    found, states = walk(PART, shaft, [at(26, 5)])
    assert not states[0][0]
    np.testing.assert_allclose(found[0].wrench[:3], [0.0, 0.0, 0.02], atol=1e-15)


def test_a_chamfered_mouth_catches_more_than_a_sharp_one() -> None:
    part = Part((Hole(1.01e-3, 5e-4, entry=Chamfer(3e-5, 3e-5)),))
    _, states = walk(part, SHAFT, [at(34, 1)])
    assert states == [[True]]
    clear = solve(part, SHAFT, at(34, 0.5), DOWN, entered=np.zeros(1, np.bool_))
    assert not clear.wrench.any()
    _, states = walk(part, SHAFT, [at(36, 1)])
    assert states == [[False]]


def test_a_rounded_end_stands_on_the_lowest_point_of_its_tube() -> None:
    shaft = Shaft(1e-3, 4e-3, Rounding(2e-5))
    found, states = walk(PART, shaft, [at(30, 3)])
    assert not states[0][0]
    np.testing.assert_allclose(found[0].wrench[:3], [0.0, 0.0, 0.012], atol=1e-15)
    np.testing.assert_allclose(found[0].point[4], [0.51e-3, 0.0, 3e-6], atol=1e-15)
    assert walk(PART, shaft, [at(24, 3)])[1] == [[True, False]]


def test_the_lowest_point_of_a_slanted_end_lands_first() -> None:
    """The end leans towards +x, so its edge at +x is the higher one and +x must be pressed more."""
    found, states = walk(PART, SHAFT, [at(8, 2, -4e-3), at(8, 2, 4e-3)])
    np.testing.assert_allclose(found[0].penetration[4], 2e-6 + 0.5e-3 * np.sin(4e-3), rtol=1e-9)
    assert states == [[False, False]] * 2
    assert found[1].wrench[2] < found[0].wrench[2]


def test_a_batch_equals_its_poses_one_by_one() -> None:
    rng = np.random.default_rng(2)
    poses = rng.uniform(-1, 1, (6, 8, 5)) * [1e-5, 1e-5, 2e-5, 5e-3, 5e-3]
    before = rng.random((6, 8, 2)) < 0.5
    entered = update_entered(PART, SHAFT, poses, before)
    batch = solve(PART, SHAFT, poses, DOWN, entered=entered)
    assert entered.shape == (6, 8, 2)
    assert (batch.normal[..., 4, 2] == 1.0).any()
    for i in np.ndindex(6, 8):
        np.testing.assert_array_equal(update_entered(PART, SHAFT, poses[i], before[i]), entered[i])
        single = solve(PART, SHAFT, poses[i], DOWN, entered=entered[i])
        for name in ("penetration", "point", "normal", "force", "wrench", "energy"):
            np.testing.assert_array_equal(getattr(single, name), getattr(batch, name)[i])
