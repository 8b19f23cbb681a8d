"""The filter as a whole: what it takes in, what it believes, and how it recovers."""

import math
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from controllers.belief_controller import BeliefController
from controllers.contact_pose.belief import Belief
from controllers.contact_pose.contact_model import Noise, Trace
from controllers.contact_pose.filter import ContactPoseFilter, FilterEffort
from controllers.contact_pose.hypotheses import Parameter
from controllers.contact_pose.look_ahead import LookAheadSettings
from controllers.contact_pose.population import Population
from controllers.messages import Observation
from simulator.checks import FloatArray
from simulator.states import ContactState
from tests.controllers.contact_pose.cases import (
    NO_LOAD,
    PRIOR,
    contact_model,
    contact_pose_filter,
    finish,
    seen,
)

TRUTH = np.array([[4e-6, -3e-6, 2e-3, -1e-3, 7e3, 6e-6, 0.2]])
WRONG = np.array([[-6e-6, 5e-6, -3e-3, 2e-3, 3e3, 13e-6, 0.12]])
LOOK = LookAheadSettings((20e-6, 20e-6, 60e-6), 8e-4, (60e-6, 9e-6), 8e-3, 0.9, 64)
MODEL = contact_model()
NAN6 = (0.0, math.nan, 0.0, 0.0, 0.0, 0.0)


def sweep(seed: int, truth: FloatArray = TRUTH, count: int = 24) -> list[Observation]:
    """Pushed to and fro in the first hole and on to the second; read with the sensor's noise."""
    rng, observations = np.random.default_rng(seed), []
    place = np.array([0.0, 0.0, -2e-5])
    for number in range(count):
        step = np.array([*rng.uniform(-8e-6, 8e-6, 2), 60e-6 if number < 12 else 180e-6])
        step[:2] = np.clip(place[:2] + step[:2], -9e-6, 9e-6) - place[:2]
        place = place + step
        pose = np.array([[*place, 0.0, 0.0]])
        wrench = MODEL.contacts(truth, pose, step[np.newaxis]).wrench[0]
        wrench = wrench + rng.standard_normal(6) * ([2e-3] * 3 + [1e-5] * 3)
        observations.append(seen(place, wrench, step=number))
    return [seen((0.0, 0.0, -2e-5)), *observations]


def told(pose_filter: ContactPoseFilter, observations: list[Observation]) -> ContactPoseFilter:
    for observation in observations:
        finish(pose_filter.update(observation))
    return pose_filter


def off(belief: Belief, truth: FloatArray = TRUTH) -> FloatArray:
    """By its own deviations."""
    return np.asarray((belief.mean - truth[0]) / belief.std)


def test_contact_tells_of_pose_and_part() -> None:
    before = contact_pose_filter(1).belief()
    pose_filter = told(contact_pose_filter(1), sweep(1))
    belief = pose_filter.belief()
    assert np.abs(off(belief)).max() < 4.0
    assert (belief.std < 1.05 * before.std).all()
    assert (belief.std[:4] < 0.35 * before.std[:4]).all()
    assert belief.std[Parameter.STIFFNESS] < 0.3 * before.std[Parameter.STIFFNESS]
    assert belief.misfit < 25.0
    assert pose_filter.restarts == 0


def test_a_belief_names_its_moments() -> None:
    pose_filter = contact_pose_filter(1)
    rng = np.random.default_rng(2)
    hypotheses, weights = PRIOR.drawn(256, rng), rng.random(256)
    pose_filter.population = Population(hypotheses, np.log(weights))
    belief = pose_filter.belief()
    np.testing.assert_allclose(belief.mean, np.average(hypotheses, axis=0, weights=weights))
    expected = np.cov(hypotheses, rowvar=False, aweights=weights, ddof=0)
    np.testing.assert_allclose(belief.covariance, expected, rtol=1e-9, atol=1e-20)
    np.testing.assert_allclose(belief.std, np.sqrt(np.diag(expected)))
    assert belief.offset_m.tolist() == belief.mean[:2].tolist()
    assert belief.tilt_rad.tolist() == belief.mean[2:4].tolist()
    assert (belief.stiffness_N_m, belief.clearance_m) == (belief.mean[4], belief.mean[5])
    assert (belief.state, belief.state_probability) == (ContactState.FREE, 1.0)


def test_a_belief_names_the_likeliest_state() -> None:
    pose_filter = told(contact_pose_filter(3), sweep(3))
    belief = pose_filter.belief()
    newest = sweep(3)[-1]
    pose = np.array([[*newest.pose.position, 0.0, 0.0]])
    found = MODEL.contacts(TRUTH, pose, np.array([[0.0, 0.0, 1.8e-4]])).state[0]
    assert found != ContactState.FREE
    assert belief.state == found
    assert belief.state_probability > 0.6


def test_a_lost_belief_starts_again_and_finds_the_truth() -> None:
    """All hypotheses sit at a wrong place, from where small moves do not lead back."""
    observations = sweep(5)
    pose_filter = told(contact_pose_filter(5), observations[:4])
    pose_filter.population = Population(np.repeat(WRONG, 256, axis=0), np.zeros(256))
    told(pose_filter, observations[4:])
    assert 1 <= pose_filter.restarts <= 3
    assert np.abs(off(pose_filter.belief())).max() < 4.0
    assert pose_filter.belief().misfit < 25.0
    assert len(pose_filter.population.hypotheses) == 256


def test_after_a_restart_the_misfit_is_that_of_what_was_found() -> None:
    """The misfit that led to the restart was over 40."""
    observations = sweep(5)
    pose_filter = told(contact_pose_filter(5), observations[:4])
    pose_filter.population = Population(np.repeat(WRONG, 256, axis=0), np.zeros(256))
    told(pose_filter, observations[4:5])
    assert pose_filter.restarts == 1
    assert pose_filter.belief().misfit < 25.0


@pytest.mark.slow
def test_the_whole_history_counts() -> None:
    """Told in one restart or one by one, the belief is the same to within its own width."""
    one = told(contact_pose_filter(6, FilterEffort(1024, 6)), sweep(6)).belief()
    lost = told(contact_pose_filter(7, FilterEffort(1024, 6, misfit_max=1e9)), sweep(6)[:-1])
    lost.population = Population(np.repeat(WRONG, 1024, axis=0), np.zeros(1024))
    lost._effort = FilterEffort(1024, 6)
    other = told(lost, sweep(6)[-1:]).belief()
    assert lost.restarts == 1
    assert (np.abs(one.mean - other.mean) / one.std).max() < 1.0
    np.testing.assert_allclose(other.std / one.std, 1.0, atol=0.6)


def test_what_has_not_moved_says_nothing_new() -> None:
    pose_filter = told(contact_pose_filter(8), sweep(8)[:5])
    before = pose_filter.population.log_weights.tobytes()
    still = sweep(8)[4]
    told(pose_filter, [still, seen(still.pose.position, (0.5, 0.0, 0.0, 0.0, 0.0, 0.0))])
    assert pose_filter.population.log_weights.tobytes() == before


def test_the_first_observation_only_places_the_stage() -> None:
    pose_filter = contact_pose_filter(9)
    assert pose_filter.pose is None
    told(pose_filter, [seen((1e-6, 0.0, -2e-5), (0.5, 0.0, 0.0, 0.0, 0.0, 0.0))])
    assert pose_filter.pose is not None
    np.testing.assert_allclose(pose_filter.pose, [1e-6, 0.0, -2e-5, 0.0, 0.0], atol=1e-15)
    assert pose_filter.population.log_weights.tolist() == [0.0] * 256


BAD: list[tuple[str, Callable[[], Observation]]] = [
    ("wrench", lambda: seen((0.0, 0.0, 1e-4), NAN6, step=7)),
    ("wrench", lambda: seen((0.0, 0.0, 1e-4), (*NO_LOAD[:5], math.inf), step=7)),
    ("pose.position", lambda: seen((0.0, math.nan, 1e-4), commanded=(0.0, 0.0, 1e-4), step=7)),
    ("pose.rotation", lambda: seen((0.0, 0.0, 1e-4), rotation=(0.0, math.inf, 0.0), step=7)),
    ("commanded.position", lambda: seen((0.0, 0.0, 0.0), commanded=(0.0, 0.0, -math.inf), step=7)),
]


@pytest.mark.parametrize(("name", "bad"), BAD)
def test_what_is_not_finite_is_refused_and_changes_nothing(
    name: str, bad: Callable[[], Observation]
) -> None:
    pose_filter = told(contact_pose_filter(2), sweep(2)[:4])
    population, pose = pose_filter.population, pose_filter.pose
    before = population.hypotheses.tobytes(), population.log_weights.tobytes()
    with pytest.raises(ValueError, match=rf"step 7: {name} is .*; every entry must be finite"):
        told(pose_filter, [bad()])
    assert (population.hypotheses.tobytes(), population.log_weights.tobytes()) == before
    assert pose_filter.pose is pose
    told(pose_filter, sweep(2)[4:])
    assert np.abs(off(pose_filter.belief())).max() < 4.0


@pytest.mark.parametrize(
    "huge",
    [
        seen((0.0, 0.0, 1e-4), (1e200, 0.0, 0.0, 0.0, 0.0, 0.0), step=7),
        seen((0.0, 0.0, 1e-4), rotation=(3.0, 0.0, 0.0), step=7),
        seen((0.0, 0.0, 1e150), step=7),
    ],
)
def test_what_is_too_large_to_compute_with_is_refused(huge: Observation) -> None:
    pose_filter = told(contact_pose_filter(2), sweep(2)[:4])
    with pytest.raises(ValueError, match=r"step 7: pose .* or wrench .* is too large"):
        told(pose_filter, [huge])
    assert np.isfinite(pose_filter.population.weights).all()


def test_misfit_is_about_six_where_the_model_holds() -> None:
    """Six axes: the squared misfits of the truth, of noise of the sensor alone, are chi-squares."""
    observations = sweep(11, count=24)
    places = np.array([o.pose.position for o in observations])
    trace = Trace(
        np.hstack([places[1:], np.zeros((24, 2))]),
        np.ascontiguousarray(np.diff(places, axis=0)),
        np.array([o.wrench for o in observations[1:]]),
    )
    _, misfit = MODEL.fit(TRUTH, trace, Noise(2e-3, 1e-5, 0.0, 0.0))
    assert misfit.mean() == pytest.approx(6.0, abs=3.0 * math.sqrt(12.0 / 24.0))
    assert misfit.max() < 25.0


def test_a_step_before_any_thought_is_refused() -> None:
    generator = np.random.default_rng(1)
    controller = BeliefController(contact_pose_filter(1), MODEL, LOOK, generator)
    with pytest.raises(ValueError, match="step was called before think"):
        controller.step(sweep(1)[0])


def test_a_controller_moves_towards_where_the_hole_is_believed() -> None:
    generator = np.random.default_rng(1)
    pose_filter = contact_pose_filter(1)
    controller = BeliefController(pose_filter, MODEL, LOOK, generator)
    for observation in sweep(1):
        finish(controller.think(observation))
    move, belief = controller.step(sweep(1)[-1]), controller.belief
    turn = np.clip(-belief.tilt_rad, -8e-4, 8e-4)
    np.testing.assert_allclose(move.rotation[:2], turn, rtol=1e-12)
    assert move.translation[2] in LOOK.axial_steps_m


@pytest.mark.parametrize(
    ("effort", "message"),
    [
        ({"hypotheses": 2}, "FilterEffort.hypotheses is 2; it must be at least 3"),
        ({"moves": 0}, "FilterEffort.moves is 0; it must be at least 1"),
        ({"misfit_max": 0.0}, "FilterEffort.misfit_max is 0.0; .* greater than 0"),
    ],
)
def test_too_little_effort_is_refused(effort: dict[str, int], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        FilterEffort(**effort)


def test_a_plant_that_no_hypothesis_explains_is_searched_three_times_only() -> None:
    """Forces of 0.5 N to and fro, far from any wall: no hypothesis can have them."""
    pose_filter = contact_pose_filter(4, FilterEffort(64, 1))
    for number, observation in enumerate(sweep(4)):
        force = 0.5 if number % 2 else -0.5
        told(pose_filter, [replace(observation, wrench=(force, -force, 0.0, 0.0, 0.0, 0.0))])
    assert pose_filter.restarts == 3
