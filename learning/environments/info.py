"""What the environments tell besides the observation, in SI, and how they draw their random key."""

import numpy as np
import numpy.typing as npt

from learning.environments.core import Batch
from learning.environments.kernels import Outcome

_INSERTED = int(Outcome.INSERTED)

Info = dict[str, npt.NDArray[np.generic]]


def info_of(batch: Batch) -> Info:
    """Forces, truth and terms of the reward of n environments: arrays (n, ...), by name."""
    return {
        "force_N": batch.force_N,
        "depth_m": batch.pose[:, 2],
        "pose": batch.pose,
        "contact_state": batch.contacts.state,
        "travel_m": batch.travel_m,
        "force_x_penalty": batch.terms[:, 0],
        "force_y_penalty": batch.terms[:, 1],
        "force_reward": batch.terms[:, 2],
        "depth_penalty": batch.terms[:, 3],
        "outcome": batch.outcome,
        "is_success": batch.outcome == _INSERTED,
    }


def draw_key(generator: np.random.Generator) -> np.uint64:
    """A key for the environments' random streams, from gymnasium's seeded generator."""
    return generator.integers(2**64, dtype=np.uint64)
