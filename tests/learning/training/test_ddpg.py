"""One update against a computation by hand: eqs. (7) to (9)."""

import numpy as np
import pytest
import torch

from learning.ddpg import Ddpg
from learning.replay import Transitions
from learning.settings import DdpgSettings

SETTINGS = DdpgSettings.model_validate(
    {
        "replay_size": 10,
        "batch_size": 2,
        "discount": 0.5,
        "target_rate": 0.25,
        "target_period": 2,
        "terminal_mask": False,
        "actor": {"hidden": (1,), "learning_rate": 0.01},
        "critic": {"hidden": (1,), "learning_rate": 0.1},
        "actor_last_weight": 0.0,
    }
)
BATCH = Transitions(
    state=torch.tensor([[1.0], [2.0]]),
    action=torch.tensor([[1.0], [-1.0]]),
    reward=torch.tensor([1.0, 2.0]),
    next_state=torch.tensor([[2.0], [3.0]]),
    terminal=torch.tensor([0.0, 1.0]),
    discount=torch.tensor([0.5, 0.5]),
)
RNG = np.random.default_rng(1)


def by_hand(**changes: object) -> Ddpg:
    """Q(s, a) = max(s + a, 0), mu(s) = tanh(max(s, 0)/2); targets: Q' = 2 (s + a), mu' = 0."""
    ddpg = Ddpg(SETTINGS.model_copy(update=changes), n_states=1, n_actions=1, seed=1)
    with torch.no_grad():
        for weights, values in (
            (ddpg.actor.weights, (1.0, 0.0, 0.5, 0.0)),
            (ddpg.target_actor.weights, (1.0, 0.0, 0.0, 0.0)),
            (ddpg.critic.weights, (1.0, 0.0, 1.0, 0.0)),
            (ddpg.target_critic.weights, (1.0, 0.0, 2.0, 0.0)),
        ):
            for weight, value in zip(weights, values, strict=True):
                weight.fill_(value)
    return ddpg


def numbers(weights: list[torch.nn.Parameter]) -> list[float]:
    return [w for weight in weights for w in weight.detach().flatten().tolist()]


def goals(ddpg: Ddpg, batch: Transitions = BATCH) -> list[float]:
    found: list[float] = ddpg.values_and_goals(batch, RNG)[1].tolist()
    return found


def test_goals() -> None:
    # y = R + 0.5 * 2 * s', with nothing that marks the end of the second.
    assert goals(by_hand()) == [3.0, 5.0]


def test_goals_with_a_mask_at_the_end() -> None:
    assert goals(by_hand(terminal_mask=True)) == [3.0, 2.0]


def test_goals_discount_each_transition_by_its_own_length() -> None:
    assert goals(by_hand(), BATCH._replace(discount=torch.tensor([0.25, 1.0]))) == [2.0, 8.0]


def test_loss_and_value() -> None:
    losses = by_hand().update(BATCH, RNG)
    # Q = 2 and 1: ((2 - 3)^2 + (1 - 5)^2)/2.
    assert losses.critic.item() == pytest.approx(8.5)


def test_first_step_of_both_networks() -> None:
    """Adam's first step is the learning rate, against the sign of the gradient."""
    ddpg = by_hand()
    ddpg.update(BATCH, RNG)
    # dL/dQ = -1 and -4, so weights and biases of the critic grow, but that of the action: its
    # gradient is -1 * 1 + -4 * -1 = 3.
    expected = [1.1, 0.9, 0.1, 1.1, 0.1]
    assert numbers(ddpg.critic.weights) == pytest.approx(expected, abs=1e-5)
    # dQ/da > 0: the actor's answer grows.
    expected = [1.01, 0.01, 0.51, 0.01]
    assert numbers(ddpg.actor.weights) == pytest.approx(expected, abs=1e-5)


def test_the_value_is_that_of_the_actors_actions() -> None:
    ddpg = by_hand()
    losses = ddpg.update(BATCH, RNG)
    state, answer = np.array([1.0, 2.0]), np.tanh([0.5, 1.0])
    hidden = 1.1 * state + 0.9 * answer + 0.1  # of the critic after its step
    assert losses.value.item() == pytest.approx((1.1 * hidden + 0.1).mean(), abs=1e-5)


def test_targets_follow_every_second_update_by_a_quarter_of_the_way() -> None:
    ddpg = by_hand()
    ddpg.update(BATCH, RNG)
    assert numbers(ddpg.target_critic.weights) == [1.0, 1.0, 0.0, 2.0, 0.0]
    ddpg.update(BATCH, RNG)
    for targets, weights, before in (
        (ddpg.target_critic.weights, ddpg.critic.weights, [1.0, 1.0, 0.0, 2.0, 0.0]),
        (ddpg.target_actor.weights, ddpg.actor.weights, [1.0, 0.0, 0.0, 0.0]),
    ):
        expected = 0.75 * np.array(before) + 0.25 * np.array(numbers(weights))
        assert numbers(targets) == pytest.approx(expected, abs=1e-6)


def test_networks_depend_on_the_seed_alone() -> None:
    torch.manual_seed(5)
    one, same, other = (Ddpg(SETTINGS, 4, 3, seed) for seed in (1, 1, 2))
    assert numbers(one.critic.weights) == numbers(same.critic.weights)
    assert numbers(one.critic.weights) != numbers(other.critic.weights)
    drawn = torch.rand(1)
    torch.manual_seed(5)
    assert torch.equal(torch.rand(1), drawn)


def test_an_untrained_residual_is_next_to_nothing() -> None:
    ddpg = Ddpg(SETTINGS.model_copy(update={"actor_last_weight": 1e-3}), 4, 3, seed=1)
    action = ddpg.act(np.ones(4, dtype=np.float32))
    assert 0.0 < np.abs(action).max() < 5e-3
    assert numbers(ddpg.target_actor.weights) == numbers(ddpg.actor.weights)
