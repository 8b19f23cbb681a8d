"""The contact-pose filter works in pieces: however they are cut, the belief is the same."""

import numpy as np
import pytest

from controllers.contact_pose import (
    ContactModel,
    ContactPoseFilter,
    FilterEffort,
    Noise,
    Prior,
    StageNoise,
)
from controllers.messages import Observation
from drivers.contract.messages import Pose
from simulator.geometry import Hole, Part, Shaft

PART = Part(
    holes=(
        Hole(diameter_m=1.01e-3, thickness_m=5e-4, gap_m=0.0),
        Hole(diameter_m=1.01e-3, thickness_m=5e-4, gap_m=1.5e-3),
    )
)
SHAFT = Shaft(diameter_m=1e-3, length_m=4e-3)
PRIOR = Prior(10e-6, 5e-3, (2e3, 12e3), (2e-6, 14e-6), (0.1, 0.3))


def seen(step: int, offset_um: float, force_mN: float) -> Observation:
    pose = Pose((offset_um * 1e-6, 0.0, step * 20e-6))
    wrench = (force_mN * 1e-3, 0.0, 0.0, 0.0, -force_mN * 4e-5, 0.0)
    return Observation(step, step, wrench, (0.0,) * 6, pose, (0.0,) * 3, pose)


def filtered(solves: int, forces_mN: tuple[float, ...]) -> tuple[ContactPoseFilter, int]:
    """The filter after so many observations, and how often it paused."""
    model = ContactModel(PART, SHAFT, (0.0, 0.0, 0.04))
    pose_filter = ContactPoseFilter(
        model,
        PRIOR,
        Noise(force_N=1e-3, torque_Nm=5e-6, place_m=2e-7, model=0.02),
        StageNoise(report_m=1e-7, step_m=1e-7),
        np.random.default_rng(3),
        FilterEffort(hypotheses=128, moves=2, solves=solves),
    )
    pauses = 0
    for step, force in enumerate((0.0, *forces_mN)):
        pauses += sum(1 for _ in pose_filter.update(seen(step, 3.0, force)))
    return pose_filter, pauses


@pytest.mark.parametrize("forces_mN", [(12.0, 15.0, 9.0), (12.0, -80.0)])
def test_the_belief_does_not_depend_on_the_pieces(forces_mN: tuple[float, ...]) -> None:
    """With contact, and with a reading that nothing explains, for which it searches anew."""
    whole, few_pauses = filtered(10**9, forces_mN)
    pieces, pauses = filtered(100, forces_mN)
    assert pauses > 5 * few_pauses
    assert pieces.restarts == whole.restarts
    assert whole.restarts == (1 if -80.0 in forces_mN else 0)
    np.testing.assert_array_equal(pieces.population.hypotheses, whole.population.hypotheses)
    np.testing.assert_array_equal(pieces.population.log_weights, whole.population.log_weights)


def test_a_piece_is_smaller_the_more_has_been_observed() -> None:
    effort = FilterEffort(solves=2048)
    assert [effort.piece(n) for n in (1, 56, 10_000)] == [227, 32, 1]
