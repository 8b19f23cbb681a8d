"""How far actions stray from the policy while it learns (eqs. 14 and 15)."""

from dataclasses import dataclass

import numpy as np

from learning.environments.config import Float32Array
from learning.settings import ExplorationSettings


@dataclass
class Exploration:
    """Gaussian noise on actions, wide after a failure and narrow after a success."""

    settings: ExplorationSettings
    sigma: float
    """Standard deviation in the round under way, in units of the residual's range."""

    @classmethod
    def first(cls, settings: ExplorationSettings) -> "Exploration":
        """The exploration of the first round."""
        return cls(settings, settings.sigma_first)

    def noise(self, n_actions: int, rng: np.random.Generator) -> Float32Array:
        """Draw the noise of one action (n_actions,)."""
        return np.float32(self.sigma) * rng.standard_normal(n_actions, dtype=np.float32)

    def conclude(self, succeeded: bool) -> None:
        """Set the noise of the next round by how this one ended."""
        chosen = self.settings
        self.sigma = chosen.sigma_success if succeeded else chosen.sigma_failure
