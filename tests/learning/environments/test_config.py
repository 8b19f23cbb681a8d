"""Settings: the paper's values by default, and what is refused."""

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from hil.config import load_cell
from learning.environments import PAPER, DualPegConfig, DualPegVectorEnv, RewardWeights
from simulator.contact import ContactLaw
from simulator.geometry import Hole, Part, Shaft

CONFIG = Path(__file__).parents[3] / "config"


def test_defaults_are_those_of_the_part_file() -> None:
    part = load_cell(CONFIG / "mock_cell.yaml", CONFIG / "parts" / "paper_simulation.yaml").part
    assert PAPER.shaft == Shaft(part.shaft.diameter_m, part.shaft.length_m)
    assert PAPER.part == Part(
        tuple(Hole(hole.diameter_m, hole.thickness_m, hole.gap_m) for hole in part.holes)
    )
    assert PAPER.law == ContactLaw(part.contact.stiffness_N_m, part.contact.friction)
    assert PAPER.position_error_m == part.alignment.position_error_m
    assert PAPER.tilt_error_rad == pytest.approx(part.alignment.tilt_error_rad)
    assert PAPER.stroke_m == part.insertion.stroke_m
    assert PAPER.steps_max == part.insertion.steps_max


def test_defaults_are_those_of_the_paper() -> None:
    assert PAPER.step_box_m == (20e-6, 20e-6, 60e-6)
    assert PAPER.force_limit_N == (0.07, 0.1, 1.0)
    assert (PAPER.reward.alpha_x, PAPER.reward.alpha_y, PAPER.reward.omega) == (0.7, 0.3, 2.0)


def test_action_and_observation_are_turned_into_si_and_back() -> None:
    action = PAPER.action([[10e-6, -20e-6, 30e-6], [80e-6, 0.0, -80e-6]])
    np.testing.assert_allclose(action, [[0.5, -1.0, 0.5], [1.0, 0.0, -1.0]], rtol=1e-6)
    assert action.dtype == np.float32
    observation = np.array([1.0, 0.5, -0.1, 0.5])
    np.testing.assert_allclose(PAPER.force_N(observation), [0.07, 0.05, -0.1])
    assert PAPER.depth_m(observation) == pytest.approx(1.15e-3)


@pytest.mark.parametrize(
    ("setting", "named"),
    [
        ({"step_box_m": (0.0, 1e-6, 1e-6)}, r"step_box_m \(x\)"),
        ({"force_limit_N": (0.1, math.nan, 1.0)}, r"force_limit_N \(y\)"),
        ({"force_noise_N": (0.0, 0.0, -1.0)}, r"force_noise_N \(z\)"),
        ({"stroke_m": math.inf}, "stroke_m"),
        ({"start_depth_m": 2.3e-3}, "start_depth_m"),
        ({"start_depth_m": math.nan}, "start_depth_m"),
        ({"position_error_m": -1.0}, "position_error_m"),
        ({"tilt_error_rad": 1.6}, "tilt_error_rad"),
        ({"depth_noise_m": math.nan}, "depth_noise_m"),
        ({"steps_max": 0}, "steps_max"),
    ],
)
def test_bad_setting_is_refused_by_name(setting: dict[str, Any], named: str) -> None:
    with pytest.raises(ValueError, match=rf"DualPegConfig\.{named} is"):
        DualPegConfig(**setting)


@pytest.mark.parametrize(
    ("setting", "named"),
    [
        ({"alpha_x": 0.5}, "alpha_x and alpha_y add up to 0.8"),
        ({"alpha_x": 1.2, "alpha_y": -0.2}, "alpha_y is"),
        ({"omega": 1.0}, "omega is"),
    ],
)
def test_bad_weight_is_refused_by_name(setting: dict[str, Any], named: str) -> None:
    with pytest.raises(ValueError, match=named):
        RewardWeights(**setting)


def test_number_of_environments_below_one_is_refused() -> None:
    with pytest.raises(ValueError, match="number of environments is 0"):
        DualPegVectorEnv(0)
