"""One plant out of a batch, as a trial needs it."""

from dataclasses import dataclass

import numpy as np

from simulator.checks import FloatArray
from simulator.contact import ContactLaw
from simulator.effects.hysteresis import PrandtlIshlinskii
from simulator.effects.stage import StageEffects
from simulator.engine.table import Table, tabulate
from simulator.geometry import Part, Shaft
from simulator.holder import Holder
from simulator.randomisation.distributions import Generators
from simulator.randomisation.plants import PlantDistribution, Plants, draw_plants


@dataclass(frozen=True, slots=True, eq=False)
class Plant:
    """What an insertion is tried on."""

    part: Part
    shaft: Shaft
    law: ContactLaw
    misalignment: FloatArray
    """(5,): see `Plants.misalignment`."""
    stage: StageEffects
    position_noise_m: FloatArray
    """(3,): standard deviation of the place that the stage reports."""
    force_noise: FloatArray
    """(6,): standard deviation of a reading [N, N m]."""
    crosstalk: FloatArray
    """(6, 6): response of each axis (row) to a load on each axis (column)."""
    holder: Holder
    table: Table
    """Of part and shaft, for the contact engine."""

    @property
    def last_mouth_m(self) -> float:
        """Depth of the last hole's upper rim in M."""
        return float(self.part.wall_entries_m[-1])


def drawn_plants(distribution: PlantDistribution, n: int, seed: int) -> list[Plant]:
    """`n` plants, plant i from the seed and i alone.

    Raises `ValueError` for a distribution with effects that a trial does not have: its arm stands
    still, and its sensor does not drift and is read at once.
    """
    generators = generators_of(seed, n)
    plants = draw_plants(distribution, generators)
    _refuse_effects(plants)
    return [_plant(plants, index) for index in range(n)]


def generators_of(seed: int, n: int) -> Generators:
    """`n` independent generators, generator i from the seed and i alone."""
    return [np.random.default_rng(s) for s in np.random.SeedSequence(seed).spawn(n)]


def _plant(plants: Plants, index: int) -> Plant:
    part, shaft = plants.part(index), plants.shaft(index)
    effects, hysteresis = plants.stage, plants.stage.hysteresis
    crosstalk = plants.sensor.crosstalk
    return Plant(
        part=part,
        shaft=shaft,
        law=plants.law(index),
        misalignment=plants.misalignment[index],
        stage=StageEffects(
            effects.minimum_step[index],
            effects.backlash[index],
            PrandtlIshlinskii(hysteresis.gaps[index], hysteresis.weights[index]),
            effects.repeatability[index],
        ),
        position_noise_m=plants.position_noise_m[index],
        force_noise=plants.sensor.noise_std[index],
        crosstalk=np.eye(6) if crosstalk is None else crosstalk[index],
        holder=plants.holder(index),
        table=tabulate([(part, shaft)]),
    )


def unsteady_effects(plants: Plants) -> dict[str, bool]:
    """Whether plants have each of the effects that insertions step by step do not have, by key."""
    sensor, arm = plants.sensor, plants.arm
    return {
        "arm (drift or vibration)": bool(arm.thermal or np.any(arm.walk_density) or arm.modes),
        "force_sensor.drift": bool(sensor.drift.corners_Hz),
        "force_sensor.latency": sensor.latency_samples > 0.0,
        "force_sensor.resolution": bool(np.any(sensor.resolution)),
    }


def _refuse_effects(plants: Plants) -> None:
    if names := [name for name, is_on in unsteady_effects(plants).items() if is_on]:
        raise ValueError(
            f"plants have {', '.join(names)}; a trial is quasi-static and has none of these: leave "
            "them out"
        )
