"""Over plants that are drawn from the prior, the truth is anywhere in the belief."""

import numpy as np
import pytest

from controllers.belief_controller import BeliefController
from controllers.contact_pose import ContactModel, ContactPoseFilter, Noise, Prior, StageNoise
from controllers.contact_pose.look_ahead import LookAheadSettings
from learning.evaluation.plant import Plant, drawn_plants, generators_of
from learning.evaluation.trial import Record, Trial, TrialRules, insert
from simulator.checks import FloatArray
from simulator.geometry import Hole, Part
from tests.learning.evaluation.plants import extended

PLANTS = 40
RULES = TrialRules()
PRIOR = Prior(10e-6, np.radians(0.3), (2e3, 12e3), (2e-6, 14e-6), (0.1, 0.3))
NOISE = Noise(2e-3, 1e-5, 0.1e-6, 0.05)
STAGE = StageNoise(0.5e-6, 0.02e-6)
STEPS_M = (60e-6, 40e-6, 25e-6, 15e-6, 9e-6, 5e-6, 2.5e-6)
LOOK = LookAheadSettings(RULES.step_box_m, RULES.turn_rad, STEPS_M, 8e-3, 0.9, 128)


def inserted(
    plant: Plant, of_trial: np.random.Generator, of_belief: np.random.Generator
) -> tuple[Record, FloatArray]:
    """One insertion, and the share of the belief that lies below the truth of each parameter."""
    drawing = Part(tuple(Hole(1.008e-3, h.thickness_m, h.gap_m) for h in plant.part.holes))
    model = ContactModel(drawing, plant.shaft, RULES.sensor_m)
    pose_filter = ContactPoseFilter(model, PRIOR, NOISE, STAGE, of_belief)
    controller = BeliefController(pose_filter, model, LOOK, of_belief)
    record = insert(Trial(plant, RULES, of_trial), controller)
    clearance_m = plant.part.holes[0].diameter_m - plant.shaft.diameter_m
    law = plant.law.stiffness_N_m, clearance_m, plant.law.friction
    truth = np.array([*plant.misalignment[:2], *plant.misalignment[3:], *law])
    population = pose_filter.population
    below: FloatArray = population.weights @ (population.hypotheses < truth)
    return record, below


@pytest.mark.slow
def test_the_truth_is_within_the_central_belief_as_often_as_it_says() -> None:
    """And all of these plants are inserted, at less than a third of a limit on average.

    Of 280 pairs of plant and parameter 90 % lie within the central 90 %. Those of a plant are not
    independent: with the deviation of 40 independent ones, 4.7 %, the lower end is three
    deviations off.
    """
    plants = drawn_plants(extended(), PLANTS, 1)
    found = [
        inserted(plant, *generators)
        for plant, *generators in zip(
            plants, generators_of(1001, PLANTS), generators_of(2001, PLANTS), strict=True
        )
    ]
    assert all(record.is_success for record, _ in found)
    below = np.array([share for _, share in found])
    central = ((below > 0.05) & (below < 0.95)).mean()
    assert 0.76 <= central <= 0.99
    assert (((below > 0.05) & (below < 0.95)).mean(axis=0) > 0.7).all()
    radial_N = [np.hypot(*record.wrenches[:, :2].T).mean() for record, _ in found]
    assert np.mean(radial_N) < 1e-3
