"""Batches of plants: each environment its own, each parameter its own distribution."""

from collections.abc import Iterator
from dataclasses import fields, is_dataclass, replace

import numpy as np
import pytest
from scipy import stats

from simulator.checks import FloatArray
from simulator.contact import ContactLaw
from simulator.effects import arm, sensor, stage
from simulator.geometry import Shaft
from simulator.randomisation.distributions import Constant, LogUniform, TruncatedNormal, Uniform
from simulator.randomisation.plants import (
    HoleDistribution,
    PlantDistribution,
    Plants,
    draw_plants,
)
from simulator.randomisation.rig import (
    ArmDistribution,
    Axes,
    DriftDistribution,
    ModeDistribution,
    SensorDistribution,
    StageDistribution,
    ThermalDistribution,
)

SIZES = Axes(Uniform(1e-7, 2e-7), LogUniform(1e-6, 1e-4))
WIDE = PlantDistribution(
    stiffness_N_m=LogUniform(2e3, 12e3),
    friction=Uniform(0.1, 0.3),
    shaft_diameter_m=TruncatedNormal(1e-3, 1e-6, 0.99e-3, 1.01e-3),
    shaft_length_m=Constant(4e-3),
    holes=(
        HoleDistribution(Uniform(-2e-6, 14e-6), Uniform(30e-6, 500e-6)),
        HoleDistribution(Uniform(2e-6, 14e-6), Constant(0.5e-3), Uniform(1.5e-3, 2.5e-3)),
    ),
    position_error_m=Constant(1e-5),
    tilt_error_rad=Constant(5e-3),
    sensor=SensorDistribution(
        1000.0, SIZES, SIZES, DriftDistribution(SIZES, (0.01, 1.0)), latency_s=2e-3
    ),
    stage=StageDistribution(SIZES, SIZES, SIZES, Uniform(0.0, 1.0), SIZES, 0.02),
    arm=ArmDistribution(
        (ThermalDistribution(SIZES, 600.0),), SIZES, (ModeDistribution(SIZES, 12.0, 0.05),)
    ),
    position_noise_m=Uniform(0.0, 1e-6),
)
SEEDS = (5, 17, 3, 8, 13, 2, 11, 7, 19)


def plants(seeds: tuple[int, ...], distribution: PlantDistribution = WIDE) -> Plants:
    return draw_plants(distribution, [np.random.default_rng(seed) for seed in seeds])


def arrays(value: object, name: str = "") -> Iterator[tuple[str, FloatArray]]:
    """Every array of a value, by its place."""
    if isinstance(value, np.ndarray):
        yield name, value
    elif isinstance(value, tuple):
        for index, item in enumerate(value):
            yield from arrays(item, f"{name}[{index}]")
    elif is_dataclass(value):
        for field in fields(value):
            yield from arrays(getattr(value, field.name), f"{name}.{field.name}")


def test_a_plant_is_the_same_whatever_the_batch() -> None:
    batch = dict(arrays(plants(SEEDS)))
    differing = 0
    for i, seed in enumerate(SEEDS):
        for name, alone in arrays(plants((seed,))):
            rows = batch[name]
            if alone.ndim and alone.shape[0] == 1 and rows.shape[0] == len(SEEDS):
                np.testing.assert_array_equal(rows[i], alone[0], err_msg=name)
                differing += 1
    assert differing == 20 * len(SEEDS)


def test_every_parameter_has_its_distribution_and_none_follows_another() -> None:
    """Kolmogorov-Smirnov at 1e-6 each, and no correlation beyond five standard errors."""
    n = 3000
    drawn = plants(tuple(range(n)))
    clearance = drawn.hole_diameter_m - drawn.shaft_diameter_m[:, np.newaxis]
    columns = {
        "stiffness": (drawn.stiffness_N_m, stats.loguniform(2e3, 12e3)),
        "friction": (drawn.friction, stats.uniform(0.1, 0.2)),
        "diameter": (drawn.shaft_diameter_m, stats.truncnorm(-10.0, 10.0, 1e-3, 1e-6)),
        "clearance 1": (clearance[:, 0], stats.uniform(-2e-6, 16e-6)),
        "clearance 2": (clearance[:, 1], stats.uniform(2e-6, 12e-6)),
        "thickness": (drawn.hole_thickness_m[:, 0], stats.uniform(30e-6, 470e-6)),
        "gap": (drawn.hole_gap_m[:, 1], stats.uniform(1.5e-3, 1e-3)),
        "noise": (drawn.position_noise_m[:, 2], stats.uniform(0.0, 1e-6)),
        "backlash": (drawn.stage.backlash[:, 1], stats.uniform(1e-7, 1e-7)),
        "bias": (drawn.sensor.bias[:, 4], stats.loguniform(1e-6, 1e-4)),
        "weight": (drawn.stage.hysteresis.weights[:, 0, 5], stats.uniform()),
        "vibration": (drawn.arm.modes[0].rms[:, 0], stats.uniform(1e-7, 1e-7)),
        "offset": (np.hypot(*drawn.misalignment[:, :2].T) ** 2, stats.uniform(0.0, 1e-10)),
        "tilt": (np.hypot(*drawn.misalignment[:, 3:].T) ** 2, stats.uniform(0.0, 25e-6)),
        "way": (np.arctan2(*drawn.misalignment[:, :2].T), stats.uniform(-np.pi, 2.0 * np.pi)),
    }
    for name, (values, reference) in columns.items():
        assert stats.kstest(values, reference.cdf).pvalue > 1e-6, name
    table = np.array([values for values, _ in columns.values()])
    assert np.abs(np.corrcoef(table) - np.eye(len(table))).max() < 5.0 / np.sqrt(n)
    np.testing.assert_array_equal(drawn.hole_gap_m[:, 0], 0.0)


def test_a_parameter_keeps_its_values_when_another_is_drawn_otherwise() -> None:
    narrow = replace(WIDE, stiffness_N_m=Constant(4e3), shaft_length_m=Uniform(4e-3, 5e-3))
    one, other = plants(SEEDS), plants(SEEDS, narrow)
    assert other.stiffness_N_m.tolist() == [4e3] * len(SEEDS)
    np.testing.assert_array_equal(one.hole_diameter_m, other.hole_diameter_m)
    np.testing.assert_array_equal(one.arm.modes[0].rms, other.arm.modes[0].rms)


def test_one_plant_of_a_batch_is_geometry_and_contact_law() -> None:
    d = replace(
        WIDE,
        friction=Constant(0.25),
        shaft_diameter_m=Constant(1e-3),
        holes=(
            HoleDistribution(Constant(1e-5), Constant(5e-4)),
            HoleDistribution(Constant(-1e-6), Constant(2e-4), Constant(1.5e-3)),
        ),
    )
    drawn = plants((1, 2), d)
    assert drawn.shaft(1) == Shaft(1e-3, 4e-3)
    first, second = drawn.part(1).holes
    assert (first.thickness_m, first.gap_m) == (5e-4, 0.0)
    assert (second.thickness_m, second.gap_m) == (2e-4, 1.5e-3)
    assert [first.diameter_m, second.diameter_m] == pytest.approx([1.01e-3, 0.999e-3], rel=1e-12)
    assert drawn.law(1) == ContactLaw(float(drawn.stiffness_N_m[1]), 0.25)


def test_the_effects_run_as_a_batch() -> None:
    drawn, n = plants(SEEDS), len(SEEDS)
    reading, _, _ = sensor.sample(
        drawn.sensor,
        np.ones((n, 6)),
        sensor.warmed_up(
            drawn.sensor, np.zeros((n, 6)), np.zeros((n, drawn.sensor.draws_at_start))
        ),
        np.zeros((n, drawn.sensor.draws_per_sample)),
    )
    np.testing.assert_array_equal(reading, drawn.sensor.bias)
    place = stage.move(
        drawn.stage,
        1e-3 * np.ones((n, 6)),
        stage.at_rest(drawn.stage, np.zeros((n, 6))),
        np.inf,
        np.zeros((n, 6)),
    )
    late = 0.5 * (
        drawn.stage.backlash + (drawn.stage.hysteresis.gaps * drawn.stage.hysteresis.weights)[:, 0]
    )
    assert (np.abs(place.position + late - 1e-3) <= 0.5 * drawn.stage.minimum_step + 1e-15).all()
    draws = np.zeros((n, drawn.arm.draws_per_step))
    moved = arm.step(drawn.arm, arm.cold(drawn.arm, np.ones((n, 2))), 1e9, draws)
    np.testing.assert_array_equal(moved.thermal[:, 0], drawn.arm.thermal[0].end)


def test_what_is_left_out_is_off() -> None:
    bare = replace(
        WIDE,
        sensor=SensorDistribution(1000.0),
        stage=StageDistribution(),
        arm=ArmDistribution(),
        position_noise_m=Constant(0.0),
    )
    drawn, n = plants((1, 2), bare), 2
    load = np.full((n, 6), 0.123456789)
    state = sensor.warmed_up(drawn.sensor, load, np.zeros((n, 0)))
    np.testing.assert_array_equal(sensor.sample(drawn.sensor, load, state, load)[0], load)
    rest = stage.at_rest(drawn.stage, np.zeros((n, 6)))
    np.testing.assert_array_equal(stage.move(drawn.stage, load, rest, 0.0, load).position, load)
    still = arm.step(drawn.arm, arm.cold(drawn.arm, np.zeros((n, 0))), 1.0, load)
    np.testing.assert_array_equal(arm.displacement(drawn.arm, still), np.zeros((n, 6)))


@pytest.mark.parametrize(
    "holes", [(), (HoleDistribution(Constant(1e-5), Constant(1e-3), Constant(1e-3)),)]
)
def test_the_first_hole_has_no_gap(holes: tuple[HoleDistribution, ...]) -> None:
    with pytest.raises(ValueError, match=r"PlantDistribution.holes is .* the first without a gap"):
        replace(WIDE, holes=holes)


def test_a_plant_that_cannot_be_is_refused() -> None:
    broken = replace(WIDE, stage=StageDistribution(backlash=Axes(Constant(-1.0))))
    with pytest.raises(ValueError, match=r"StageEffects.backlash is -1.0"):
        plants((1,), broken)
