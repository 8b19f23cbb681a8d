"""Plants one by one: as the distribution says, each from its own generator, none in part."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from learning.evaluation.plant import drawn_plants, generators_of
from simulator.checks import FloatArray
from simulator.randomisation.distributions import Uniform
from simulator.randomisation.plants import PlantDistribution, draw_plants
from simulator.randomisation.rig import (
    ArmDistribution,
    DriftDistribution,
    ModeDistribution,
    StageDistribution,
    ThermalDistribution,
)
from tests.learning.evaluation.plants import extended
from tests.simulator.randomisation.plant_batches import SIZES, arrays

STAGE = StageDistribution(SIZES, SIZES, SIZES, Uniform(0.0, 1.0), SIZES)


def rich() -> PlantDistribution:
    """With all that a trial has, and different for each plant."""
    shipped = extended()
    sensor = replace(shipped.sensor, crosstalk=Uniform(-0.02, 0.02), range=(2.0, 0.004))
    return replace(shipped, stage=STAGE, sensor=sensor, position_noise_m=Uniform(1e-7, 1e-6))


def bytes_of(value: object) -> list[tuple[str, bytes]]:
    return [(name, np.asarray(array).tobytes()) for name, array in arrays(value)]


@pytest.mark.parametrize("n", [1, 3])
def test_generator_i_alone_decides_plant_i(n: int) -> None:
    one, other = drawn_plants(rich(), n, 5), drawn_plants(rich(), 4, 5)
    for a, b in zip(one, other, strict=False):
        assert bytes_of(a) == bytes_of(b)
        assert (a.part, a.shaft, a.law) == (b.part, b.shaft, b.law)
    # No two are alike, nor are those of another seed.
    drawn = [bytes_of(p)[0] for p in (*other, *drawn_plants(rich(), 4, 6))]
    assert len(set(drawn)) == 8


def test_generators_are_independent_streams() -> None:
    first = [g.random() for g in generators_of(1, 3)]
    assert first == [g.random() for g in generators_of(1, 5)][:3]
    assert len({*first, *(g.random() for g in generators_of(2, 3))}) == 6


def test_a_plant_is_its_row_of_the_batch() -> None:
    batch, drawn = draw_plants(rich(), generators_of(7, 4)), drawn_plants(rich(), 4, 7)
    assert batch.sensor.crosstalk is not None
    for i, plant in enumerate(drawn):
        assert (plant.part, plant.shaft, plant.law) == (batch.part(i), batch.shaft(i), batch.law(i))
        pairs: list[tuple[FloatArray, FloatArray]] = [
            (plant.misalignment, batch.misalignment[i]),
            (plant.position_noise_m, batch.position_noise_m[i]),
            (plant.force_noise, batch.sensor.noise_std[i]),
            (plant.crosstalk, batch.sensor.crosstalk[i]),
            (plant.stage.minimum_step, batch.stage.minimum_step[i]),
            (plant.stage.backlash, batch.stage.backlash[i]),
            (plant.stage.repeatability, batch.stage.repeatability[i]),
            (plant.stage.hysteresis.gaps, batch.stage.hysteresis.gaps[i]),
            (plant.stage.hysteresis.weights, batch.stage.hysteresis.weights[i]),
        ]
        for one, other in pairs:
            np.testing.assert_array_equal(one, other)
            assert other.any()


def test_the_shipped_plants_in_numbers() -> None:
    drawn = drawn_plants(extended(), 50, 1)
    for plant in drawn:
        np.testing.assert_allclose(plant.force_noise[:3], 2e-3, rtol=1e-3)
        np.testing.assert_allclose(plant.force_noise[3:], 1e-5, rtol=1e-3)
        np.testing.assert_array_equal(plant.position_noise_m, 0.5e-6)
        np.testing.assert_array_equal(plant.crosstalk, np.eye(6))
        clearance = 2.0 * plant.part.wall_radii_m - 1e-3
        assert clearance[0] == clearance[1]
        assert 2e-6 <= clearance[0] <= 14e-6
        assert 2e-3 <= plant.last_mouth_m <= 3e-3
        assert plant.last_mouth_m == plant.part.wall_entries_m[1]
        assert np.hypot(*plant.misalignment[:2]) <= 10e-6
        assert np.hypot(*plant.misalignment[3:]) <= np.radians(0.3)
        assert plant.misalignment[2] == 0.0
    assert len({plant.law for plant in drawn}) == 50


REFUSED: list[tuple[str, Callable[[PlantDistribution], PlantDistribution]]] = [
    (
        "arm",
        lambda d: replace(d, arm=ArmDistribution(thermal=(ThermalDistribution(SIZES, 60.0),))),
    ),
    ("arm", lambda d: replace(d, arm=ArmDistribution(walk_density=SIZES))),
    (
        "arm",
        lambda d: replace(d, arm=ArmDistribution(modes=(ModeDistribution(SIZES, 12.0, 0.05),))),
    ),
    (
        "force_sensor.drift",
        lambda d: replace(d, sensor=replace(d.sensor, drift=DriftDistribution(SIZES, (0.01, 1.0)))),
    ),
    ("force_sensor.latency", lambda d: replace(d, sensor=replace(d.sensor, latency_s=1e-3))),
    (
        "force_sensor.resolution",
        lambda d: replace(d, sensor=replace(d.sensor, resolution=(1e-4, 1e-7))),
    ),
]


@pytest.mark.parametrize(("name", "change"), REFUSED)
def test_effects_that_a_trial_does_not_have_are_refused(
    name: str, change: Callable[[PlantDistribution], PlantDistribution]
) -> None:
    with pytest.raises(ValueError, match=rf"plants have {name}.* leave them out"):
        drawn_plants(change(extended()), 2, 1)


def test_all_refused_effects_are_named_at_once() -> None:
    distribution = extended()
    for _, change in REFUSED:
        distribution = change(distribution)
    with pytest.raises(ValueError, match=r"plants have arm .*drift.*latency.*resolution"):
        drawn_plants(distribution, 1, 1)
