"""Observation and action space of one environment."""

import numpy as np
from gymnasium.spaces import Box

from learning.environments.config import ACTION, OBSERVATION, OBSERVATION_BOUND


def observation_space() -> Box[np.float32]:
    """Components as in `OBSERVATION`, all normalised."""
    return Box(-OBSERVATION_BOUND, OBSERVATION_BOUND, (len(OBSERVATION),), np.float32)


def action_space() -> Box[np.float32]:
    """Components as in `ACTION`, all normalised."""
    return Box(-1.0, 1.0, (len(ACTION),), np.float32)
