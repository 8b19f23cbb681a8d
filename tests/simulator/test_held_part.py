"""Equilibrium of the held part: against an energy minimiser, balance, anisotropy, slip."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import minimize
from scipy.spatial.transform import Rotation

from simulator.checks import FloatArray
from simulator.contact import ContactLaw, solve
from simulator.equilibrium import Equilibrium, settle, sliding_contact, sticking_contact
from simulator.geometry import Hole, Part, Shaft, shaft_axis
from simulator.holder import Holder
from simulator.stick import StickLaw, advance, relaxed
from simulator.wrench import move_torque

PART = Part((Hole(1.01e-3, 5e-4), Hole(1.01e-3, 5e-4, 1.5e-3)))
SHAFT = Shaft(1e-3, 4e-3)
DOWN, STILL = np.array([0.0, 0.0, 1.0]), np.zeros(3)
NOMINAL, SMOOTH = ContactLaw(), ContactLaw(friction=0.0)
PIVOT = np.array([1e-3, -2e-3, -4e-3])
SOFT = np.array([5e-4, 2e-5, 1e-5, 20.0, 50.0])
HOLDER = Holder(SOFT, pivot_m=PIVOT)
ALONG_Z = np.array([0.0, 0.0, 1.0, 0.0, 0.0])
DEPTHS = [0.25e-3, 1.2e-3, 2.3e-3, 3.2e-3]
"""No circle is cut at these depths, so that the force has a potential."""


def random_poses(n: int, seed: int, tilt: float = 5e-3) -> FloatArray:
    rng = np.random.default_rng(seed)
    poses = rng.uniform(-1, 1, (n, 5)) * [2.5e-5, 2.5e-5, 0.0, tilt, tilt]
    poses[:, 2] = rng.choice(DEPTHS, n)
    return poses


def slid(holder: Holder, poses: FloatArray, law: ContactLaw = NOMINAL) -> Equilibrium:
    return settle(holder, np.zeros(5), poses, sliding_contact(PART, SHAFT, DOWN, law))


def seen(pose: FloatArray, displacement: FloatArray) -> FloatArray:
    """The pose in the part's frame, by scipy's rotations."""
    turn = Rotation.from_euler("xy", displacement[3:]).inv()
    x, y, z = turn.apply(shaft_axis(pose))
    tip = turn.apply(pose[:3] - PIVOT - displacement[:3]) + PIVOT
    return np.array([*tip, np.arctan2(-y, np.hypot(x, z)), np.arctan2(x, z)])


@pytest.mark.slow
@pytest.mark.parametrize("compliance", [SOFT, SOFT * [1, 1, 1, 0, 0]], ids=["five", "shifts"])
def test_it_is_the_minimum_of_the_potential_energy(compliance: FloatArray) -> None:
    poses = random_poses(12, 1)
    found = slid(Holder(compliance, pivot_m=PIVOT), poses, SMOOTH)
    assert found.converged.all()
    free = compliance > 0.0
    for pose, displacement in zip(poses, found.displacement, strict=True):

        def energy(scaled: FloatArray, pose: FloatArray = pose) -> float:
            w = np.zeros(5)
            w[free] = scaled * np.sqrt(compliance[free]) * 1e-4
            overlap = solve(PART, SHAFT, seen(pose, w), STILL, SMOOTH).penetration
            return 0.5 * 4e3 * float((overlap**2).sum()) * 1e8 + 0.5 * float(scaled @ scaled)

        ours = displacement[free] / np.sqrt(compliance[free]) / 1e-4
        other = minimize(energy, np.zeros(free.sum()), jac="3-point", options={"gtol": 1e-7})
        assert energy(ours) <= other.fun * (1.0 + 1e-12) + 1e-15
        np.testing.assert_allclose(ours, other.x, rtol=1e-5, atol=1e-5)


def test_holder_and_contact_force_balance() -> None:
    """Force and moment about the pivot, from the wrench at the pose that the part sees."""
    poses = random_poses(400, 2)
    found = slid(HOLDER, poses)
    assert found.converged.all()
    wrench = solve(PART, SHAFT, found.pose, DOWN).wrench
    assert (np.abs(wrench[:, 0]) > 1e-3).sum() > 200
    np.testing.assert_allclose(found.wrench, wrench, rtol=0, atol=1e-15)
    at_pivot = move_torque(wrench, PIVOT)
    turn = Rotation.from_euler("xy", found.displacement[:, 3:])
    elastic = found.displacement / SOFT
    np.testing.assert_allclose(turn.apply(at_pivot[:, :3]), elastic[:, :3], rtol=0, atol=2e-9)
    np.testing.assert_allclose(at_pivot[:, 3], elastic[:, 3], rtol=0, atol=2e-12)
    torque_y = turn.apply(at_pivot[:, 3:])[:, 1]
    np.testing.assert_allclose(torque_y, elastic[:, 4], rtol=0, atol=2e-12)
    for pose, displacement, inside in zip(poses[:50], found.displacement, found.pose, strict=False):
        np.testing.assert_allclose(seen(pose, displacement), inside, rtol=0, atol=1e-15)


def test_a_soft_holder_yields_and_takes_load_off_the_contact() -> None:
    """Untilted and 3 um beyond the clearance: two springs of 4 mN/um in series with the holder."""
    for axis, compliance in ((0, 5e-4), (1, 2e-5)):
        pose = np.array([0.0, 0.0, 1.2e-3, 0.0, 0.0])
        pose[axis] = 8e-6
        found = slid(Holder(SOFT * [1, 1, 0, 0, 0]), pose, SMOOTH)
        force = 3e-6 / (1.0 / 8e3 + compliance)
        assert found.wrench[axis] == pytest.approx(force, rel=1e-6)
        assert found.displacement[axis] == pytest.approx(compliance * force, rel=1e-6)


def test_a_rigid_holder_is_the_contact_alone_and_the_limit_of_stiff_ones() -> None:
    poses = random_poses(300, 3)
    rigid = slid(Holder(), poses)
    assert (rigid.displacement == 0.0).all()
    bare = solve(PART, SHAFT, poses, DOWN).wrench
    np.testing.assert_allclose(rigid.wrench, bare, rtol=0, atol=1e-12)
    gaps = [
        np.abs(slid(Holder(SOFT * scale, pivot_m=PIVOT), poses).wrench - bare).max()
        for scale in (1e-3, 1e-5, 1e-7)
    ]
    assert gaps[0] > 50 * gaps[1] > 2500 * gaps[2]
    assert gaps[2] < 5e-6


def test_the_part_slips_at_the_holding_force_and_keeps_the_offset() -> None:
    """x holds 10 mN: pushed 8 um beyond the clearance, the contact takes 1.25 um, the spring 5."""
    holder = Holder(SOFT * [1, 0, 0, 0, 0], np.array([0.01, np.inf, np.inf, np.inf, np.inf]))
    pose = np.array([13e-6, 0.0, 1.2e-3, 0.0, 0.0])
    contact = sliding_contact(PART, SHAFT, DOWN, SMOOTH)
    pushed = settle(holder, np.zeros(5), pose, contact)
    assert pushed.converged
    assert pushed.wrench[0] == pytest.approx(0.01, rel=1e-6)
    assert pushed.displacement[0] == pytest.approx(8e-6 - 0.01 / 8e3, rel=1e-6)
    assert pushed.offset[0] == pytest.approx(8e-6 - 0.01 / 8e3 - 5e-6, rel=1e-6)
    free = settle(holder, pushed.offset, pose * [0, 0, 1, 0, 0], contact)
    np.testing.assert_array_equal(free.displacement, pushed.offset)
    np.testing.assert_array_equal(free.offset, pushed.offset)
    again = settle(holder, pushed.offset, pose, contact)
    np.testing.assert_allclose(again.displacement, pushed.displacement, rtol=0, atol=1e-12)
    np.testing.assert_allclose(again.offset, pushed.offset, rtol=0, atol=1e-12)


@pytest.mark.slow
@pytest.mark.parametrize("friction", [0.0, 0.2, 0.5])
def test_it_converges_at_the_kinks_with_slip(friction: float) -> None:
    """Random depths with cut circles, up to 25 um of overlap; shifts of the part only.

    The load reaches the holding force exactly where the part slips, and in its direction.
    """
    rng = np.random.default_rng(4)
    limit = np.array([0.03, 0.05, 0.5, np.inf, np.inf])
    holder = Holder(SOFT * [1, 1, 1, 0, 0], limit)
    poses = rng.uniform(-1, 1, (600, 5)) * [3e-5, 3e-5, 2.2e-3, 5e-3, 5e-3] + [0, 0, 1.5e-3, 0, 0]
    found = slid(holder, poses, ContactLaw(friction=friction))
    assert found.converged.mean() >= 0.999
    assert (found.converged == (found.residual_N <= 1e-9)).all()
    slips = found.offset != 0.0
    assert slips.any(axis=-1).mean() > 0.3
    assert (np.abs(found.holder_force) <= limit).all()
    borne = np.copysign(np.broadcast_to(limit, slips.shape), found.offset)
    np.testing.assert_array_equal(found.holder_force[slips], borne[slips])


@pytest.mark.slow
def test_it_converges_also_if_a_rigidly_held_part_slips_on_all_axes() -> None:
    rng = np.random.default_rng(7)
    holder = Holder(np.zeros(5), np.array([0.03, 0.05, 0.5, 1e-4, 1e-4]), PIVOT)
    poses = rng.uniform(-1, 1, (400, 5)) * [3e-5, 3e-5, 2.2e-3, 5e-3, 5e-3] + [0, 0, 1.5e-3, 0, 0]
    found = slid(holder, poses)
    assert found.converged.mean() >= 0.985
    assert (found.offset[:, 3:] != 0.0).any(axis=-1).mean() > 0.1


axis = st.floats(-1.0, 1.0)


@settings(max_examples=40)
@given(st.tuples(axis, axis, axis, axis), st.sampled_from(DEPTHS), st.floats(0.0, 0.4))
def test_the_holder_never_raises_the_force_and_mirrors_with_the_pose(
    numbers: tuple[float, float, float, float], depth: float, mu: float
) -> None:
    x, y, rx, ry = numbers
    pose = np.array([2e-5 * x, 2e-5 * y, depth, 5e-3 * rx, 5e-3 * ry])
    law = ContactLaw(friction=mu)
    holder = Holder(SOFT * [1, 1, 1, 1, 1])
    found, mirrored = slid(holder, np.array([pose, pose * [-1, 1, 1, 1, -1]]), law).wrench
    np.testing.assert_allclose(mirrored[:3], found[:3] * [-1, 1, 1], rtol=0, atol=1e-7)
    rigid = solve(PART, SHAFT, pose, STILL, SMOOTH).penetration
    held = slid(holder, pose, SMOOTH)
    softer = solve(PART, SHAFT, held.pose, STILL, SMOOTH).penetration
    assert held.converged
    assert (softer**2).sum() <= (rigid**2).sum() + 1e-20


def test_an_entry_has_the_same_bits_in_any_batch() -> None:
    rng = np.random.default_rng(5)
    poses = rng.uniform(-1, 1, (40, 5)) * [3e-5, 3e-5, 2.2e-3, 5e-3, 5e-3] + [0, 0, 1.5e-3, 0, 0]
    holder = Holder(SOFT, np.array([0.03, 0.05, 0.5, 1e-3, 1e-3]), PIVOT)
    together = slid(holder, poses.reshape(5, 8, 5))
    for row in (0, 7, 23, 39):
        alone, place = slid(holder, poses[row]), np.unravel_index(row, (5, 8))
        for name in ("displacement", "offset", "wrench", "residual_N"):
            assert (getattr(together, name)[place] == getattr(alone, name)).all(), name


def test_a_part_without_an_equilibrium_is_not_converged() -> None:
    """A contact that pushes with a constant force above the holding force drives the part away."""
    holder = Holder(np.full(5, 1e-4), np.full(5, 1e-2))
    push = np.array([0.02, 0.0, 0.0, 0.0, 0.0, 0.0])
    found = settle(
        holder,
        np.zeros(5),
        np.zeros(5),
        lambda poses: np.broadcast_to(push, (*poses.shape[:-1], 6)),
    )
    assert not found.converged
    assert found.residual_N == pytest.approx(0.01)


def test_sticking_friction_carries_the_part_along_until_it_slides() -> None:
    """Soft along z, 24 mN of normal force: the part follows the shaft up to a load of 4.8 mN."""
    holder, law = Holder(np.array([0.0, 0.0, 1e-2, 0.0, 0.0])), StickLaw()
    pose = np.array([8e-6, 0.0, 1.2e-3, 0.0, 0.0])
    state, offset, loads = relaxed(PART, SHAFT, pose), np.zeros(5), []
    for _ in range(12):
        pose = pose + 5e-6 * ALONG_Z
        found = settle(holder, offset, pose, sticking_contact(PART, SHAFT, state, law))
        assert found.converged
        state, offset = advance(PART, SHAFT, found.pose, state, law).state, found.offset
        loads.append(found.wrench[2])
    series = 1.0 / (1e-2 + 1.0 / 6.6e3)
    held = series * 5e-6 * np.arange(1, 13)
    np.testing.assert_allclose(loads, np.minimum(held, 4.8e-3), rtol=1e-6)
    assert held[0] < 4.8e-3 < held[-1]


def test_the_sensor_sees_the_wrench_in_its_own_frame_at_its_own_origin() -> None:
    """Against forces at points: the part is turned and shifted, the sensor is not."""
    rng = np.random.default_rng(6)
    points, forces = rng.normal(size=(2, 4, 3)) * 1e-3
    displacement = np.array([1e-5, -2e-5, 3e-5, 0.02, -0.03])
    sensor = np.array([2e-3, 1e-3, -0.05])
    wrench = np.concatenate([forces.sum(axis=0), np.cross(points, forces).sum(axis=0)])
    turn = Rotation.from_euler("xy", displacement[3:])
    placed = turn.apply(points - PIVOT) + PIVOT + displacement[:3]
    moment = np.cross(placed - sensor, turn.apply(forces)).sum(axis=0)
    expected = [*turn.apply(forces).sum(axis=0), *moment]
    found = HOLDER.wrench_at(sensor, wrench, displacement)
    np.testing.assert_allclose(found, expected, rtol=1e-12, atol=1e-18)


@pytest.mark.parametrize(
    ("values", "named"),
    [
        ({"compliance": np.array([1.0, 1.0, -1.0, 1.0, 1.0])}, "compliance"),
        ({"compliance": np.full(5, np.nan)}, "compliance"),
        ({"compliance": np.ones(6)}, "compliance"),
        ({"holding_force": np.zeros(5)}, "holding_force"),
        ({"holding_force": np.full(5, np.nan)}, "holding_force"),
        ({"pivot_m": np.ones((2, 3))}, "pivot_m"),
    ],
)
def test_an_invalid_holder_is_refused(values: dict[str, FloatArray], named: str) -> None:
    with pytest.raises(ValueError, match=rf"Holder\.{named}"):
        Holder(**values)


def test_an_offset_of_another_batch_is_refused() -> None:
    contact = sliding_contact(PART, SHAFT, DOWN, NOMINAL)
    with pytest.raises(ValueError, match="offset has shape"):
        settle(Holder(), np.zeros((2, 5)), np.zeros((3, 5)), contact)
