"""Friction with a memory: holds below the cone, slides at it, and never creates energy."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from simulator.checks import FloatArray
from simulator.contact import ContactLaw, solve
from simulator.geometry import Hole, Part, Shaft
from simulator.stick import StickContacts, StickLaw, advance, relaxed
from simulator.wrench import move_torque

PART = Part((Hole(1.01e-3, 5e-4), Hole(1.01e-3, 5e-4, 1.5e-3)))
SHAFT = Shaft(1e-3, 4e-3)
STILL = np.zeros(3)
ALONG_Z = np.array([0.0, 0.0, 1.0, 0.0, 0.0])
PRESSED = np.array([8e-6, 0.0, 1.2e-3, 0.0, 0.0])
"""3 um against the +x side of the upper hole: two contacts of 12 mN, cone 2.4 mN each."""


def along_z(*depths: float) -> list[StickContacts]:
    """The contacts after each move to these depths beyond `PRESSED` [m]."""
    state, steps = relaxed(PART, SHAFT, PRESSED), []
    for depth in depths:
        steps.append(advance(PART, SHAFT, PRESSED + depth * ALONG_Z, state))
        state = steps[-1].state
    return steps


def test_a_load_below_the_cone_is_held_and_springs_back() -> None:
    """0.5 um on two springs of 3.3 mN/um is 3.3 mN, under the cone of 4.8 mN."""
    pushed, back = along_z(0.5e-6, 0.0)
    np.testing.assert_allclose(pushed.wrench[:3], [0.024, 0.0, 3.3e-3], rtol=1e-9, atol=1e-15)
    assert (pushed.slid == 0.0).all()
    np.testing.assert_allclose(back.wrench[:3], [0.024, 0.0, 0.0], rtol=0, atol=1e-12)


def test_beyond_the_cone_it_slides_at_the_cone_and_the_memory_stays() -> None:
    """At 1 um the springs are cut to 2.4/3.3 um; on the way back they push the other way."""
    slid, back, far_back = along_z(1e-6, 0.0, -5e-6)
    assert slid.wrench[2] == pytest.approx(4.8e-3, rel=1e-9)
    assert slid.slid.max() == pytest.approx(1e-6 - 2.4e-3 / 3.3e3, rel=1e-6)
    assert back.wrench[2] == pytest.approx(4.8e-3 - 2 * 3.3e-3, rel=1e-9)
    assert far_back.wrench[2] == pytest.approx(-4.8e-3, rel=1e-9)


def test_a_contact_that_opens_forgets() -> None:
    state = along_z(5e-6)[-1].state
    opened = advance(PART, SHAFT, PRESSED * [0, 1, 1, 1, 1], state)
    assert (opened.state.stretch == 0.0).all()
    assert (opened.slid == 0.0).all()
    assert (opened.wrench == 0.0).all()


def test_a_long_slide_is_the_sliding_friction_of_the_contact_model() -> None:
    rng = np.random.default_rng(1)
    poses = rng.uniform(-1, 1, (500, 5)) * [2e-5, 2e-5, 1e-3, 5e-3, 5e-3] + [0, 0, 1.5e-3, 0, 0]
    way = rng.normal(size=(500, 3)) * 1e-4
    start = poses - np.pad(way, ((0, 0), (0, 2)))
    expected = solve(PART, SHAFT, poses, way)
    found = advance(PART, SHAFT, poses, relaxed(PART, SHAFT, start))
    touching = expected.penetration > 1e-8
    assert touching.sum() > 500
    np.testing.assert_allclose(
        found.friction[:, : touching.shape[-1]][touching],
        (expected.force - solve(PART, SHAFT, poses, STILL).force)[touching],
        rtol=1e-9,
        atol=1e-12,
    )
    np.testing.assert_allclose(found.wrench, expected.wrench, rtol=0, atol=1e-5)


def test_a_ring_of_contact_slides_with_all_its_points() -> None:
    """Coaxial interference of 3 um on each of four circles: 4 k delta of normal load each."""
    shaft, pose = Shaft(1.016e-3, 4e-3), PRESSED * [0, 1, 1, 1, 1]
    start = relaxed(PART, shaft, pose - 1e-5 * ALONG_Z)
    found = advance(PART, shaft, pose, start)
    expected = solve(PART, shaft, pose, ALONG_Z[:3])
    assert found.normal_force.sum() == pytest.approx(2 * 4 * 4e3 * 3e-6, rel=1e-9)
    np.testing.assert_allclose(found.wrench, expected.wrench, rtol=1e-9, atol=1e-12)


small = st.floats(-1.0, 1.0)
moves = st.lists(st.tuples(*[small] * 5), min_size=2, max_size=6)


@given(moves, st.sampled_from([0.05, 0.2, 1.0]))
def test_no_step_creates_energy(steps: list[tuple[float, ...]], mu: float) -> None:
    """Work of the friction force on the contact's motion >= what the springs store more.

    The contact's motion follows from the shaft's turn and shift alone, to first order.
    """
    law = StickLaw(ContactLaw(friction=mu))
    pose = PRESSED.copy()
    state = relaxed(PART, SHAFT, pose)
    for step in steps:
        pose = pose + np.array(step) * [3e-6, 3e-6, 3e-6, 1e-4, 1e-4]
        found = advance(PART, SHAFT, pose, state, law)
        stored = 0.5 * 3.3e3 * ((found.state.stretch**2).sum() - (state.stretch**2).sum())
        friction = np.concatenate([found.friction.sum(axis=-2), torque_of(found, pose)])
        work = friction @ (np.array(pose) - state.poses)
        assert work - stored >= -1e-5 * (abs(work) + abs(stored)) - 1e-18
        cone = mu * found.normal_force
        assert (np.linalg.norm(found.friction, axis=-1) <= cone * (1 + 1e-12)).all()
        state = found.state


def torque_of(found: StickContacts, pose: FloatArray) -> FloatArray:
    """Torque (x, y) of the friction alone about the shaft's leading end."""
    normal = solve(PART, SHAFT, pose, STILL, ContactLaw(friction=0.0)).wrench
    return move_torque(found.wrench - normal, pose[:3])[3:5]


@pytest.mark.slow
def test_a_closed_cycle_dissipates() -> None:
    """Work put in around a closed way, by the trapezoidal rule; none without friction."""
    angle = np.linspace(0.0, 2.0 * np.pi, 801)
    way = np.zeros((angle.size, 5))
    way[:, 0] = 9e-6 * np.cos(angle)
    way[:, 1] = 9e-6 * np.sin(2.0 * angle)
    way[:, 2] = 1.3e-3 + 2e-5 * np.sin(3.0 * angle)

    def work(mu: float) -> tuple[float, float]:
        law, state, force = StickLaw(ContactLaw(friction=mu)), relaxed(PART, SHAFT, way[0]), []
        for _ in range(2):  # the second time round it starts with what the first has left
            force = []
            for pose in way:
                found = advance(PART, SHAFT, pose, state, law)
                state = found.state
                force.append(found.wrench[:3])
        pull = np.array(force)
        power = (0.5 * (pull[1:] + pull[:-1]) * np.diff(way[:, :3], axis=0)).sum(axis=-1)
        return float(power.sum()), float(np.abs(power).sum())

    lost, exchanged = work(0.0)
    assert abs(lost) < 1e-3 * exchanged
    dissipated, exchanged = work(0.2)
    assert dissipated > 0.01 * exchanged


def test_trials_from_one_state_and_batches_give_the_bits_of_single_poses() -> None:
    rng = np.random.default_rng(2)
    poses = PRESSED + rng.normal(size=(3, 20, 5)) * [3e-6, 3e-6, 1e-5, 1e-3, 1e-3]
    state = advance(PART, SHAFT, poses[0], relaxed(PART, SHAFT, poses[1])).state
    together = advance(PART, SHAFT, poses, state)
    single = relaxed(PART, SHAFT, poses[1, 7])
    single = advance(PART, SHAFT, poses[0, 7], single).state
    alone = advance(PART, SHAFT, poses[2, 7], single)
    assert (together.wrench[2, 7] == alone.wrench).all()
    assert (together.state.stretch[2, 7] == alone.state.stretch).all()


def test_a_state_of_another_batch_is_refused() -> None:
    with pytest.raises(ValueError, match=r"poses has shape \(5,\)"):
        advance(PART, SHAFT, PRESSED, relaxed(PART, SHAFT, np.tile(PRESSED, (3, 1))))
    with pytest.raises(ValueError, match="tangential_stiffness_N_m"):
        StickLaw(tangential_stiffness_N_m=0.0)
