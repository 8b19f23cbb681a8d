import numpy as np
import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st

from learning.replay import Replay, Returns


def filled(capacity: int, n: int) -> Replay:
    replay = Replay(capacity, 2, 1)
    for i in range(n):
        replay.add([i, -i], [10 * i], i / 2, [i + 1, -i - 1], i % 3 == 0, i / 100)
    return replay


@given(st.integers(1, 9), st.integers(0, 40))
def test_holds_the_latest(capacity: int, n: int) -> None:
    replay = filled(capacity, n)
    assert len(replay) == min(n, capacity)
    held = sorted(replay.rows.state[: len(replay), 0].tolist())
    assert held == list(range(max(0, n - capacity), n))


def test_a_transition_stays_together() -> None:
    replay = filled(5, 13)
    batch = replay.sample(50, np.random.default_rng(1))
    i = batch.state[:, 0]
    assert torch.equal(batch.state[:, 1], -i)
    assert torch.equal(batch.action[:, 0], 10 * i)
    assert torch.equal(batch.reward, i / 2)
    assert torch.equal(batch.next_state, torch.stack((i + 1, -i - 1), dim=1))
    assert torch.equal(batch.terminal, (i % 3 == 0).float())
    assert batch.discount.numpy() == pytest.approx(i.numpy() / 100)


def test_draws_each_as_often() -> None:
    counts = np.bincount(
        filled(4, 4).sample(4000, np.random.default_rng(1)).state[:, 0].long(), minlength=4
    )
    # 1000 each; four standard deviations are 110.
    assert (abs(counts - 1000) < 110).all()


def test_draws_from_what_was_added_alone() -> None:
    batch = filled(100, 3).sample(200, np.random.default_rng(1))
    assert set(batch.next_state[:, 0].tolist()) == {1.0, 2.0, 3.0}


def test_a_drawn_batch_does_not_change_with_the_replay() -> None:
    replay = filled(2, 2)
    batch = replay.sample(8, np.random.default_rng(1))
    before = batch.state.clone()
    replay.add([7, 7], [7], 7, [7, 7], True, 1.0)
    assert torch.equal(batch.state, before)


def test_nothing_to_draw_from() -> None:
    with pytest.raises(ValueError, match="the replay is empty"):
        Replay(5, 2, 1).sample(1, np.random.default_rng(1))


def lived_through(steps: int, episodes: tuple[tuple[float, ...], ...]) -> list[tuple[float, ...]]:
    """The transitions (state, action, reward, next state, terminal, discount) that episodes make.

    The episode's rewards are given; its state is 10 times its number plus the step's. The first
    episode ends by what happened in it, the others because steps run out. The discount is 0.5.
    """
    replay = Replay(20, 1, 1)
    for number, rewards in enumerate(episodes):
        returns = Returns(replay, steps, 0.5)
        for step, reward in enumerate(rewards):
            state, ended = 10 * number + step, step == len(rewards) - 1
            returns.add([state], [-state], reward, [state + 1], ended and number == 0, ended)
    n = len(replay)
    columns = [tensor[:n].flatten().tolist() for tensor in replay.rows]
    return list(zip(*columns, strict=True))


def test_returns_over_one_step_are_the_steps() -> None:
    assert lived_through(1, ((1.0, 2.0), (4.0,))) == [
        (0, 0, 1.0, 1, 0, 0.5),
        (1, -1, 2.0, 2, 1, 0.5),
        (10, -10, 4.0, 11, 0, 0.5),
    ]


def test_returns_over_three_steps_and_what_is_left_of_an_episode() -> None:
    assert lived_through(3, ((1.0, 2.0, 4.0, 8.0), (16.0, 32.0))) == [
        (0, 0, 3.0, 3, 0, 0.125),  # 1 + 2/2 + 4/4
        (1, -1, 6.0, 4, 1, 0.125),  # 2 + 4/2 + 8/4: reaches the end
        (2, -2, 8.0, 4, 1, 0.25),  # 4 + 8/2
        (3, -3, 8.0, 4, 1, 0.5),
        (10, -10, 32.0, 12, 0, 0.25),  # 16 + 32/2: shorter than three steps
        (11, -11, 32.0, 12, 0, 0.5),
    ]
