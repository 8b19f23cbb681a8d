"""The place of the stage: its commands are believed, its reports are heard, a halt is noticed."""

import math

import numpy as np
import pytest
from filterpy.kalman import KalmanFilter

from controllers.contact_pose.place import PlaceFilter, StageNoise
from tests.controllers.contact_pose.cases import seen

UM = 1e-6


def test_it_begins_where_the_stage_was_sent() -> None:
    """With exact commands the first report counts for nothing, whatever its noise."""
    place = PlaceFilter(StageNoise(0.5 * UM, 0.0))
    assert place.pose is None
    first = seen((1 * UM, 2 * UM, -20 * UM), commanded=(0, 0, -20 * UM), rotation=(1e-3, 2e-3, 0.0))
    assert place.update(first).tolist() == [0.0, 0.0, -20 * UM, 1e-3, 2e-3]


def test_it_begins_where_the_report_is_if_the_stage_did_not_come() -> None:
    place = PlaceFilter(StageNoise(0.5 * UM, 0.02 * UM))
    first = place.update(seen((0.0, 0.0, -30 * UM), commanded=(0.0, 0.0, -20 * UM)))
    assert first.tolist() == [0.0, 0.0, -30 * UM, 0.0, 0.0]


def test_exact_commands_ignore_the_noise_of_reports() -> None:
    place, rng = PlaceFilter(StageNoise(0.5 * UM, 0.0)), np.random.default_rng(1)
    for step in range(50):
        sent = np.array([1 * UM, -2 * UM, 30 * UM]) * step
        pose = place.update(seen(sent + 0.5 * UM * rng.standard_normal(3), commanded=sent))
        np.testing.assert_allclose(pose[:3], sent, rtol=0, atol=1e-15)


def test_exact_reports_are_followed() -> None:
    place, rng = PlaceFilter(StageNoise(0.0, 1 * UM)), np.random.default_rng(2)
    for step in range(20):
        sent = np.array([0.0, 0.0, 10 * UM]) * step
        reported = sent + UM * rng.standard_normal(3)
        np.testing.assert_allclose(
            place.update(seen(reported, commanded=sent))[:3], reported, rtol=0, atol=1e-15
        )


def test_nothing_sent_means_nothing_moved() -> None:
    place = PlaceFilter(StageNoise(0.5 * UM, 0.02 * UM))
    first = place.update(seen((0.0, 0.0, 0.0), commanded=(0.0, 0.0, 0.0)))
    again = place.update(seen((1 * UM, 0.0, 1 * UM), commanded=(0.0, 0.0, 0.0)))
    assert again.tolist() == first.tolist()


def test_turns_are_taken_as_reported() -> None:
    place = PlaceFilter(StageNoise(0.5 * UM, 0.02 * UM))
    place.update(seen((0.0, 0.0, 0.0)))
    moved = place.update(seen((0.0, 0.0, 1 * UM), rotation=(1e-3, -2e-3, 3e-3)))
    assert moved[3:].tolist() == [1e-3, -2e-3]


@pytest.mark.parametrize("step_m", [0.02 * UM, 0.3 * UM, 2 * UM])
def test_is_the_kalman_filter_of_a_place_that_is_commanded(step_m: float) -> None:
    """Against filterpy, on one axis; the first place is where the stage was sent."""
    report_m, rng = 0.5 * UM, np.random.default_rng(3)
    place, expected = PlaceFilter(StageNoise(report_m, step_m)), KalmanFilter(1, 1, 1)
    expected.x, expected.P = np.zeros((1, 1)), np.zeros((1, 1))
    expected.F = expected.B = expected.H = np.eye(1)
    expected.R, expected.Q = np.array([[report_m**2]]), np.array([[step_m**2]])
    really, sent = np.zeros(3), np.zeros(3)
    for number in range(30):
        step = rng.uniform(-20 * UM, 60 * UM, 3) if number else np.zeros(3)
        sent, really = sent + step, really + step + step_m * rng.standard_normal(3)
        reported = really + report_m * rng.standard_normal(3)
        pose = place.update(seen(reported, commanded=sent))
        expected.predict(u=np.array([[step[0]]]))
        expected.update(np.array([[reported[0]]]))
        assert pose[0] == pytest.approx(float(expected.x[0, 0]), rel=0, abs=1e-13)


def test_two_reports_in_numbers() -> None:
    """Unit deviations: gains of 1/2, then of (1/2 + 1)/(1/2 + 1 + 1) = 3/5."""
    place = PlaceFilter(StageNoise(1 * UM, 1 * UM))
    first = place.update(seen((0.0, 0.0, 2 * UM), commanded=(0.0, 0.0, 0.0)))
    np.testing.assert_allclose(first[:3], [0.0, 0.0, 1 * UM], rtol=0, atol=1e-15)
    pose = place.update(seen((5 * UM, 0.0, 11 * UM), commanded=(0.0, 0.0, 10 * UM)))
    np.testing.assert_allclose(pose[:3], [3 * UM, 0.0, 11 * UM], rtol=0, atol=1e-15)


def test_the_noise_of_reports_does_not_pull_the_place_away() -> None:
    """Over 400 stages the place is off by less than the sum of the steps' own errors."""
    noise, ends = StageNoise(0.5 * UM, 0.02 * UM), []
    for seed in range(400):
        place, rng = PlaceFilter(noise), np.random.default_rng(seed)
        really = np.zeros(3)
        place.update(seen(0.5 * UM * rng.standard_normal(3), commanded=really))
        for step in range(1, 61):
            sent = np.array([0.0, 0.0, 40 * UM]) * step
            really = really + [0.0, 0.0, 40 * UM] + 0.02 * UM * rng.standard_normal(3)
            reported = really + 0.5 * UM * rng.standard_normal(3)
            pose = place.update(seen(reported, commanded=sent))
        ends.append(pose[:3] - really)
    # Steps alone would leave sqrt(60) 0.02 um = 0.155 um, and one report 0.5 um.
    assert np.sqrt(np.mean(np.square(ends))) < 0.11 * UM


@pytest.mark.parametrize("axis", [0, 1, 2])
@pytest.mark.parametrize("direction", [-1.0, 1.0])
def test_a_halted_stage_is_noticed(axis: int, direction: float) -> None:
    """Sent 20 um, gone 3 um: with deviations of 0.5 um for reports nobody is that far off."""
    place, rng = PlaceFilter(StageNoise(0.5 * UM, 0.02 * UM)), np.random.default_rng(5)
    sent = np.zeros(3)
    for _ in range(20):
        sent = np.add(sent, [0.0, 0.0, 20 * UM])
        place.update(seen(sent + 0.5 * UM * rng.standard_normal(3), commanded=sent))
    halted = sent.copy()
    halted[axis] += direction * 3 * UM
    sent = sent.copy()
    sent[axis] += direction * 20 * UM
    pose = place.update(seen(halted + 0.1 * UM, commanded=sent))
    np.testing.assert_allclose(pose[:3], halted, rtol=0, atol=1.5 * UM)
    # From there on, commands are believed again, relative to what was sent.
    down = np.array([0.0, 0.0, 5 * UM])
    for _ in range(200):
        sent, halted = sent + down, halted + down
        pose = place.update(seen(halted + 0.5 * UM * rng.standard_normal(3), commanded=sent))
    np.testing.assert_allclose(pose[:3], halted, rtol=0, atol=1.0 * UM)


def test_after_a_halt_the_place_is_known_as_well_as_a_report() -> None:
    """Unit deviations: at the next report a gain of (1 + 1)/(1 + 1 + 1) = 2/3."""
    place = PlaceFilter(StageNoise(1 * UM, 1 * UM))
    halted = place.update(seen((0.0, 0.0, -20 * UM), commanded=(0.0, 0.0, 0.0)))
    assert halted[2] == -20 * UM
    pose = place.update(seen((0.0, 0.0, -7 * UM), commanded=(0.0, 0.0, 10 * UM)))
    assert pose[2] == pytest.approx(-8 * UM, abs=1e-15)


def test_a_stage_without_noise_is_where_it_reports() -> None:
    place = PlaceFilter(StageNoise(0.0, 0.0))
    for sent, reported in ((0, 0), (10, 10), (20, 13)):
        pose = place.update(seen((0, 0, reported * UM), commanded=(0, 0, sent * UM)))
        assert pose[2] == reported * UM


@pytest.mark.parametrize(("off_um", "is_halt"), [(4.99, False), (5.01, True)])
def test_the_border_between_noise_and_halt(off_um: float, is_halt: bool) -> None:
    """Five deviations of a report of 0.8 um and a step of 0.6 um, together 1 um: 5 um."""
    place = PlaceFilter(StageNoise(0.8 * UM, 0.6 * UM))
    pose = place.update(seen((0.0, 0.0, (10 - off_um) * UM), commanded=(0.0, 0.0, 10 * UM)))
    came = pose[2] == pytest.approx((10 - off_um) * UM, abs=1e-12)
    assert came == is_halt


@pytest.mark.parametrize(
    ("report_m", "step_m", "message"),
    [
        (-1e-6, 0.0, "StageNoise.report_m is -1e-06; it must be finite and at least 0"),
        (0.0, math.nan, "StageNoise.step_m is nan; it must be finite and at least 0"),
    ],
)
def test_noise_that_cannot_be_is_refused(report_m: float, step_m: float, message: str) -> None:
    with pytest.raises(ValueError, match=message):
        StageNoise(report_m, step_m)
