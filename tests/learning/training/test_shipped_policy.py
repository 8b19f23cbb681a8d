"""The shipped policy is what the shipped file trains, and does what the paper's skill does."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from learning.environments import DualPegConfig
from learning.environments.core import DualPegCore
from learning.policy.expert import Expert
from learning.policy.file import read_policy
from learning.policy.policy import Policy
from learning.training.checkpoint import configuration
from learning.training.evaluation import Insertions, insert_all
from learning.training.plan import load_plan
from learning.training.policy_of import policy_of
from learning.training.trainer import Trainer

PAPER = Path("config/training/paper.yaml")
ONLINE = Path("config/parts/paper_online.yaml")
SHIPPED = Path("policies/paper.safetensors")
CONVENTIONAL = Expert(gain_m_N=800e-6, axial_step_m=60e-6, step_box_m=(20e-6, 20e-6, 60e-6))


def without_residual(policy: Policy, expert: Expert) -> Policy:
    *hidden, (weight, bias) = policy.layers
    last = type(policy.layers[0])(np.zeros_like(weight), np.zeros_like(bias))
    return replace(policy, layers=(*hidden, last), expert=expert)


def online() -> DualPegConfig:
    """The part of the online experiment, with 2 mN of noise on what the sensor says."""
    return replace(load_plan(PAPER, ONLINE).environment, force_noise_N=(0.002, 0.002, 0.002))


def online_insertions(policy: Policy, n: int = 30) -> Insertions:
    poses = DualPegCore(online(), n).reset(np.uint64(11)).pose
    return insert_all(policy, online(), poses, key=12)


def test_it_was_trained_as_the_file_says() -> None:
    about = read_policy(SHIPPED).manifest.about
    assert about["configuration"] == configuration(load_plan(PAPER))
    assert about["seed"] == 1
    assert about["rounds"] == 200


def test_it_inserts_from_every_pose_with_the_forces_that_it_states() -> None:
    stored, plan = read_policy(SHIPPED), load_plan(PAPER)
    found = insert_all(stored.policy, plan.environment, plan.evaluation_poses(1)).metrics()
    assert found == pytest.approx(stored.manifest.about["metrics"], rel=1e-3)
    assert found["insertions"] == found["succeeded"] == 300
    assert found["peak_x_N"] < 0.07
    assert found["peak_y_N"] < 0.1


def test_it_inserts_the_online_part_gently_and_fast() -> None:
    insertions = online_insertions(read_policy(SHIPPED).policy)
    figures = insertions.metrics()
    assert insertions.succeeded == 30
    assert figures["steps_max"] <= 60
    assert figures["share_of_radial_forces_to_44_mN"] > 0.99


def test_its_lower_hole_peak_is_half_of_the_conventional_controllers_at_most() -> None:
    policy = read_policy(SHIPPED).policy
    skill = online_insertions(policy)
    conventional = online_insertions(without_residual(policy, CONVENTIONAL))
    highest = [i.metrics()["lower_hole_peak_max_N"] for i in (skill, conventional)]
    typical = [i.metrics()["lower_hole_peak_p95_N"] for i in (skill, conventional)]
    assert highest[0] <= 0.5 * highest[1]
    assert typical[0] <= 0.5 * typical[1]


@pytest.mark.slow
def test_training_again_leads_to_as_good_a_policy() -> None:
    """To the same bits only on the same type of processor."""
    plan = load_plan(PAPER)
    trainer = Trainer(plan, 1)
    while not trainer.is_done:
        trainer.play()
    policy = policy_of(trainer.ddpg.actor, plan)
    found = insert_all(policy, plan.environment, plan.evaluation_poses(1)).metrics()
    stored = read_policy(SHIPPED).manifest.about["metrics"]
    assert isinstance(stored, dict)
    assert found["succeeded"] == 300
    assert found["steps_mean"] == pytest.approx(stored["steps_mean"], abs=2.0)
    assert found["radial_force_mean_N"] == pytest.approx(stored["radial_force_mean_N"], abs=3e-3)
