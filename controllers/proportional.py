"""Force feedback with a fixed axial step: the paper's expert and the conventional P-controller.

Both are eq. (6) of the paper; they differ in the gain alone (lambda = 0.2 and 1).
"""

from controllers.messages import Observation
from controllers.settings import ProportionalSettings
from drivers.contract.messages import Vector3


class ProportionalController:
    """Moves sideways against the radial force, by a gain, and forward by a fixed step."""

    def __init__(self, settings: ProportionalSettings, axial_step_m: float) -> None:
        self._gain_m_N = settings.gain_factor * settings.force_jacobian_m_N
        self._axial_step_m = axial_step_m

    def step(self, observation: Observation) -> Vector3:
        """Return the translation to propose [m], frame M (eq. 6)."""
        fx, fy = observation.wrench[0], observation.wrench[1]
        return (-self._gain_m_N * fx, -self._gain_m_N * fy, self._axial_step_m)
