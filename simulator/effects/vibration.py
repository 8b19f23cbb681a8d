"""One mode of vibration: a damped oscillator that white noise keeps moving."""

import math
from dataclasses import dataclass

import numpy as np

from simulator.checks import FloatArray, positive
from simulator.effects.arrays import axis_values


@dataclass(frozen=True, slots=True, eq=False)
class VibrationMode:
    """The mode q'' + 2 zeta w q' + w^2 q = white noise, with w = 2 pi `frequency_Hz`.

    `damping_ratio` zeta lies inside (0, 1). `rms`, shape (..., 6) [m, rad] in M, is the amplitude
    times the direction: the axes move in phase, against each other where the signs differ. The
    spectrum of the displacement peaks at the frequency times sqrt(1 - 2 zeta^2), while zeta^2 is
    below 1/2. Raises `ValueError` for anything else.
    """

    frequency_Hz: float
    damping_ratio: float
    rms: FloatArray

    def __post_init__(self) -> None:
        positive("VibrationMode.frequency_Hz", self.frequency_Hz)
        if not 0.0 < self.damping_ratio < 1.0:
            raise ValueError(
                f"VibrationMode.damping_ratio is {self.damping_ratio!r}; "
                "it must lie inside (0, 1), the ends excluded"
            )
        object.__setattr__(self, "rms", axis_values("VibrationMode.rms", self.rms))

    def steps(self, state: FloatArray, dt_s: float, draws: FloatArray) -> FloatArray:
        """The state after each of T steps of `dt_s`, shape (T, ..., 2), exact for any time step.

        `state` has shape (..., 2), `draws` (T, ..., 2). The state is q and q'/w, scaled so that
        both are independent and of unit variance in the long run: standard normal draws are a state
        that the mode has when it has been running for long. The exact discretisation of a linear
        stochastic differential equation: transition F = exp(A dt), and a covariance of what the
        noise adds of I - F F^T, here in closed form without the cancellation.
        """
        zeta = self.damping_ratio
        turn = 2.0 * math.pi * self.frequency_Hz * dt_s
        root = math.sqrt(1.0 - zeta * zeta)
        decay = math.exp(-zeta * turn)
        sine, cosine = decay * math.sin(root * turn) / root, decay * math.cos(root * turn)
        q_from_q, v_from_v = cosine + zeta * sine, cosine - zeta * sine

        lost = -math.expm1(-2.0 * zeta * turn)
        v_kick = math.sqrt(lost + 2.0 * zeta * sine * v_from_v)
        shared_kick = 2.0 * zeta * sine * sine / v_kick
        q_variance = lost - 2.0 * zeta * sine * q_from_q
        q_kick = math.sqrt(max(0.0, q_variance - shared_kick * shared_kick))

        kicks = np.array([q_kick, 0.0]) * draws[..., ::-1]
        kicks += np.array([shared_kick, v_kick]) * draws[..., :1]
        own, other = np.array([q_from_q, v_from_v]), np.array([sine, -sine])
        path = np.empty_like(kicks)
        for k, kick in enumerate(kicks):
            state = own * state + other * state[..., ::-1] + kick
            path[k] = state
        return path
