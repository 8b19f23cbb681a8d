"""Actor and critic: fully connected networks with ReLU between their layers."""

from collections.abc import Sequence
from itertools import pairwise
from typing import Literal

import torch
from torch import Tensor, nn
from torch.nn import functional

Norm = Literal["none", "layer", "batch"]
_MOMENTUM = 0.01
"""Share by which the statistics of batches move on with each of them, as in CrossQ."""


class Network(nn.Module):
    """Linear layers of the given sizes, with ReLU between them.

    What comes to a ReLU can be normalised, over the layer or over the batch, without weights of its
    own. Over the batch, the network in training mode takes the batch's mean and variance, and in
    evaluation mode those of past batches.
    """

    def __init__(self, *sizes: int, norm: Norm = "none") -> None:
        super().__init__()
        self._norm = norm
        self.statistics: list[tuple[Tensor, Tensor]] = []
        """Mean and variance of the batches, of one hidden layer after the other."""
        for number, width in enumerate(sizes[1:-1] if norm == "batch" else ()):
            self.register_buffer(f"mean{number}", torch.zeros(width))
            self.register_buffer(f"variance{number}", torch.ones(width))
            self.statistics.append(
                (self.get_buffer(f"mean{number}"), self.get_buffer(f"variance{number}"))
            )
        self.layers = nn.ModuleList(nn.Linear(a, b) for a, b in pairwise(sizes))
        self.weights = [*self.parameters()]
        """Weight and bias of one layer after the other."""

    def through(self, values: Tensor) -> Tensor:
        """Return the answer (..., outputs) to values (..., inputs)."""
        # Calling functions spares half of the time that calling modules of this size takes.
        *hidden, (weight, bias) = zip(self.weights[0::2], self.weights[1::2], strict=True)
        for number, (inner_weight, inner_bias) in enumerate(hidden):
            values = functional.linear(values, inner_weight, inner_bias)
            if self._norm == "layer":
                values = functional.layer_norm(values, values.shape[-1:])
            elif self._norm == "batch":
                values = functional.batch_norm(
                    values, *self.statistics[number], training=self.training, momentum=_MOMENTUM
                )
            values = values.relu()
        return functional.linear(values, weight, bias)


class Actor(Network):
    """From states (..., n_states) to actions (..., n_actions) between -1 and 1.

    The last layer starts at numbers of magnitude `last_weight` at most: an untrained residual is
    next to nothing.
    """

    def __init__(
        self, n_states: int, n_actions: int, hidden: Sequence[int], last_weight: float
    ) -> None:
        super().__init__(n_states, *hidden, n_actions)
        for weight in self.weights[-2:]:
            nn.init.uniform_(weight, -last_weight, last_weight)

    def forward(self, states: Tensor) -> Tensor:
        """Return the actions."""
        return torch.tanh(self.through(states))


class Critic(nn.Module):
    """From states (n, n_states) and actions (n, n_actions) to their values (opinions, n).

    Each opinion is that of a network of its own.
    """

    def __init__(
        self,
        n_states: int,
        n_actions: int,
        hidden: Sequence[int],
        opinions: int = 1,
        norm: Norm = "none",
    ) -> None:
        super().__init__()
        sizes = (n_states + n_actions, *hidden, 1)
        self._opinions = [Network(*sizes, norm=norm) for _ in range(opinions)]
        self.networks = nn.ModuleList(self._opinions)
        self.weights = [*self.parameters()]
        """Weight and bias of one layer after the other, of one network after the other."""

    def forward(self, states: Tensor, actions: Tensor) -> Tensor:
        """Return the values."""
        both = torch.cat((states, actions), dim=1)
        values = [network.through(both).T for network in self._opinions]
        return values[0] if len(values) == 1 else torch.cat(values)

    def first(self, states: Tensor, actions: Tensor) -> Tensor:
        """Return the values (n,) in the first opinion alone."""
        return self._opinions[0].through(torch.cat((states, actions), dim=1)).squeeze(1)
