"""The controllers that only a comparison has: admittance, tuning, and the privileged bound."""

import math
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest

from controllers.messages import Observation
from drivers.contract.messages import Pose
from learning.evaluation.admittance import AdmittanceController
from learning.evaluation.contenders import Admittance, Contender, Privileged, Proportional
from learning.evaluation.plant import Plant, drawn_plants
from learning.evaluation.privileged import PrivilegedController
from learning.evaluation.settings import AdmittanceSettings, TunedSettings
from learning.evaluation.trial import Record, Trial, TrialRules
from learning.evaluation.trials import cases_of, insert_each
from learning.evaluation.tuning import TRIED, tune
from learning.randomisation import load_randomisation
from simulator.engine.solve import solve
from tests.learning.evaluation.records import ROOT, radial_record

RULES = TrialRules()


def seen(fx: float = 0.0, fy: float = 0.0, fz: float = 0.0) -> Observation:
    pose = Pose((0.0, 0.0, 0.0))
    wrench = (fx, fy, fz, 0.0, 0.0, 0.0)
    return Observation(0, 0, wrench, (0.0,) * 6, pose, (0.0, 0.0, 0.0), pose)


def test_admittance_in_free_air_goes_straight_on() -> None:
    controller = AdmittanceController(80e-6, 300e-6, 2.0, 60e-6)
    for _ in range(3):
        assert controller.step(seen()).translation == pytest.approx((0.0, 0.0, 60e-6))


def test_admittance_by_hand() -> None:
    controller = AdmittanceController(100e-6, 200e-6, 1.0 / math.log(4.0), 60e-6)  # keeps 1/4
    first = controller.step(seen(0.1, -0.2, 0.5)).translation
    assert first == pytest.approx((-0.75 * 10e-6, 0.75 * 20e-6, 60e-6 - 0.75 * 100e-6))
    second = controller.step(seen()).translation
    assert second == pytest.approx((-0.25 * 7.5e-6, 0.25 * 15e-6, 0.25 * -15e-6 + 0.75 * 60e-6))


def valley(contenders: Sequence[Contender]) -> list[list[Record]]:
    """Least force at a gain of 47 um/N, or at lateral 47, axial 200, lag 1."""
    found = []
    for contender in contenders:
        if isinstance(contender, Proportional):
            away = abs(math.log(contender.gain_m_N / 47e-6))
        else:
            assert isinstance(contender, Admittance)
            away = (
                abs(math.log(contender.lateral_m_N / 47e-6))
                + abs(math.log(contender.axial_m_N / 200e-6))
                + abs(math.log(contender.lag_steps))
            )
        found.append([radial_record(5.0 + away), radial_record(1.0 + away)])
    return found


def test_tuning_finds_the_gain() -> None:
    tried = 0

    def judge(contenders: Sequence[Contender]) -> list[list[Record]]:
        nonlocal tried
        tried += len(contenders)
        return valley(contenders)

    settings = TunedSettings(kind="tuned", gain_um_N=(10.0, 1000.0), axial_step_um=60.0)
    best = tune(settings, judge)
    assert isinstance(best, Proportional)
    assert best.axial_step_m == 60e-6
    assert best.gain_m_N == pytest.approx(47e-6, rel=0.06)
    assert tried == TRIED["tuned"]


def test_tuning_finds_all_parameters_of_an_admittance() -> None:
    settings = AdmittanceSettings(
        kind="admittance",
        lateral_um_N=(10.0, 1000.0),
        axial_um_N=(1.0, 1000.0),
        lag_steps=(0.1, 5.0),
        axial_step_um=60.0,
    )
    best = tune(settings, valley)
    assert isinstance(best, Admittance)
    found = (best.lateral_m_N, best.axial_m_N, best.lag_steps)
    assert found == pytest.approx((47e-6, 200e-6, 1.0), rel=0.12)


def test_a_controller_that_lingers_is_not_the_best() -> None:
    def judge(contenders: Sequence[Contender]) -> list[list[Record]]:
        return [[record] for record in (_given_up(c) for c in contenders)]

    def _given_up(contender: Contender) -> Record:
        assert isinstance(contender, Proportional)
        made = radial_record(1.0 if contender.gain_m_N < 100e-6 else 9.0)
        is_inserted = contender.gain_m_N >= 100e-6
        return Record(
            made.poses, made.wrenches, made.last_mouth_m, made.force_limit_N, is_inserted, 0
        )

    settings = TunedSettings(kind="tuned", gain_um_N=(10.0, 1000.0), axial_step_um=60.0)
    best = tune(settings, judge)
    assert isinstance(best, Proportional)
    assert best.gain_m_N >= 100e-6
    narrow = TunedSettings(kind="tuned", gain_um_N=(10.0, 50.0), axial_step_um=60.0)
    with pytest.raises(ValueError, match="no values between the ends insert all training plants"):
        tune(narrow, judge)


def plants(name: str, count: int) -> list[Plant]:
    return drawn_plants(
        load_randomisation(Path(ROOT, f"config/randomisation/{name}.yaml")), count, 5
    )


def test_told_the_truth_and_free_to_turn_nothing_is_touched_hard() -> None:
    records = insert_each(Privileged(tilt=True), cases_of(plants("extended", 8), 0), RULES)
    for record in records:
        assert record.is_success
        assert np.hypot(*record.wrenches[:, :2].T).max() < 1e-3


@pytest.mark.parametrize("tilt", [False, True])
def test_no_random_move_is_gentler_than_the_privileged_one(tilt: bool) -> None:
    rng = np.random.default_rng(0)
    for plant in plants("extended", 6):
        trial = Trial(plant, RULES, np.random.default_rng(1))
        # Tilted in both holes at once: no move without a force, unless forces cancel.
        pose = np.array([2e-6, -3e-6, plant.last_mouth_m + 50e-6, 6e-3, -5e-3])
        controller = PrivilegedController(plant, RULES, lambda at=pose: at, tilt)
        move = controller.step(trial.observe())
        chosen = np.array([*move.translation, *move.rotation[:2]])
        assert (np.abs(chosen) <= [20e-6, 20e-6, 60e-6, RULES.turn_rad, RULES.turn_rad]).all()
        assert tilt or not any(move.rotation)
        others = np.zeros((3000, 5))
        others[:, :2] = rng.uniform(-20e-6, 20e-6, (3000, 2))
        others[:, 2] = move.translation[2]
        if tilt:
            others[:, 3:] = rng.uniform(-RULES.turn_rad, RULES.turn_rad, (3000, 2))
        # 10 um beside the centre is held to be worth 10 uN.
        assert force(plant, pose, chosen[np.newaxis])[0] <= force(plant, pose, others).min() + 3e-5


def force(plant: Plant, pose: np.ndarray, moves: np.ndarray) -> np.ndarray:
    found = solve(
        plant.table,
        pose + moves,
        np.ascontiguousarray(moves[:, :3]),
        stiffness_N_m=plant.law.stiffness_N_m,
        friction=plant.law.friction,
    )
    return np.asarray(np.hypot(found.wrench[:, 0], found.wrench[:, 1]))


def test_the_privileged_one_stops_at_the_stroke() -> None:
    (plant,) = plants("nominal", 1)
    trial = Trial(plant, RULES, np.random.default_rng(1))
    pose = np.array([0.0, 0.0, trial.stroke_m - 7e-6, 0.0, 0.0])
    controller = PrivilegedController(plant, RULES, lambda: pose, tilt=False)
    assert controller.step(trial.observe()).translation[2] == pytest.approx(7e-6)
