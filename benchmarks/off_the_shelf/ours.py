"""Our trainers, judged on their way as the library's algorithms are."""

from dataclasses import replace
from pathlib import Path

import torch

from benchmarks.off_the_shelf.quality import Recorder
from benchmarks.off_the_shelf.runs import DIRECT
from learning.analytic.plan import AnalyticPlan, load_analytic
from learning.analytic.trainer import AnalyticTrainer
from learning.policy.expert import Expert
from learning.training.plan import load_plan
from learning.training.policy_of import policy_of
from learning.training.trainer import Trainer


def train_paper(config: Path, seed: int, every: int, began: float) -> Recorder:
    """Play all rounds of a training and judge the policy at first and after `every` so many."""
    torch.set_num_threads(1)
    plan = load_plan(config)
    trainer = Trainer(plan, seed)
    recorder = Recorder(began)
    recorder.judge(0, policy_of(trainer.ddpg.actor, plan))
    while not trainer.is_done:
        trainer.play()
        if len(trainer.rounds) % every == 0 or trainer.is_done:
            steps = sum(r.steps for r in trainer.rounds)
            recorder.judge(steps, policy_of(trainer.ddpg.actor, plan))
    return recorder


def train_analytic(config: Path, formulation: str, seed: int, every: int, began: float) -> Recorder:
    """Make all updates of an analytic training and judge at first and after `every` so many."""
    torch.set_num_threads(1)
    plan = load_analytic(config)
    if formulation == DIRECT:
        plan = without_expert(plan)
    trainer = AnalyticTrainer(plan, seed)
    recorder = Recorder(began)
    recorder.judge(0, trainer.policy())
    while not trainer.is_done:
        trainer.update()
        if len(trainer.updates) % every == 0 or trainer.is_done:
            recorder.judge(trainer.steps, trainer.policy())
    return recorder


def without_expert(plan: AnalyticPlan) -> AnalyticPlan:
    """Return the plan with a policy whose answer is the whole step."""
    box_m = plan.settings.trial.step_box_m
    residual = plan.settings.residual.model_copy(update={"range_m": box_m})
    settings = plan.settings.model_copy(update={"residual": residual})
    return replace(plan, settings=settings, expert=Expert(0.0, 0.0, box_m))
