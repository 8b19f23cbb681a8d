"""A training under way: all that changes from round to round."""

import numpy as np

from learning.ddpg import Ddpg, Round, insert_once
from learning.exploration import Exploration
from learning.replay import Replay
from learning.task import Start
from learning.training.plan import Plan

_WEIGHTS, _ROUND = 2, 3
"""What random numbers are for: the second number that they are made from."""


class Trainer:
    """Plays the rounds of a plan for a seed.

    Every round has a random generator of its own, made from seed and number, so that no state of a
    generator outlives a round.
    """

    def __init__(self, plan: Plan, seed: int) -> None:
        settings = plan.settings
        self.plan = plan
        self.seed = seed
        self.task = plan.task()
        self.poses = plan.training_poses(seed)
        """(n, 5): start poses that the rounds draw from."""
        (weights,) = np.random.SeedSequence((seed, _WEIGHTS)).generate_state(1, np.uint32)
        n_states, n_actions = self.task.n_states, self.task.n_actions
        self.ddpg = Ddpg(settings.ddpg, n_states, n_actions, int(weights))
        self.replay = Replay(settings.ddpg.replay_size, n_states, n_actions)
        self.exploration = Exploration.first(settings.exploration)
        self.rounds: list[Round] = []
        """Those that were played."""

    @property
    def is_done(self) -> bool:
        """Whether all rounds were played."""
        return len(self.rounds) >= self.plan.settings.rounds

    def play(self) -> Round:
        """Play the next round."""
        rng = np.random.default_rng((self.seed, _ROUND, len(self.rounds)))
        pose = self.poses[rng.integers(len(self.poses))]
        start = Start(pose, rng.integers(2**64, dtype=np.uint64))
        played = insert_once(self.task, start, self.ddpg, self.replay, self.exploration, rng)
        self.rounds.append(played)
        return played
