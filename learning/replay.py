"""What was lived through lately, to be drawn from at random."""

from collections import deque
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
import torch
from torch import Tensor


class Transitions(NamedTuple):
    """Rows are transitions."""

    state: Tensor
    """(n, n_states)"""
    action: Tensor
    """(n, n_actions)"""
    reward: Tensor
    """(n,): discounted sum over the steps that a transition spans."""
    next_state: Tensor
    """(n, n_states): after those steps."""
    terminal: Tensor
    """(n,): 1 where the episode ended by what happened in it, else 0; steps that ran out are 0."""
    discount: Tensor
    """(n,): what a value in the next state counts now."""


class Replay:
    """Holds the latest `capacity` transitions: a new one takes the place of the oldest."""

    def __init__(self, capacity: int, n_states: int, n_actions: int) -> None:
        self.capacity = capacity
        self.added = 0
        """Transitions added so far, also those that are gone."""
        self.rows = Transitions(
            torch.zeros(capacity, n_states),
            torch.zeros(capacity, n_actions),
            torch.zeros(capacity),
            torch.zeros(capacity, n_states),
            torch.zeros(capacity),
            torch.zeros(capacity),
        )
        self._arrays = [tensor.numpy() for tensor in self.rows]

    def __len__(self) -> int:
        return min(self.added, self.capacity)

    def add(
        self,
        state: npt.ArrayLike,
        action: npt.ArrayLike,
        reward: float,
        next_state: npt.ArrayLike,
        terminal: bool,
        discount: float,
    ) -> None:
        """Keep a transition."""
        row = self.added % self.capacity
        values = (state, action, reward, next_state, terminal, discount)
        for array, value in zip(self._arrays, values, strict=True):
            array[row] = value
        self.added += 1

    def sample(self, n: int, rng: np.random.Generator) -> Transitions:
        """Draw `n` of the transitions, each as likely every time; raises ValueError without any."""
        if self.added == 0:
            raise ValueError("the replay is empty; add a transition before drawing from it")
        rows = torch.from_numpy(rng.integers(len(self), size=n))
        return Transitions(*(tensor.index_select(0, rows) for tensor in self.rows))


@dataclass
class _Open:
    """A transition under way."""

    state: npt.ArrayLike
    action: npt.ArrayLike
    reward: float = 0.0
    discount: float = 1.0


class Returns:
    """Makes transitions over `steps` steps of the steps of an episode, and keeps them.

    The last ones of an episode span the steps that are left.
    """

    def __init__(self, replay: Replay, steps: int, discount: float) -> None:
        self._replay = replay
        self._steps = steps
        self._discount = discount
        self._open: deque[_Open] = deque()

    def add(
        self,
        state: npt.ArrayLike,
        action: npt.ArrayLike,
        reward: float,
        next_state: npt.ArrayLike,
        terminal: bool,
        ended: bool,
    ) -> None:
        """Take a step; `ended` says that it is the episode's last."""
        self._open.append(_Open(state, action))
        for each in self._open:
            each.reward += each.discount * reward
            each.discount *= self._discount
        while len(self._open) >= self._steps or (ended and self._open):
            done = self._open.popleft()
            self._replay.add(
                done.state, done.action, done.reward, next_state, terminal, done.discount
            )
