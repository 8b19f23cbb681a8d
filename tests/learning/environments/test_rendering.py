"""Pictures of an environment."""

import numpy as np
import pytest
from gymnasium.error import ResetNeeded

from learning.environments import DualPegEnv, DualPegVectorEnv
from tests.learning.environments.cases import at, upright


def test_picture_is_an_image_that_changes_with_the_pose() -> None:
    env = DualPegEnv(render_mode="rgb_array")
    free = at(env, upright(0.0)).render()
    again = at(env, upright(0.0)).render()
    touching = at(env, upright(7.0)).render()
    assert isinstance(free, np.ndarray)
    assert isinstance(touching, np.ndarray)
    assert free.dtype == np.uint8
    assert free.shape == (640, 960, 3)
    np.testing.assert_array_equal(free, again)
    changed = (free != touching).any(axis=-1)
    assert 0.01 < changed.mean() < 0.5


def test_picture_shows_the_force_in_red_only_in_contact() -> None:
    """Left of the bars, whose limit lines are red."""
    env = DualPegEnv(render_mode="rgb_array")
    red = []
    for x_um in (0.0, 8.0):
        image = np.asarray(at(env, upright(x_um)).render(), dtype=int)[:, :700]
        red.append(((image[..., 0] > 170) & (image[..., 1] < 80)).sum())
    assert red[0] == 0
    assert red[1] > 100


def test_vector_environment_draws_each() -> None:
    env = DualPegVectorEnv(2, render_mode="rgb_array")
    env.reset(seed=1)
    frames = env.render()
    assert frames is not None
    assert [frame.shape for frame in frames] == [(640, 960, 3)] * 2
    assert (frames[0] != frames[1]).any()


def test_nothing_is_drawn_unless_asked_for() -> None:
    assert at(DualPegEnv(), upright(0.0)).render() is None
    with pytest.raises(ResetNeeded):
        DualPegEnv(render_mode="rgb_array").render()
    with pytest.raises(ValueError, match="render_mode is 'human'"):
        DualPegEnv(render_mode="human")
