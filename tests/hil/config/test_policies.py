"""Policies that a cell names and cannot run."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from controllers.insertion import Controller
from drivers.contract.clock import ManualClock
from drivers.contract.errors import ConfigurationError
from hil.cell import Cell
from hil.config import CellConfig, load_cell
from hil.controller_factory import controller_factory
from learning.policy.expert import Approach
from learning.policy.file import save_policy
from learning.policy.inputs import Output
from learning.policy.policy import Policy
from learning.skill_controller import SkillController
from tests.hil.config.cell_files import POLICY, Load, Refuse, shipped, write
from tests.hil.config.key_table import CELL, PART
from tests.learning.policy.policies import EXPERT, random_policy, zero_policy

KEY = "config/mock_cell.yaml: controllers.skill.policy"


@pytest.mark.parametrize(
    ("name", "message"),
    [
        (
            "../policies/none.safetensors",
            "config/../policies/none.safetensors: cannot be read: No such file or directory",
        ),
        ("../policies", "config/../policies: cannot be read: Is a directory"),
        ("limits.yaml", "config/limits.yaml: is damaged or no safetensors file: "),
        ("a\0b", "'config/a\\x00b': cannot be read: embedded null byte"),
    ],
)
def test_no_policy(name: str, message: str, refuse: Refuse) -> None:
    files = shipped()
    files[CELL]["controllers"]["skill"]["policy"] = name
    assert refuse(files).startswith(f"{KEY} = {name!r} is not valid: {message}")


def test_a_damaged_policy_is_told_with_the_other_problems(tmp_path: Path) -> None:
    files = shipped()
    files[CELL]["skill"]["settle_time_ms"] = -1
    write(files, tmp_path)
    path = tmp_path / POLICY
    path.write_bytes(path.read_bytes()[:-1])
    with pytest.raises(ConfigurationError) as caught:
        load_cell(tmp_path / CELL)
    settle, policy = str(caught.value).splitlines()
    assert "skill.settle_time_ms = -1 is not valid" in settle
    assert f"controllers.skill.policy = '../{POLICY}' is not valid: {tmp_path}" in policy
    assert ": is damaged or no safetensors file: " in policy


def turning(scale_rad: float, name: str = "turn_x") -> Policy:
    policy = random_policy(answered=("step_z", name))
    return replace(policy, outputs=(policy.outputs[0], Output(name, scale_rad)))


def about(place_m: tuple[float, float, float]) -> Policy:
    """Reads torque about a place."""
    policy = random_policy(seen=("force_x", "torque_y"), answered=("step_z",))
    return replace(policy, torque_origin_m=place_m)


def made(config: CellConfig, name: str) -> Controller:
    return controller_factory(config, name, (1e-3,) * 6, np.random.default_rng(1))()


@pytest.mark.parametrize(
    ("policy", "part_box", "problem"),
    [
        (zero_policy(), None, None),
        (turning(8.7266e-4), None, None),
        (turning(math.nextafter(math.radians(0.05), 1.0)), None, None),
        (
            zero_policy(EXPERT._replace(step_box_m=(2e-5, 2.1e-5, 6e-5))),
            None,
            "its step box [20, 21, 60] um must not exceed the limit step_box_um = [20, 20, 60]",
        ),
        (
            zero_policy(),
            [20, 20, 59.9],
            "its step box [20, 20, 60] um must not exceed the limit step_box_um = [20, 20, 59.9]",
        ),
        (
            turning(8.7267e-4),
            None,
            "its turn_x of up to 0.0500003079077 deg must not exceed "
            "the limit rotation_step_limit_deg = 0.05",
        ),
        (turning(8.7266e-4, "turn_y"), None, None),
        (
            turning(math.radians(0.2), "turn_y"),
            None,
            "its turn_y of up to 0.2 deg must not exceed the limit rotation_step_limit_deg = 0.05",
        ),
        (
            random_policy(
                seen=("force_x", "turn_x", "turn_y"),
                answered=("step_z", "turn_x", "turn_y"),
                expert=EXPERT._replace(approach=Approach(2e-6, 3e-5)),
                history=8,
            ),
            None,
            None,
        ),
        (about((0.0, 0.0, 0.03992)), None, None),
        (
            about((0.0, -0.0002, 0.04)),
            None,
            "it reads torques about [0, -200, 40000] um, the sensor's are about [0, 0, 40000] um; "
            "it must be trained with the place of this sensor",
        ),
    ],
)
def test_a_policy_that_asks_for_more_than_the_limits_is_not_run(
    tmp_path: Path, policy: Policy, part_box: list[float] | None, problem: str | None
) -> None:
    files = shipped()
    if part_box:
        files[PART]["limits"]["step_box_um"] = part_box
        files[PART]["insertion"]["axial_step_um"] = 50
    write(files, tmp_path)
    save_policy(policy, tmp_path / POLICY, {})
    config = load_cell(tmp_path / CELL)
    assert made(config, "expert")
    if problem is None:
        assert isinstance(made(config, "skill"), SkillController)
        return
    with pytest.raises(ConfigurationError) as caught:
        Cell(config, "skill", ManualClock(), np.random.default_rng(1))
    assert str(caught.value) == (
        f"{tmp_path / CELL}: controllers.skill.policy = '../{POLICY}' is not valid: {problem}"
    )


def test_a_name_that_is_not_there(load: Load) -> None:
    with pytest.raises(
        ConfigurationError,
        match="controller 'ddpg' is not valid: one of expert, look_ahead, p, skill is",
    ):
        made(load(shipped()), "ddpg")
