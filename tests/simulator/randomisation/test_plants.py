"""Batches of plants: each environment its own, each parameter its own distribution."""

from dataclasses import replace

import numpy as np
from scipy import stats

from simulator.effects import arm, sensor, stage
from simulator.randomisation.distributions import NONE, Constant, Uniform
from simulator.randomisation.geometry import SHARP, ShaftDistribution
from simulator.randomisation.holder import HolderDistribution
from simulator.randomisation.rig import ArmDistribution, SensorDistribution, StageDistribution
from tests.simulator.randomisation.plant_batches import SEEDS, WIDE, arrays, plants


def test_a_plant_is_the_same_whatever_the_batch() -> None:
    batch = dict(arrays(plants(SEEDS)))
    differing = 0
    for i, seed in enumerate(SEEDS):
        for name, alone in arrays(plants((seed,))):
            rows = batch[name]
            if alone.ndim and alone.shape[0] == 1 and rows.shape[0] == len(SEEDS):
                np.testing.assert_array_equal(rows[i], alone[0], err_msg=name)
                differing += 1
    assert differing == 28 * len(SEEDS)


def test_every_parameter_has_its_distribution_and_none_follows_another() -> None:
    """Kolmogorov-Smirnov at 1e-6 each, and no correlation beyond five standard errors."""
    n = 3000
    drawn = plants(tuple(range(n)))
    clearance = drawn.hole_diameter_m - drawn.shaft_diameter_m[:, np.newaxis]
    crosstalk = drawn.sensor.crosstalk
    assert crosstalk is not None
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
        "tangential": (
            drawn.tangential_stiffness_N_m / drawn.stiffness_N_m,
            stats.uniform(0.7, 0.3),
        ),
        "leading": (drawn.shaft_leading_m[:, 0], stats.uniform(5e-6, 25e-6)),
        "trailing": (drawn.shaft_trailing_m[:, 1], stats.loguniform(5e-6, 2e-5)),
        "entry 1": (drawn.hole_entry_m[:, 0, 1], stats.loguniform(5e-6, 2e-5)),
        "entry 2": (drawn.hole_entry_m[:, 1, 0], stats.uniform(5e-6, 25e-6)),
        "compliance x": (drawn.holders.compliance[:, 0], stats.loguniform(5e-5, 5e-4)),
        "compliance rx": (drawn.holders.compliance[:, 3], stats.uniform(2.0, 18.0)),
        "holding force": (drawn.holders.holding_force[:, 0], stats.uniform(0.1, 0.4)),
        "holding torque": (drawn.holders.holding_force[:, 4], stats.loguniform(1e-4, 1e-3)),
        "gain": (crosstalk[:, 2, 2], stats.uniform(0.98, 0.04)),
        "crosstalk": (crosstalk[:, 1, 2], stats.uniform(-0.02, 0.04)),
        "force by torque": (crosstalk[:, 0, 5], stats.uniform(-10.0, 20.0)),
        "torque by force": (crosstalk[:, 5, 0], stats.uniform(-4e-5, 8e-5)),
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
    longer = replace(WIDE.shaft, length_m=Uniform(4e-3, 5e-3))
    narrow = replace(WIDE, stiffness_N_m=Constant(4e3), shaft=longer)
    one, other = plants(SEEDS), plants(SEEDS, narrow)
    assert other.stiffness_N_m.tolist() == [4e3] * len(SEEDS)
    np.testing.assert_array_equal(one.hole_diameter_m, other.hole_diameter_m)
    np.testing.assert_array_equal(one.arm.modes[0].rms, other.arm.modes[0].rms)


def test_what_is_switched_on_changes_nothing_else() -> None:
    """Worked edges, common clearance, crosstalk and holder take their numbers all the same."""
    off = replace(
        WIDE,
        shaft=ShaftDistribution(WIDE.shaft.diameter_m, WIDE.shaft.length_m),
        holes=tuple(replace(hole, entry=SHARP) for hole in WIDE.holes),
        sensor=replace(WIDE.sensor, crosstalk=NONE),
        holder=HolderDistribution(),
    )
    rounded = replace(off, shaft=replace(off.shaft, rounding_m=Uniform(1e-5, 2e-5)))
    alike = replace(off, common_clearance_m=Uniform(1e-5, 2e-5))
    switched = {
        ".shaft_leading_m",
        ".shaft_trailing_m",
        ".hole_entry_m",
        ".sensor.crosstalk",
        ".holders.compliance",
        ".holders.holding_force",
        ".holders.pivot_m",
    }
    for other, changed in (
        (off, switched),
        (rounded, switched | {".shaft_rounding_m"}),
        (alike, switched | {".hole_diameter_m"}),
    ):
        rest = dict(arrays(plants(SEEDS, other)))
        differing = {
            name
            for name, array in arrays(plants(SEEDS))
            if name not in rest or not np.array_equal(array, rest[name])
        }
        assert differing == changed


def test_holes_of_one_tool_are_alike() -> None:
    """The correlation of two sums that share one term is its share of the variance."""
    n = 3000
    own = Uniform(-1e-6, 1e-6)
    d = replace(
        WIDE,
        common_clearance_m=Uniform(4e-6, 12e-6),
        holes=tuple(replace(hole, clearance_m=own) for hole in WIDE.holes),
    )
    drawn = plants(tuple(range(n)), d)
    clearance = drawn.hole_diameter_m - drawn.shaft_diameter_m[:, np.newaxis]
    apart = stats.triang(0.5, -2e-6, 4e-6)
    assert stats.kstest(clearance[:, 1] - clearance[:, 0], apart.cdf).pvalue > 1e-6
    expected = 8.0**2 / (8.0**2 + 2.0**2)
    assert abs(np.corrcoef(clearance.T)[0, 1] - expected) < 5.0 * (1.0 - expected**2) / np.sqrt(n)


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
