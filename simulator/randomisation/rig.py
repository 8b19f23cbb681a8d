"""Distributions of the errors of sensor, stage and arm, and batches of them drawn from these.

Each of the three axes of a force, a torque, a translation or a rotation is drawn on its own.
"""

import math
from dataclasses import dataclass, field

import numpy as np

from simulator.checks import FloatArray
from simulator.effects.arm import ArmEffects, ThermalDrift
from simulator.effects.arrays import AXES
from simulator.effects.flicker import Ladder, flicker
from simulator.effects.hysteresis import PrandtlIshlinskii
from simulator.effects.sensor import SensorEffects
from simulator.effects.stage import StageEffects
from simulator.effects.vibration import VibrationMode
from simulator.randomisation.distributions import NONE, Distribution, Generators, drawn


@dataclass(frozen=True, slots=True)
class Axes:
    """One distribution for the three linear axes, one for the three angular ones."""

    linear: Distribution = NONE
    """[N] or [m], or what the attribute says."""
    angular: Distribution = NONE
    """[N*m] or [rad], or what the attribute says."""

    def drawn(self, generators: Generators) -> FloatArray:
        """One draw per axis and environment, shape (n, 6)."""
        return np.hstack([drawn(d, 3, generators) for d in (self.linear, self.angular)])


@dataclass(frozen=True, slots=True)
class DriftDistribution:
    """1/f drift of a sensor in a band that all environments share."""

    density_at_1_Hz: Axes
    """[N/sqrt(Hz), N*m/sqrt(Hz)]"""
    band_Hz: tuple[float, float]


@dataclass(frozen=True, slots=True)
class SensorDistribution:
    """See `SensorEffects`; rate, latency, range and resolution are the same for all environments.

    Raises `ValueError` for crosstalk of a sensor without a range.
    """

    sample_rate_Hz: float
    noise_density: Axes = field(default_factory=Axes)
    """[N/sqrt(Hz), N*m/sqrt(Hz)]"""
    bias: Axes = field(default_factory=Axes)
    drift: DriftDistribution | None = None
    latency_s: float = 0.0
    crosstalk: Distribution = NONE
    """What an axis reads, as a share of its range, of a full load on another or, in excess of that
    load, on itself; drawn for each of the 36 pairs."""
    range: tuple[float, float] = (math.inf, math.inf)
    """Of each force [N] and each torque [N*m]; infinite for no end."""
    resolution: tuple[float, float] = (0.0, 0.0)
    """Of each force [N] and each torque [N*m]."""

    def __post_init__(self) -> None:
        if self.crosstalk != NONE and not math.isfinite(sum(self.range)):
            raise ValueError(
                f"SensorDistribution.range is {self.range!r}; it must be finite, for crosstalk is "
                "a share of it"
            )

    def drawn(self, generators: Generators) -> SensorEffects:
        """A batch of sensors, one per environment."""
        noise, bias = self.noise_density.drawn(generators), self.bias.drawn(generators)
        shares = drawn(self.crosstalk, AXES * AXES, generators).reshape(-1, AXES, AXES)
        drift = Ladder()
        if self.drift is not None:
            drift = flicker(self.drift.density_at_1_Hz.drawn(generators), self.drift.band_Hz)
        ends = np.repeat(self.range, 3)
        crosstalk = None
        if self.crosstalk != NONE:
            crosstalk = np.eye(AXES) + shares * ends[:, np.newaxis] / ends
        return SensorEffects(
            self.sample_rate_Hz,
            crosstalk=crosstalk,
            bias=bias,
            drift=drift,
            noise_density=noise,
            range=ends,
            resolution=np.repeat(self.resolution, 3),
            latency_samples=self.latency_s * self.sample_rate_Hz,
        )


@dataclass(frozen=True, slots=True)
class StageDistribution:
    """See `StageEffects`; the settling time constant is the same for all environments."""

    minimum_step: Axes = field(default_factory=Axes)
    backlash: Axes = field(default_factory=Axes)
    hysteresis_gap: Axes = field(default_factory=Axes)
    """Of one play operator."""
    hysteresis_weight: Distribution = NONE
    """Of that operator, from 0 to 1, drawn for each axis."""
    repeatability: Axes = field(default_factory=Axes)
    settling_time_constant_s: float = 0.0

    def drawn(self, generators: Generators) -> StageEffects:
        """A batch of stages, one per environment."""
        minimum_step, backlash = (
            axes.drawn(generators) for axes in (self.minimum_step, self.backlash)
        )
        gap = self.hysteresis_gap.drawn(generators)
        weight = drawn(self.hysteresis_weight, 6, generators)
        return StageEffects(
            minimum_step,
            backlash,
            PrandtlIshlinskii(gap[:, np.newaxis], weight[:, np.newaxis]),
            self.repeatability.drawn(generators),
            self.settling_time_constant_s,
        )


@dataclass(frozen=True, slots=True)
class ThermalDistribution:
    """Where the arm ends up, and in what time; see `ThermalDrift`."""

    end: Axes
    time_constant_s: float

    def drawn(self, generators: Generators) -> ThermalDrift:
        """The drift of each environment."""
        return ThermalDrift(self.time_constant_s, self.end.drawn(generators))


@dataclass(frozen=True, slots=True)
class ModeDistribution:
    """See `VibrationMode`; only the amplitude differs between environments."""

    rms: Axes
    frequency_Hz: float
    damping_ratio: float

    def drawn(self, generators: Generators) -> VibrationMode:
        """The mode of each environment."""
        return VibrationMode(self.frequency_Hz, self.damping_ratio, self.rms.drawn(generators))


@dataclass(frozen=True, slots=True)
class ArmDistribution:
    """See `ArmEffects`."""

    thermal: tuple[ThermalDistribution, ...] = ()
    walk_density: Axes = field(default_factory=Axes)
    """[m/sqrt(s), rad/sqrt(s)]"""
    modes: tuple[ModeDistribution, ...] = ()

    def drawn(self, generators: Generators) -> ArmEffects:
        """A batch of arms, one per environment."""
        thermal = tuple(drift.drawn(generators) for drift in self.thermal)
        walk = self.walk_density.drawn(generators)
        return ArmEffects(thermal, walk, tuple(mode.drawn(generators) for mode in self.modes))
