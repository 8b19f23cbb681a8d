"""Readings that hypotheses predict, and how well they fit, by a path of its own through numpy."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from scipy.stats import multivariate_normal

from controllers.contact_pose.contact_model import ContactModel, Noise, Trace, move_torques, weigh
from simulator.checks import FloatArray
from simulator.contact import ContactLaw, solve
from simulator.states import contact_state, phase_codes
from simulator.wrench import move_torque
from tests.controllers.contact_pose.cases import (
    NOISE,
    PRIOR,
    SENSOR_M,
    SHAFT,
    contact_model,
    part,
    pressing,
)

HYPOTHESES = PRIOR.drawn(40, np.random.default_rng(11))
POSES, TRAVELS = pressing(12, 12)


def predicted(
    hypothesis: FloatArray, pose: FloatArray, travel: FloatArray
) -> tuple[FloatArray, int]:
    """Wrench about the sensor, and state, of the numpy contact on the part that is supposed."""
    x, y, rx, ry, stiffness, clearance, friction = hypothesis.tolist()
    supposed, law = part(clearance), ContactLaw(stiffness, friction)
    shaft_pose = np.add(pose, [x, y, 0.0, rx, ry])
    found = solve(supposed, SHAFT, shaft_pose, travel, law)
    state = contact_state(found, int(phase_codes(supposed, shaft_pose[2])))
    return move_torque(found.wrench, SENSOR_M), int(state)


def test_contacts_are_those_of_the_contact_model() -> None:
    found = contact_model().contacts(HYPOTHESES, POSES, TRAVELS)
    touching = 0
    for i, hypothesis in enumerate(HYPOTHESES):
        for t, (pose, travel) in enumerate(zip(POSES, TRAVELS, strict=True)):
            wrench, state = predicted(hypothesis, pose, travel)
            row = i * len(POSES) + t
            np.testing.assert_allclose(found.wrench[row], wrench, rtol=1e-7, atol=1e-10)
            assert found.state[row] == state
            touching += state > 0
    assert touching > 200


def test_the_part_is_as_drawn_under_a_hypothesis_of_its_clearance() -> None:
    """Whatever the drawing says: only the supposed clearance counts."""
    tight = ContactModel(part(3e-6), SHAFT, SENSOR_M)
    one, other = (
        model.contacts(HYPOTHESES, POSES, TRAVELS).wrench for model in (contact_model(), tight)
    )
    np.testing.assert_allclose(one, other, rtol=1e-7, atol=1e-10)


def test_a_hypothesis_without_a_bore_is_refused() -> None:
    hypothesis = HYPOTHESES[:1].copy()
    hypothesis[0, 5] = -1e-3
    with pytest.raises(ValueError, match="it must leave a bore"):
        contact_model().contacts(hypothesis, POSES, TRAVELS)


def test_depth_of_the_middle_of_the_first_wall() -> None:
    assert contact_model().pivot_depth_m == pytest.approx(2.5e-4, rel=1e-12)


def test_torques_are_moved_as_in_the_simulator() -> None:
    rng = np.random.default_rng(4)
    wrenches, origin = rng.standard_normal((20, 6)), rng.standard_normal(3)
    expected = move_torque(wrenches, origin)
    move_torques(wrenches, origin)
    np.testing.assert_allclose(wrenches, expected, rtol=1e-13, atol=1e-13)


def covariance(expected: FloatArray, place_N: float, lever_m: float, noise: Noise) -> FloatArray:
    """The full one: sensor noise, and a force that the model lacks, at a point of the axis."""
    radial = np.hypot(expected[0], expected[1])
    lack = (noise.model * radial) ** 2 + min(place_N, radial) ** 2
    sensor = np.diag([noise.force_N**2] * 3 + [noise.torque_Nm**2] * 3)
    acts = np.zeros((6, 3))
    acts[:3] = np.eye(3)
    for axis in range(3):
        acts[3:, axis] = np.cross([0.0, 0.0, lever_m], np.eye(3)[axis])
    return sensor + lack * acts @ acts.T


@pytest.mark.parametrize(
    "noise",
    [NOISE, Noise(1e-3, 2e-6, 0.0, 0.0), Noise(5e-3, 1e-6, 2e-6, 0.3)],
    ids=["usual", "of the sensor alone", "mostly of the model"],
)
def test_weighs_as_a_normal_distribution_of_six_axes(noise: Noise) -> None:
    rng = np.random.default_rng(7)
    n, count = 6, 5
    expected = rng.standard_normal((n, count, 6)) * ([0.05] * 3 + [2e-3] * 3)
    expected[1] *= 1e-3
    expected[2] = 0.0
    observed = expected[0] + rng.standard_normal((count, 6)) * ([5e-3] * 3 + [1e-4] * 3)
    stiffness, levers = rng.uniform(2e3, 12e3, n), rng.uniform(-0.04, -0.038, count)
    log_likelihood, misfit = np.empty((n, count)), np.empty((n, count))
    settings = (noise.force_N, noise.torque_Nm, noise.model)
    weigh(expected, observed, stiffness * noise.place_m, levers, settings, log_likelihood, misfit)
    constant = -3.0 * math.log(2.0 * math.pi) - 3.0 * math.log(noise.force_N * noise.torque_Nm)
    for i in range(n):
        for t in range(count):
            full = covariance(expected[i, t], stiffness[i] * noise.place_m, levers[t], noise)
            # In units of the noise, or the inversion of the full matrix would lose digits.
            units = np.sqrt(np.diag(full))
            density = multivariate_normal(cov=full / np.outer(units, units), allow_singular=False)
            apart = (observed[t] - expected[i, t]) / units
            log_density = float(density.logpdf(apart)) - float(np.log(units).sum())
            square = float(apart @ np.linalg.solve(full / np.outer(units, units), apart))
            assert misfit[i, t] == pytest.approx(square, rel=1e-6)
            assert log_likelihood[i, t] + constant == pytest.approx(log_density, rel=1e-6)


def test_free_air_says_nothing_of_the_stiffness() -> None:
    """No contact, no error of it: a stiff one is as likely as a soft one."""
    hypotheses = np.tile([0.0, 0.0, 0.0, 0.0, 2e3, 8e-6, 0.2], (2, 1))
    hypotheses[1, 4] = 12e3
    read = 2e-3 * np.random.default_rng(1).standard_normal((1, 6))
    trace = Trace(np.array([[0.0, 0.0, 1e-3, 0.0, 0.0]]), np.array([[0.0, 0.0, 2e-5]]), read)
    log_likelihood, misfit = contact_model().fit(hypotheses, trace, NOISE)
    assert log_likelihood[0] == log_likelihood[1]
    assert misfit[0] == misfit[1]


def test_weighs_what_hardly_fits_without_losing_digits() -> None:
    """A wall hit with 100 N: the force says little, force and torque together say nearly all."""
    expected = np.zeros((1, 1, 6))
    expected[0, 0, 0], lever = 100.0, -0.04
    expected[0, 0, 4] = lever * 100.0
    observed = expected[0].copy()
    observed[0, 0] += 1.0
    observed[0, 4] += lever * 1.0 + 3e-5
    log_likelihood, misfit = np.empty((1, 1)), np.empty((1, 1))
    settings = (2e-3, 1e-5, 0.05)
    weigh(expected, observed, np.zeros(1), np.array([lever]), settings, log_likelihood, misfit)
    # Lacking force: 1 N of 5 N deviation. Force and torque disagree by 30 uN m, where the noise of
    # both makes hypot(10 uN m, 40 mm * 2 mN) = 80.62 uN m.
    assert misfit[0, 0] == pytest.approx(0.2**2 + (3e-5 / 8.0623e-5) ** 2, rel=1e-3)


def rotated(vectors: FloatArray, angle: float) -> FloatArray:
    """x and y of the vectors (..., >= 2) turned about z."""
    turned = vectors.copy()
    cos, sin = math.cos(angle), math.sin(angle)
    turned[..., 0] = cos * vectors[..., 0] - sin * vectors[..., 1]
    turned[..., 1] = sin * vectors[..., 0] + cos * vectors[..., 1]
    return turned


def axis_tilt(tilt: FloatArray, change: Any) -> FloatArray:
    """The tilt whose axis is that of `tilt` after a `change` of its x and y."""
    rx, ry = tilt[..., 0], tilt[..., 1]
    axis = np.stack([np.sin(ry) * np.cos(rx), -np.sin(rx), np.cos(ry) * np.cos(rx)], axis=-1)
    u = change(axis)
    return np.stack(
        [np.arctan2(-u[..., 1], np.hypot(u[..., 0], u[..., 2])), np.arctan2(u[..., 0], u[..., 2])],
        axis=-1,
    )


def changed(change: Any, is_mirror: bool) -> tuple[FloatArray, Trace]:
    """Hypotheses and trace seen from a turned or mirrored frame. The stage reports no tilt."""
    hypotheses, poses, travels = HYPOTHESES.copy(), POSES.copy(), change(TRAVELS)
    poses[:, 3:] = 0.0
    hypotheses[:, :2], poses[:, :2] = change(HYPOTHESES[:, :2]), change(POSES[:, :2])
    hypotheses[:, 2:4] = axis_tilt(HYPOTHESES[:, 2:4], change)
    read = np.random.default_rng(2).standard_normal((len(POSES), 6)) * ([0.02] * 3 + [8e-4] * 3)
    sign = -1.0 if is_mirror else 1.0
    wrenches = np.hstack([change(read[:, :3]), sign * change(read[:, 3:])])
    return hypotheses, Trace(poses, travels, wrenches)


def mirrored(vectors: FloatArray) -> FloatArray:
    flipped = vectors.copy()
    flipped[..., 1] *= -1.0
    return flipped


@pytest.mark.parametrize("angle", [0.3, math.pi / 2.0, 2.5])
def test_a_turn_about_the_hole_changes_nothing(angle: float) -> None:
    same = changed(lambda v: v.copy(), False)
    turned = changed(lambda v: rotated(v, angle), False)
    for one, other in zip(
        contact_model().fit(*same, NOISE), contact_model().fit(*turned, NOISE), strict=True
    ):
        np.testing.assert_allclose(one, other, rtol=1e-6, atol=1e-8)


def test_a_mirror_changes_nothing() -> None:
    """Torques are axial vectors: a mirror turns them the other way."""
    same, other = changed(lambda v: v.copy(), False), changed(mirrored, True)
    for one, two in zip(
        contact_model().fit(*same, NOISE), contact_model().fit(*other, NOISE), strict=True
    ):
        np.testing.assert_allclose(one, two, rtol=1e-6, atol=1e-8)


def test_the_fit_joins_prediction_and_noise() -> None:
    """A stiffer contact makes more of an error of place, in the middle of what is inserted."""
    rng = np.random.default_rng(8)
    read = rng.standard_normal((len(POSES), 6)) * ([0.02] * 3 + [8e-4] * 3)
    _, misfit = contact_model().fit(HYPOTHESES, Trace(POSES, TRAVELS, read), NOISE)
    for i, hypothesis in enumerate(HYPOTHESES[:10]):
        for t, (pose, travel) in enumerate(zip(POSES, TRAVELS, strict=True)):
            wrench, _ = predicted(hypothesis, pose, travel)
            lever = 0.5 * max(pose[2], 0.0) - 0.04
            full = covariance(wrench, hypothesis[4] * 0.1e-6, lever, NOISE)
            apart = read[t] - wrench
            assert misfit[i, t] == pytest.approx(apart @ np.linalg.solve(full, apart), rel=1e-5)


@pytest.mark.parametrize(
    ("name", "value", "valid"),
    [
        ("force_N", 0.0, "greater than 0"),
        ("force_N", math.nan, "greater than 0"),
        ("torque_Nm", -1e-6, "greater than 0"),
        ("place_m", -1e-9, "at least 0"),
        ("model", math.inf, "at least 0"),
    ],
)
def test_noise_that_cannot_be_is_refused(name: str, value: float, valid: str) -> None:
    with pytest.raises(ValueError, match=rf"Noise.{name} is {value!r}; .* {valid}"):
        replace(NOISE, **{name: value})
