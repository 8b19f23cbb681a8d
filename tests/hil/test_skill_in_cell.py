"""The cell led by a trained policy."""

import hashlib
import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from controllers.control_loop import Subscriber
from controllers.messages import Sent, Severity, SkillPhase
from drivers.contract.clock import ManualClock
from drivers.contract.messages import Pose
from hil.cell import Cell
from hil.config import CellConfig, load_cell
from hil.config.load import PolicyConfig
from hil.log_file import LogFile
from hil.log_reader import read_log
from hil.metadata import metadata
from hil.recorder import Recorder
from learning.policy.file import read_policy, save_policy
from learning.policy.policy import Policy
from tests.hil.watched_cell import make_cell
from tests.learning.policy.policies import EXPERT, random_policy, zero_policy

CONFIG = Path(__file__).parents[2] / "config"


def with_policy(policy: Policy, folder: Path) -> CellConfig:
    """The mock cell, whose controller `skill` runs `policy`."""
    path = folder / "trained.safetensors"
    save_policy(policy, path, {"seed": 7})
    config = load_cell(CONFIG / "mock_cell.yaml")
    choice = PolicyConfig(path.name, path, read_policy(path))
    return replace(config, controllers={**config.controllers, "skill": choice})


class Targets(Subscriber):
    """Keeps where the stage was sent."""

    def __init__(self) -> None:
        self.targets: list[Pose | None] = []

    def on_sent(self, sent: Sent) -> None:
        self.targets.append(sent.target)


def targets(config: CellConfig, controller: str, parts: int) -> list[Pose | None]:
    cell = Cell(config, controller, ManualClock(), np.random.default_rng(1))
    noted = Targets()
    cell.follow(noted)
    cell.connect()
    outcomes = [cell.insert_part(number) for number in range(1, parts + 1)]
    assert [o.phase for o in outcomes] == [SkillPhase.DONE] * parts
    return noted.targets


@pytest.mark.slow
def test_without_a_residual_the_run_is_the_experts(tmp_path: Path) -> None:
    config = with_policy(zero_policy(EXPERT._replace(axial_step_m=60e-6)), tmp_path)
    assert targets(config, "skill", 2) == targets(config, "expert", 2)


@pytest.mark.slow
def test_a_residual_changes_the_run(tmp_path: Path) -> None:
    config = with_policy(zero_policy(EXPERT._replace(axial_step_m=50e-6)), tmp_path)
    assert targets(config, "skill", 1) != targets(config, "expert", 1)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(3))
def test_whatever_a_policy_has_learned_the_force_limits_hold(tmp_path: Path, seed: int) -> None:
    """A policy of random weights is stopped, or ends its run, within one sample of the limits."""
    answered = ("step_x", "step_y", "step_z", "turn_x", "turn_y")
    config = with_policy(random_policy(seed, answered=answered), tmp_path)
    path = tmp_path / "run.mcap"
    recorder = Recorder(LogFile(path, metadata(config, "skill", 1, seed, real_time=False)))
    cell = Cell(config, "skill", ManualClock(), np.random.default_rng(seed))
    cell.follow(recorder)
    cell.connect()
    cell.insert_part(1)
    recorder.close()
    log = read_log(path)
    force = log.trace(log.insertions[0]).wrench[:, :3]
    growth = np.abs(np.diff(force, axis=0)).max(axis=0)
    assert (np.abs(force).max(axis=0) <= np.array([0.070, 0.100, 1.000]) + growth).all()
    tilt = [np.hypot.reduce(seen.pose.rotation) for seen in log.observations]
    assert max(tilt) <= np.radians(0.6) + 1e-9


def test_the_log_says_which_policy_ran(tmp_path: Path) -> None:
    config = with_policy(random_policy(), tmp_path)
    record = metadata(config, "skill", 1, 1, real_time=False)["policy"]
    content = (tmp_path / "trained.safetensors").read_bytes()
    assert record["name"] == "trained"
    assert record["file"] == str(tmp_path / "trained.safetensors")
    assert record["sha256"] == hashlib.sha256(content).hexdigest()
    assert json.loads(record["manifest"])["about"] == {"seed": 7}
    assert "policy" not in metadata(config, "expert", 1, 1, real_time=False)


@pytest.mark.slow
@pytest.mark.parametrize(("part", "steps"), [("paper_online", 66), ("paper_simulation", 52)])
def test_the_extended_skill_inserts_gently(part: str, steps: int) -> None:
    """Though this cell's stage and sensor have errors that it was not trained with."""
    cell, watcher, _ = make_cell("extended", part=part)
    outcomes = [cell.insert_part(number) for number in range(1, 6)]
    assert [o.phase for o in outcomes] == [SkillPhase.DONE] * 5
    assert all(o.steps <= steps for o in outcomes)
    inside = watcher.force[np.array(watcher.depths) > 0.0]
    assert np.abs(inside).max() < 0.044
    assert max(watcher.severities) < Severity.HOLD
