"""Phases and contact states, each reached by a constructed pose."""

import numpy as np
import pytest

from simulator.contact import Contacts, solve
from simulator.geometry import Hole, Part, Shaft
from simulator.states import (
    ContactState,
    Phase,
    contact_state,
    contact_states,
    hole_of,
    is_inserting,
    phase_codes,
    touching_stations,
)

PART = Part((Hole(1.01e-3, 5e-4), Hole(1.01e-3, 5e-4, 1.5e-3)))
SHAFT = Shaft(1e-3, 4e-3)

# Depth of B2 [mm], and offset of the shaft's axis [um] at the rim A1 and at B2. Clearance is 5 um.
POSES = {
    "FREE": [(0.25, 1, -1), (1.2, 0, 0), (2.25, 2, 2), (-0.1, 20, 20)],
    "A": [(0.3, 9, 0), (0.2, -9, 2)],
    "B": [(0.3, 2, 8), (0.3, 0, -9)],
    "C": [(0.3, 8, 8), (0.3, 8, -8)],
    "D": [(1.2, 8, -5), (1.2, 0, 14)],
    "E": [(1.2, 8, 8), (1.2, 12, 2)],
    "F": [(2.2, 7, -4), (2.2, 1, -5.3)],
    "G": [(2.2, 7, 2.6), (2.2, 1, 6)],
    "H": [(2.2, 6.5, -5.5)],
    "I": [(2.2, 8, 4.9), (2.2, 8, 8), (3.0, -7, -8), (2.2, 20, -20)],
}


def pose_through(depth_mm: float, upper_um: float, tip_um: float) -> list[float]:
    tilt = np.arctan((tip_um - upper_um) * 1e-3 / depth_mm)
    return [tip_um * 1e-6, 0.0, depth_mm * 1e-3, 0.0, float(tilt)]


def solved(poses: list[list[float]]) -> tuple[Contacts, list[int]]:
    contacts = solve(PART, SHAFT, poses, np.zeros(3))
    return contacts, phase_codes(PART, [pose[2] for pose in poses]).tolist()


@pytest.mark.parametrize("name", POSES)
def test_each_state_is_reached(name: str) -> None:
    poses = [pose_through(*numbers) for numbers in POSES[name]]
    contacts, phases = solved(poses)
    assert [ContactState(c).name for c in contact_states(contacts, phases)] == [name] * len(poses)


def test_codes_of_a_batch_equal_the_single_ones() -> None:
    poses = [pose_through(*numbers) for group in POSES.values() for numbers in group]
    contacts, phases = solved(poses)
    codes = contact_states(contacts, phases)
    assert set(codes.tolist()) == set(ContactState)
    for pose, phase, code in zip(poses, phases, codes, strict=True):
        assert contact_state(solve(PART, SHAFT, pose, np.zeros(3)), phase) is ContactState(code)


def test_an_edge_that_touches_the_lower_hole_early_is_counted_there() -> None:
    """A tilted end dips into the lower hole before its centre does."""
    pose = [9e-6, 0.0, 1.998e-3, 0.0, -0.01]
    contacts, phases = solved([pose])
    assert phases == [Phase.LOWER_APPROACHING]
    assert touching_stations(contacts)[0, 1].any()
    assert contact_states(contacts, phases).tolist() == [ContactState.I]


def test_paper_names_by_phase() -> None:
    """The letters follow from phase and number of points: a-c, then d and e, then f-i."""
    by_phase = {1: "ABC", 2: "DE", 3: "FGHI"}
    for name, group in POSES.items():
        for numbers in group:
            phase = int(phase_codes(PART, numbers[0] * 1e-3))
            assert name == "FREE" or name in by_phase[phase]


def test_a_hand_over_at_a_rim_stays_one_point() -> None:
    depths = np.linspace(0.499, 0.506, 50)
    contacts, phases = solved([[8e-6, 0.0, depth * 1e-3, 0.0, 0.0] for depth in depths])
    both = (contacts.penetration[:, 1] > 0) & (contacts.penetration[:, 4] > 0)
    assert both.any()
    assert (touching_stations(contacts).sum(axis=(1, 2)) == 2).all()
    assert set(contact_states(contacts, phases).tolist()) == {ContactState.C, ContactState.E}


@pytest.mark.parametrize(
    ("depth_mm", "phase"),
    [
        (-1.0, Phase.APPROACHING_UPPER),
        (0.0, Phase.APPROACHING_UPPER),
        (0.001, Phase.UPPER_INSERTING),
        (0.5, Phase.UPPER_INSERTING),
        (0.501, Phase.LOWER_APPROACHING),
        (2.0, Phase.LOWER_APPROACHING),
        (2.001, Phase.LOWER_INSERTING),
        (9.0, Phase.LOWER_INSERTING),
    ],
)
def test_phase_by_depth(depth_mm: float, phase: Phase) -> None:
    assert Phase(int(phase_codes(PART, depth_mm * 1e-3))) is phase


def test_phases_of_other_numbers_of_holes() -> None:
    hole = Hole(1.01e-3, 1e-4)
    one = phase_codes(Part((hole,)), [-1e-5, 5e-5, 1e-3])
    assert one.tolist() == [0, 1, 1]
    lower = Hole(1.01e-3, 1e-4, 1e-4)
    depths = np.array([-0.5, 0.5, 1.5, 2.5, 3.5, 4.5, 5.5]) * 1e-4
    three = phase_codes(Part((hole, lower, lower)), depths)
    assert three.tolist() == [0, 1, 2, 3, 4, 5, 5]
    assert [hole_of(code) for code in range(6)] == [0, 0, 1, 1, 2, 2]
    assert [is_inserting(code) for code in range(4)] == [False, True, False, True]


def test_three_holes_count_points_from_the_second_hole_on() -> None:
    hole, lower = Hole(1.01e-3, 1e-4), Hole(1.01e-3, 1e-4, 1e-3)
    part = Part((hole, lower, lower))
    poses = [[8e-6, 0.0, depth, 0.0, 0.0] for depth in (0.5e-4, 6e-4, 15e-4)]
    contacts = solve(part, SHAFT, poses, np.zeros(3))
    states = contact_states(contacts, phase_codes(part, [pose[2] for pose in poses]))
    assert states.tolist() == [ContactState.C, ContactState.E, ContactState.I]


def test_mismatched_phases_are_refused() -> None:
    contacts, _ = solved([pose_through(0.3, 8, 8)])
    with pytest.raises(ValueError, match=r"phases has shape \(2,\); it must be \(1,\)"):
        contact_states(contacts, [1, 1])
    with pytest.raises(ValueError, match="phases holds a negative code"):
        contact_states(contacts, [-1])
    with pytest.raises(ValueError, match="depths_m holds an entry that is not finite"):
        phase_codes(PART, [0.0, np.nan])
