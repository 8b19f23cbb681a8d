"""Environments to learn insertion in; importing this package registers them with gymnasium."""

import gymnasium

from learning.environments.config import (
    ACTION,
    OBSERVATION,
    OBSERVATION_BOUND,
    PAPER,
    PAPER_LAW,
    PAPER_PART,
    PAPER_SHAFT,
    DualPegConfig,
    RewardWeights,
)
from learning.environments.dual_peg import DualPegEnv
from learning.environments.dual_peg_vector import DualPegVectorEnv
from learning.environments.kernels import Outcome

__all__ = [
    "ACTION",
    "OBSERVATION",
    "OBSERVATION_BOUND",
    "PAPER",
    "PAPER_LAW",
    "PAPER_PART",
    "PAPER_SHAFT",
    "DualPegConfig",
    "DualPegEnv",
    "DualPegVectorEnv",
    "Outcome",
    "RewardWeights",
]

gymnasium.register(
    id="tenon/DualPeg-v0",
    entry_point="learning.environments.dual_peg:DualPegEnv",
    vector_entry_point="learning.environments.dual_peg_vector:DualPegVectorEnv",
)
