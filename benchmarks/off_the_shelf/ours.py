"""Our trainers, judged on their way as the library's algorithms are."""

from pathlib import Path

import torch

from benchmarks.off_the_shelf.quality import Recorder
from learning.batched import BatchedTrainer, load_batched
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


def train_batched(config: Path, seed: int, every: int, began: float) -> Recorder:
    """Make all steps of a batched training and judge at first and after `every` so many."""
    torch.set_num_threads(1)
    batched = load_batched(config)
    trainer = BatchedTrainer(batched, seed)
    recorder = Recorder(began)
    recorder.judge(0, policy_of(trainer.ddpg.actor, batched.plan))
    while not trainer.is_done:
        trainer.play()
        if trainer.steps % every == 0 or trainer.is_done:
            recorder.judge(trainer.replay.added, policy_of(trainer.ddpg.actor, batched.plan))
    return recorder
