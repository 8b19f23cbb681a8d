"""Admittance: the shaft gives way as a damped mass that the contact force pushes.

Mass M with damping D, at a step time T, solved exactly for a force that stands during the step:

    step[k+1] = a step[k] + (1 - a) A (F - f),   a = exp(-T D / M),   A = T / D

Along x and y no force is wanted (F = 0). Along z, F is what drives the mass at the full axial step
where nothing touches; so an axial force f_z shortens the step by A_z f_z, and a large one turns it
around. There is no stiffness: nothing is known of where the hole is, so nothing pulls back there.
"""

import math

from controllers.insertion import Controller
from controllers.messages import Move, Observation
from drivers.contract.messages import Vector3


class AdmittanceController(Controller):
    """Steps of a virtual mass; for one insertion."""

    def __init__(
        self, lateral_m_N: float, axial_m_N: float, lag_steps: float, axial_step_m: float
    ) -> None:
        """`lag_steps` is M / D in steps; the others are A, A_z and the step where nothing touches.

        The mass begins at its full axial step.
        """
        self._kept = math.exp(-1.0 / lag_steps)
        self._admittances = (lateral_m_N, lateral_m_N, axial_m_N)
        self._free: Vector3 = (0.0, 0.0, axial_step_m)
        self._step = self._free

    def step(self, observation: Observation) -> Move:
        """Return the move to propose."""
        kept, forces = self._kept, observation.wrench[:3]
        x, y, z = (
            kept * before + (1.0 - kept) * (free - admittance * force)
            for before, free, admittance, force in zip(
                self._step, self._free, self._admittances, forces, strict=True
            )
        )
        self._step = (x, y, z)
        return Move(self._step)
