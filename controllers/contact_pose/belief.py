"""What is believed about pose and part after an observation."""

from dataclasses import dataclass

import numpy as np

from controllers.contact_pose.hypotheses import OFFSET, TILT, Parameter
from simulator.checks import FloatArray
from simulator.states import ContactState


@dataclass(frozen=True, slots=True, eq=False)
class Belief:
    """Moments of the weighted hypotheses, and what they say of the newest observation."""

    mean: FloatArray
    """(7,): by `Parameter`."""
    covariance: FloatArray
    """(7, 7)."""
    state: ContactState
    """The most likely one now."""
    state_probability: float
    misfit: float
    """Mean squared misfit of the newest reading; about 6 where the model holds."""

    @property
    def std(self) -> FloatArray:
        """Standard deviation of each parameter, shape (7,)."""
        return np.sqrt(np.diag(self.covariance))

    @property
    def offset_m(self) -> FloatArray:
        """(2,): see `Parameter.OFFSET_X`."""
        return self.mean[OFFSET]

    @property
    def tilt_rad(self) -> FloatArray:
        """(2,): see `Parameter.TILT_X`."""
        return self.mean[TILT]

    @property
    def clearance_m(self) -> float:
        return float(self.mean[Parameter.CLEARANCE])

    @property
    def stiffness_N_m(self) -> float:
        return float(self.mean[Parameter.STIFFNESS])
