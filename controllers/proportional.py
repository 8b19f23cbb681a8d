"""Force feedback with a fixed axial step: the paper's expert and the conventional P-controller.

Both are eq. (6) of the paper; they differ in the gain alone (lambda = 0.2 and 1).
"""

from controllers.insertion import Controller
from controllers.messages import Move, Observation
from controllers.settings import ProportionalSettings


class ProportionalController(Controller):
    """Moves sideways against the radial force, by a gain, and forward by a fixed step."""

    def __init__(self, settings: ProportionalSettings, axial_step_m: float) -> None:
        self._gain_m_N = settings.gain_factor * settings.force_jacobian_m_N
        self._axial_step_m = axial_step_m

    def step(self, observation: Observation) -> Move:
        """Return the move to propose (eq. 6); it turns nothing."""
        fx, fy = observation.wrench[0], observation.wrench[1]
        return Move((-self._gain_m_N * fx, -self._gain_m_N * fy, self._axial_step_m))
