"""What the settings add to Algorithm 1, against computations by hand."""

from pathlib import Path

import numpy as np
import pytest
import torch

from learning.ddpg import Ddpg
from learning.networks import Critic, Norm
from learning.replay import Transitions
from learning.settings import NO_ADDITIONS
from learning.training.checkpoint import configuration, read_checkpoint, write_checkpoint
from learning.training.plan import Plan
from learning.training.trainer import Trainer
from tests.learning.training.plans import played, short_plan
from tests.learning.training.test_ddpg import BATCH, SETTINGS, numbers


def with_additions(**additions: object) -> Ddpg:
    """Random networks for one state and one action."""
    added = NO_ADDITIONS.model_copy(update=additions)
    settings = SETTINGS.model_copy(update={"additions": added, "actor_last_weight": 1.0})
    return Ddpg(settings, n_states=1, n_actions=1, seed=4)


def rng() -> np.random.Generator:
    return np.random.default_rng(1)


def set_last(critic: Critic, biases: tuple[float, float]) -> None:
    """Give each of two networks a constant as its answer."""
    with torch.no_grad():
        for number, bias in enumerate(biases):
            *_, weight, last = critic.weights[4 * number : 4 * number + 4]
            weight.zero_()
            last.fill_(bias)


def test_goals_take_the_smaller_value_of_the_twins() -> None:
    for values in ((2.0, -6.0), (-6.0, 2.0)):
        ddpg = with_additions(twin_critics=True)
        set_last(ddpg.target_critic, values)
        set_last(ddpg.critic, (5.0, 9.0))
        found, goals = ddpg.values_and_goals(BATCH, rng())
        assert goals.tolist() == [1.0 - 3.0, 2.0 - 3.0]  # R + 0.5 * -6
        assert found.tolist() == [[5.0, 5.0], [9.0, 9.0]]


def test_the_smaller_value_is_chosen_for_each_transition() -> None:
    ddpg = with_additions(twin_critics=True)
    then = torch.tensor([[2.0, -4.0], [-2.0, 4.0]])
    assert ddpg.goals(BATCH, then).tolist() == [0.0, 0.0]


def test_twins_start_apart_and_both_learn() -> None:
    ddpg = with_additions(twin_critics=True)
    assert len(ddpg.critic.weights) == 8
    assert not torch.equal(ddpg.critic.weights[0], ddpg.critic.weights[4])
    before = [weight.detach().clone() for weight in ddpg.critic.weights]
    losses = ddpg.update(BATCH, rng())
    assert torch.isfinite(losses.critic)
    for number in (0, 1):
        pairs = zip(before, ddpg.critic.weights, strict=True)
        changed = [not torch.equal(a, b) for a, b in pairs]
        assert any(changed[4 * number : 4 * number + 4])


def test_the_actor_climbs_the_first_twin() -> None:
    ddpg = with_additions(twin_critics=True)
    set_last(ddpg.critic, (1.0, 50.0))
    assert ddpg.update(BATCH, rng()).value.item() == pytest.approx(1.0, abs=0.5)


def hidden_of(norm: Norm) -> tuple[Critic, torch.Tensor]:
    """A critic of two hidden units whose answer is their sum, and what comes to the units."""
    critic = Critic(1, 1, (2,), norm=norm)
    weights = (
        torch.tensor([[1.0, 0.0], [0.0, 3.0]]),
        torch.zeros(2),
        torch.ones(1, 2),
        torch.zeros(1),
    )
    with torch.no_grad():
        for weight, value in zip(critic.weights, weights, strict=True):
            weight.copy_(value)
    return critic, torch.stack((BATCH.state[:, 0], 3.0 * BATCH.action[:, 0]), dim=1)


def test_a_layer_is_normalised_ahead_of_its_relu() -> None:
    critic, hidden = hidden_of("layer")
    scaled = hidden - hidden.mean(1, keepdim=True)
    scaled = scaled / (scaled.square().mean(1, keepdim=True) + 1e-5).sqrt()
    expected = scaled.relu().sum(1).tolist()
    assert critic(BATCH.state, BATCH.action)[0].tolist() == pytest.approx(expected)
    plain, _ = hidden_of("none")
    assert plain(BATCH.state, BATCH.action)[0].tolist() == hidden.relu().sum(1).tolist()


def test_a_batch_is_normalised_by_itself_while_learning_and_by_the_past_otherwise() -> None:
    critic, hidden = hidden_of("batch")
    critic.eval()
    before = critic(BATCH.state, BATCH.action)[0]  # nothing passed yet: mean 0, variance 1
    assert before.tolist() == pytest.approx(hidden.relu().sum(1).tolist(), rel=1e-4)
    critic.train()
    scaled = (hidden - hidden.mean(0)) / (hidden.var(0, correction=0) + 1e-5).sqrt()
    answer = critic(BATCH.state, BATCH.action)[0]
    assert answer.tolist() == pytest.approx(scaled.relu().sum(1).tolist(), rel=1e-4)
    critic.eval()
    past = (hidden - 0.01 * hidden.mean(0)) / (0.99 + 0.01 * hidden.var(0)).sqrt()
    answer = critic(BATCH.state, BATCH.action)[0]
    assert answer.tolist() == pytest.approx(past.relu().sum(1).tolist(), rel=1e-4)


def test_with_batches_a_batch_and_what_followed_pass_together_and_without_targets() -> None:
    ddpg = with_additions(critic_norm="batch")
    with torch.no_grad():
        for weight in (*ddpg.target_actor.weights, *ddpg.target_critic.weights):
            weight.fill_(torch.nan)
    values, goals = ddpg.values_and_goals(BATCH, rng())
    states = torch.cat((BATCH.state, BATCH.next_state))
    actions = torch.cat((BATCH.action, ddpg.actor(BATCH.next_state)))
    together = ddpg.critic(states, actions)[0]
    assert values[0].tolist() == pytest.approx(together[:2].tolist())
    assert goals.tolist() == pytest.approx((BATCH.reward + 0.5 * together[2:]).tolist())
    assert not goals.requires_grad


def test_the_actor_learns_from_the_past_of_batches() -> None:
    ddpg = with_additions(critic_norm="batch")
    seen = ddpg.critic.state_dict()
    ddpg.update(BATCH, rng())
    after = [t.clone() for t in seen.values()]
    with torch.no_grad():
        ddpg.critic(BATCH.state, ddpg.actor(BATCH.state))
    assert all(torch.equal(a, b) for a, b in zip(after, seen.values(), strict=True))


def test_noise_on_the_goals_action_is_cut_and_stays_in_range() -> None:
    """The critic's value is its action: 1000 goals show the actions that they are of."""
    ddpg = with_additions(target_noise=0.2)
    n = 1000
    with torch.no_grad():
        # mu' = 0.75; Q' = max(a + 4, 0) - 4 = a
        for weights, values in (
            (ddpg.target_actor.weights, (0.0, 0.0, 0.0, float(np.arctanh(0.75)))),
            (ddpg.target_critic.weights[1:], (4.0, 1.0, -4.0)),
        ):
            for weight, value in zip(weights, values, strict=True):
                weight.fill_(value)
        ddpg.target_critic.weights[0].copy_(torch.tensor([[0.0, 1.0]]))
    zeros = torch.zeros(n)
    batch = Transitions(zeros[:, None], zeros[:, None], zeros, zeros[:, None], zeros, zeros + 1.0)
    actions = ddpg.values_and_goals(batch, rng())[1].numpy()
    assert actions.max() == 1.0
    assert actions.min() == pytest.approx(0.75 - 2.5 * 0.2, abs=1e-6)
    inside = actions[actions < 0.75]
    assert np.sqrt(np.mean((inside - 0.75) ** 2)) == pytest.approx(0.2, rel=0.1)


def test_without_noise_no_random_number_is_drawn() -> None:
    generator = rng()
    with_additions().update(BATCH, generator)
    assert generator.random() == rng().random()


def test_the_actor_moves_at_every_third_update() -> None:
    ddpg = with_additions(actor_period=3)
    moved = []
    for _ in range(6):
        before = numbers(ddpg.actor.weights)
        ddpg.update(BATCH, rng())
        moved.append(numbers(ddpg.actor.weights) != before)
    assert moved == [False, False, True, False, False, True]


def everything(folder: Path) -> Plan:
    """A plan with all additions at once."""
    plan = short_plan(folder)
    additions = type(NO_ADDITIONS)(
        twin_critics=True, critic_norm="batch", return_steps=3, target_noise=0.2, actor_period=2
    )
    ddpg = plan.settings.ddpg.model_copy(update={"additions": additions})
    settings = plan.settings.model_copy(update={"ddpg": ddpg})
    return Plan(settings, plan.part, plan.sources)


def test_a_training_with_all_of_them_goes_on_as_if_it_had_never_stopped(tmp_path: Path) -> None:
    plan = everything(tmp_path)
    first, stopped, last = (tmp_path / name for name in ("first", "stopped", "last"))
    trainer = played(plan, seed=1, rounds=2)
    write_checkpoint(trainer, stopped)
    trainer.play()
    write_checkpoint(trainer, first)
    resumed = Trainer(plan, 1)
    read_checkpoint(resumed, stopped)
    resumed.play()
    write_checkpoint(resumed, last)
    assert first.read_bytes() == last.read_bytes()


def test_three_step_returns_reach_the_replay(tmp_path: Path) -> None:
    trainer = played(everything(tmp_path), seed=1, rounds=1)
    discounts = trainer.replay.rows.discount[: len(trainer.replay)].numpy()
    assert len(discounts) == trainer.rounds[0].steps
    assert discounts[:-2] == pytest.approx(0.99**3)
    assert discounts[-2:] == pytest.approx([0.99**2, 0.99])


def test_additions_are_part_of_the_configuration_where_there_are_any(tmp_path: Path) -> None:
    def ddpg(plan: Plan) -> object:
        training = configuration(plan)["training"]
        assert isinstance(training, dict)
        return training["ddpg"]

    with_all, without = ddpg(everything(tmp_path)), ddpg(short_plan(tmp_path))
    assert isinstance(with_all, dict)
    assert isinstance(without, dict)
    assert with_all["additions"]["return_steps"] == 3  # type: ignore[index,call-overload]
    assert "additions" not in without
