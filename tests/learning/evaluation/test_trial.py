"""Trials: forces of the reference simulator, steps within their box, noise and stage as stated."""

import math
from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np
import pytest

from controllers.insertion import Controller
from controllers.messages import Move, Observation
from learning.evaluation.plant import Plant
from learning.evaluation.trial import Record, Trial, TrialRules, insert
from simulator.checks import FloatArray
from simulator.contact import solve
from simulator.effects.stage import StageEffects
from simulator.holder import Holder
from tests.learning.evaluation.plants import exact, plant

RULES = TrialRules()
DOWN = Move((0.0, 0.0, 60e-6))


class Steps(Controller):
    """Moves by a rule, and keeps what it was shown."""

    def __init__(self, rule: Callable[[Observation], Move] = lambda _: DOWN) -> None:
        self.seen: list[Observation] = []
        self.thought = 0
        self._rule = rule

    def think(self, observation: Observation) -> Iterator[None]:
        self.seen.append(observation)
        yield
        self.thought += 1

    def step(self, observation: Observation) -> Move:
        return self._rule(observation)


def tried(on: Plant, rule: Callable[[Observation], Move], seed: int = 1) -> tuple[Record, Steps]:
    steps = Steps(rule)
    return insert(Trial(on, RULES, np.random.default_rng(seed)), steps), steps


def wandering(seed: int) -> Callable[[Observation], Move]:
    rng = np.random.default_rng(seed)

    def move(_: Observation) -> Move:
        x, y, z, rx, ry = (rng.uniform(-1.0, 1.0, 5) * [3e-6, 3e-6, 60e-6, 5e-4, 5e-4]).tolist()
        return Move((x, y, abs(z)), (rx, ry, 0.0))

    return move


@pytest.mark.parametrize("seed", range(4))
def test_forces_are_those_of_the_reference_simulator(seed: int) -> None:
    """Also the direction of friction: that of the last step."""
    on = exact(seed)
    record, steps = tried(on, wandering(seed))
    place, touched = np.array([0.0, 0.0, -20e-6]), 0
    for pose, wrench in zip(record.poses, record.wrenches, strict=True):
        now = pose[:3] - on.misalignment[:3]
        expected = solve(on.part, on.shaft, pose, now - place, on.law).wrench
        np.testing.assert_allclose(wrench, expected, rtol=1e-7, atol=1e-9)
        place, touched = now, touched + int(expected[:2].any())
    assert touched > 10
    assert steps.thought == len(record.poses)


def test_what_is_shown_is_what_happened() -> None:
    """Without noise: the wrench at the sensor, 40 mm down the hole, and the pose of the stage."""
    on = exact(2)
    record, steps = tried(on, wandering(7))
    first = steps.seen[0]
    assert (first.step, first.displacement) == (0, (0.0, 0.0, 0.0))
    assert first.pose.position == first.commanded.position == (0.0, 0.0, -20e-6)
    for number, (pose, wrench) in enumerate(zip(record.poses, record.wrenches, strict=True)):
        if number + 1 == len(steps.seen):
            break
        seen = steps.seen[number + 1]
        fx, fy, fz, tx, ty, tz = wrench
        at_sensor = [fx, fy, fz, tx + 0.04 * fy, ty - 0.04 * fx, tz]
        np.testing.assert_allclose(seen.wrench, at_sensor, rtol=1e-9, atol=1e-12)
        reported = [*seen.pose.position, *seen.pose.rotation[:2]]
        np.testing.assert_allclose(reported + on.misalignment, pose, rtol=0, atol=1e-15)
        np.testing.assert_allclose(
            seen.displacement, np.subtract(seen.pose.position, (0.0, 0.0, -20e-6)), atol=1e-15
        )
        np.testing.assert_allclose(seen.pose.position, seen.commanded.position, atol=1e-15)
        assert seen.step == number + 1
        assert seen.stamp_ns > steps.seen[number].stamp_ns


@pytest.mark.parametrize("sign", [-1.0, 1.0])
def test_steps_end_at_the_box(sign: float) -> None:
    trial = Trial(exact(), RULES, np.random.default_rng(1))
    before = trial.shaft_pose
    trial.step(Move((sign, sign, sign), (sign, sign, sign)))
    moved = trial.shaft_pose - before
    turn = math.radians(0.05)
    np.testing.assert_allclose(moved, sign * np.array([20e-6, 20e-6, 60e-6, turn, turn]), rtol=1e-9)
    assert trial.observe().pose.rotation[2] == 0.0
    trial.step(Move((sign * 1e-6, 0.0, sign * 2e-6)))
    moved = trial.shaft_pose - before - moved
    np.testing.assert_allclose(moved, sign * np.array([1e-6, 0, 2e-6, 0, 0]), atol=1e-15)


def test_it_ends_at_the_stroke_and_no_deeper() -> None:
    on = exact()
    record, _ = tried(on, lambda _: Move((0.0, 0.0, 59e-6)))
    depths = record.poses[:, 2]
    assert record.is_inserted
    assert depths[-1] == pytest.approx(on.part.wall_entries_m[1] + 3e-4, abs=1e-12)
    assert depths.max() == depths[-1]
    assert len(depths) == math.ceil((depths[-1] + 20e-6) / 59e-6 - 1e-9)


def test_it_ends_when_the_steps_run_out() -> None:
    rules = replace(RULES, steps_max=7)
    record = insert(Trial(exact(), rules, np.random.default_rng(1)), Steps())
    assert len(record.poses) == len(record.wrenches) == 7
    assert not record.is_inserted
    assert not record.is_success


@pytest.mark.parametrize(
    ("force", "is_success"),
    [
        ((0.069, -0.099, 0.99), True),
        ((-0.071, 0.0, 0.0), False),
        ((0.0, 0.101, 0.0), False),
        ((0.0, 0.0, -1.01), False),
        ((0.0, 0.0, math.nan), False),
    ],
)
def test_a_success_keeps_all_force_limits(
    force: tuple[float, float, float], is_success: bool
) -> None:
    wrenches = np.zeros((3, 6))
    wrenches[1, :3] = force
    record = Record(np.zeros((3, 5)), wrenches, 2e-3, (0.07, 0.1, 1.0), True, 0)
    assert record.is_success == is_success
    assert not replace(record, is_inserted=False).is_success


def test_readings_have_the_noise_of_the_plant() -> None:
    """Far above the part: 4000 readings, a deviation is known to 1.1 %."""
    on = replace(
        plant(), force_noise=np.array([1e-3, 2e-3, 3e-3, 1e-5, 2e-5, 3e-5]),
        position_noise_m=np.array([0.1e-6, 0.5e-6, 1e-6]),
    )  # fmt: skip
    trial = Trial(on, RULES, np.random.default_rng(3))
    seen = [trial.observe() for _ in range(4000)]
    read = np.array([o.wrench for o in seen])
    np.testing.assert_allclose(read.std(axis=0), on.force_noise, rtol=0.05)
    np.testing.assert_allclose(read.mean(axis=0) / on.force_noise, 0.0, atol=0.06)
    place = np.array([o.pose.position for o in seen]) - [0.0, 0.0, -20e-6]
    np.testing.assert_allclose(place.std(axis=0), on.position_noise_m, rtol=0.05)
    np.testing.assert_allclose(place.mean(axis=0) / on.position_noise_m, 0.0, atol=0.06)
    shifts = np.array([o.displacement for o in seen])
    np.testing.assert_allclose(shifts, place, rtol=0, atol=1e-15)
    apart = np.corrcoef(np.hstack([read, place]), rowvar=False) - np.eye(9)
    assert np.abs(apart).max() < 0.07
    assert {o.wrench_std for o in seen} == {(1e-3, 2e-3, 3e-3, 1e-5, 2e-5, 3e-5)}


def test_crosstalk_mixes_what_the_sensor_feels() -> None:
    crosstalk = np.eye(6) + np.random.default_rng(2).uniform(-0.02, 0.02, (6, 6))
    plain, mixed = (
        tried(on, lambda _: DOWN)[1].seen for on in (exact(), replace(exact(), crosstalk=crosstalk))
    )
    felt = np.array([o.wrench for o in plain])
    assert np.abs(felt).max() > 1e-3
    np.testing.assert_allclose([o.wrench for o in mixed], felt @ crosstalk.T, atol=1e-12)


def six(linear: float) -> FloatArray:
    return np.array([linear] * 3 + [0.0] * 3)


def test_backlash_takes_up_the_motion_at_each_reversal() -> None:
    """Play of 2 um, begun in its middle: 1 um is lost first, then 2 um at each turn."""
    trial = Trial(exact(stage=StageEffects(backlash=six(2e-6))), RULES, np.random.default_rng(1))
    start, places = trial.shaft_pose[0], []
    for x in (5e-6, 5e-6, -5e-6, -1e-6, 1e-6, 5e-6):
        trial.step(Move((x, 0.0, 0.0)))
        places.append(trial.shaft_pose[0] - start)
    expected = [4e-6, 9e-6, 6e-6, 5e-6, 5e-6, 9e-6]
    np.testing.assert_allclose(places, expected, rtol=0, atol=1e-15)


def test_motions_end_where_repeatability_lets_them() -> None:
    on = exact(stage=StageEffects(repeatability=np.array([1e-7, 2e-7, 3e-7, 0.0, 0.0, 0.0])))
    trial, off = Trial(on, RULES, np.random.default_rng(4)), []
    for _ in range(3000):
        trial.step(Move((0.0, 0.0, 0.0)))
        off.append(trial.shaft_pose[:3] - on.misalignment[:3] - [0.0, 0.0, -20e-6])
    np.testing.assert_allclose(np.std(off, axis=0), [1e-7, 2e-7, 3e-7], rtol=0.06)
    seen = trial.observe()
    assert seen.commanded.position == pytest.approx((0.0, 0.0, -20e-6), abs=1e-15)
    np.testing.assert_allclose(
        seen.pose.position - np.array([0.0, 0.0, -20e-6]), off[-1], atol=1e-15
    )


def test_the_grid_swallows_steps_below_it() -> None:
    trial = Trial(
        exact(stage=StageEffects(minimum_step=six(1e-6))), RULES, np.random.default_rng(1)
    )
    start, places = trial.shaft_pose[0], []
    for _ in range(4):
        trial.step(Move((0.4e-6, 0.0, 0.0)))
        places.append(trial.shaft_pose[0] - start)
    np.testing.assert_allclose(places, [0.0, 1e-6, 1e-6, 2e-6], rtol=0, atol=1e-15)


def test_a_generator_decides_all_of_a_trial() -> None:
    on = replace(plant(), stage=StageEffects(repeatability=six(1e-7)))
    runs = [tried(on, wandering(1), seed) for seed in (5, 5, 6)]
    records = [record.wrenches.tobytes() for record, _ in runs]
    read = [[o.wrench for o in steps.seen] for _, steps in runs]
    assert records[0] == records[1] != records[2]
    assert read[0] == read[1] != read[2]


@pytest.mark.parametrize("value", [math.nan, math.inf])
@pytest.mark.parametrize("is_turn", [False, True])
def test_a_move_that_is_not_finite_is_refused(value: float, is_turn: bool) -> None:
    trial, bad = Trial(exact(), RULES, np.random.default_rng(1)), (0.0, value, 0.0)
    move = Move((0.0, 0.0, 0.0), bad) if is_turn else Move(bad)
    before = trial.shaft_pose.tolist()
    with pytest.raises(ValueError, match=r"the move .* is not finite"):
        trial.step(move)
    assert trial.shaft_pose.tolist() == before


def test_a_soft_holder_takes_load_off_and_a_weak_one_slips_for_good() -> None:
    """Pressed 5 um beyond the clearance: two springs in series, or no more than what it holds."""
    on = exact(1)
    beyond = 0.5 * (on.part.holes[0].diameter_m - on.shaft.diameter_m) + 5e-6
    on = replace(on, misalignment=np.array([beyond, 0.0, 0.0, 0.0, 0.0]))
    soft = Holder(np.array([1.0 / on.law.stiffness_N_m, 0.0, 0.0, 0.0, 0.0]))
    weak = Holder(soft.compliance, np.array([2e-3, *(math.inf,) * 4]))
    rigid = [tried(replace(on, holder=holder), lambda _: DOWN)[0] for holder in (Holder(), soft)]
    forces = [float(record.wrenches[5, 0]) for record in rigid]
    assert forces[1] == pytest.approx(forces[0] / (1.0 + forces[0] / 5e-6 / on.law.stiffness_N_m))
    slipped, _ = tried(replace(on, holder=weak), lambda _: DOWN)
    assert float(np.abs(slipped.wrenches[:, 0]).max()) == pytest.approx(2e-3, rel=1e-6)
    assert slipped.unsettled == 0
