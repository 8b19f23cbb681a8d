"""Files that are taken: units, what is left out, the shipped ones, and the reference."""

import math
import re
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import get_args, get_origin

import numpy as np
import pytest
from pydantic import BaseModel

from learning.randomisation import load_randomisation
from learning.randomisation.distribution import DistributionSettings
from learning.randomisation.plant import PlantSettings
from simulator.randomisation.distributions import (
    Choice,
    Constant,
    Distribution,
    LogUniform,
    TruncatedNormal,
    Uniform,
)
from simulator.randomisation.plants import HoleDistribution, PlantDistribution, draw_plants
from simulator.randomisation.rig import (
    ArmDistribution,
    Axes,
    DriftDistribution,
    ModeDistribution,
    SensorDistribution,
    StageDistribution,
    ThermalDistribution,
)
from tests.hil.config.cell_files import ROOT
from tests.learning.randomisation.plant_files import NUMBERS, SPREADS, Load, drop, full, put

SHIPPED = ROOT / "config" / "randomisation"
HALF_UM, HALF_DEG = Constant(5e-7), Constant(math.pi / 360.0)
HALF = Axes(HALF_UM, HALF_DEG)


def test_every_key_arrives_in_si_units_where_it_belongs(load: Load) -> None:
    """Of a file in which nearly every number is a half, in the unit of its key."""
    drift = ThermalDistribution(HALF, 0.5)
    mode = ModeDistribution(HALF, 0.5, 0.5)
    assert load(full()) == PlantDistribution(
        stiffness_N_m=Constant(500.0),
        friction=Constant(0.5),
        shaft_diameter_m=Constant(1e-3),
        shaft_length_m=HALF_UM,
        holes=(HoleDistribution(HALF_UM, HALF_UM), HoleDistribution(HALF_UM, HALF_UM, HALF_UM)),
        position_error_m=HALF_UM,
        tilt_error_rad=HALF_DEG,
        sensor=SensorDistribution(
            1000.0,
            noise_density=Axes(HALF_UM, Constant(5e-10)),
            bias=Axes(Constant(5e-4), HALF_UM),
            drift=DriftDistribution(Axes(HALF_UM, Constant(5e-10)), (0.001, 0.4)),
            latency_s=5e-4,
        ),
        stage=StageDistribution(HALF, HALF, HALF, Constant(0.5), HALF, 5e-4),
        arm=ArmDistribution((drift, drift), HALF, (mode, mode)),
        position_noise_m=HALF_UM,
    )


def test_each_group_has_its_own_key(load: Load) -> None:
    """No two keys lead to the same place: changing one changes the plant, each in its own way."""
    seen = [load(full())]
    for row in SPREADS:
        file = full()
        put(file, row.path, {"constant": 0.625})
        seen.append(load(file))
    assert all(one != other for i, one in enumerate(seen) for other in seen[:i])


@pytest.mark.parametrize(
    ("value", "expected"),
    [
        ({"constant": 4}, Constant(4e3)),
        ({"uniform": [2, 12]}, Uniform(2e3, 12e3)),
        ({"log_uniform": [2, 12]}, LogUniform(2e3, 12e3)),
        ({"choice": [2, 4, 12]}, Choice((2e3, 4e3, 12e3))),
        (
            {"truncated_normal": {"mean": 4, "std": 1, "low": 2, "high": 12}},
            TruncatedNormal(4e3, 1e3, 2e3, 12e3),
        ),
    ],
)
def test_each_distribution(value: object, expected: Distribution, load: Load) -> None:
    file = full()
    put(file, "contact.stiffness_mN_um", value)
    assert load(file).stiffness_N_m == expected


def test_what_is_left_out_is_off(load: Load) -> None:
    file, bare = full(), load(full())
    file["force_sensor"] = {"rate_Hz": 500}
    for group in ("stage", "arm"):
        drop(file, group)
    assert load(file) == replace(
        bare,
        sensor=SensorDistribution(500.0),
        stage=StageDistribution(),
        arm=ArmDistribution(),
        position_noise_m=Constant(0.0),
    )


def test_nominal_is_the_papers_simulation() -> None:
    """Table of section 5.1: only the misalignment differs from plant to plant."""
    plants = draw_plants(
        load_randomisation(SHIPPED / "nominal.yaml"), [np.random.default_rng(s) for s in range(9)]
    )
    for index in (0, 8):
        first, second = plants.part(index).holes
        assert (first.thickness_m, second.thickness_m, second.gap_m) == (5e-4, 5e-4, 1.5e-3)
        assert [first.diameter_m, second.diameter_m] == pytest.approx([1.01e-3] * 2)
        assert (plants.shaft(index).diameter_m, plants.shaft(index).length_m) == (1e-3, 4e-3)
        assert (plants.law(index).stiffness_N_m, plants.law(index).friction) == (4e3, 0.2)
    assert len(np.unique(plants.misalignment[:, 0])) == 9
    assert np.hypot(*plants.misalignment[:, :2].T).max() <= 1e-5
    assert np.hypot(*plants.misalignment[:, 3:].T).max() <= math.radians(0.3)
    np.testing.assert_allclose(plants.sensor.noise_std[:, :3], 1e-3, rtol=0.01)


def test_wide_has_its_stated_ranges() -> None:
    """Each drawn a thousand times: inside, and within one percent of both ends."""
    plants = draw_plants(
        load_randomisation(SHIPPED / "wide.yaml"), [np.random.default_rng(s) for s in range(1000)]
    )
    clearance = plants.hole_diameter_m - plants.shaft_diameter_m[:, np.newaxis]
    for values, low, high in (
        (plants.stiffness_N_m, 2e3, 12e3),
        (plants.friction, 0.1, 0.3),
        (clearance[:, 0], 2e-6, 14e-6),
        (clearance[:, 1], 2e-6, 14e-6),
        (plants.hole_gap_m[:, 1], 1.5e-3, 2.5e-3),
        (np.hypot(*plants.misalignment[:, :2].T) ** 2, 0.0, 1e-10),
        (np.hypot(*plants.misalignment[:, 3:].T) ** 2, 0.0, math.radians(0.3) ** 2),
    ):
        margin = 0.01 * (high - low)
        assert low - 1e-9 * high <= values.min() < low + margin
        assert high - margin < values.max() <= high * (1.0 + 1e-9)
    np.testing.assert_allclose(plants.sensor.noise_std[:, :3], 2e-3, rtol=0.01)
    np.testing.assert_array_equal(plants.position_noise_m, np.full((1000, 3), 5e-7))


def paths(model: type[BaseModel], prefix: str = "") -> Iterator[str]:
    """Every key that holds a distribution or a number; list entries stand for the second."""
    for name, field in model.model_fields.items():
        path, kind = f"{prefix}{field.alias or name}", field.annotation
        if get_origin(kind) is tuple:
            path, kind = f"{path}[1]", get_args(kind)[0]
        inner = next((a for a in (kind, *get_args(kind)) if _is_group(a)), None)
        if inner is None:
            yield path
        else:
            yield from paths(inner, f"{path}.")


def _is_group(kind: object) -> bool:
    return (
        isinstance(kind, type)
        and issubclass(kind, BaseModel)
        and not issubclass(kind, DistributionSettings)
    )


def test_every_key_has_a_row() -> None:
    rows = [row.path for row in (*SPREADS, *NUMBERS)]
    assert len(rows) == len(set(rows))
    assert set(rows) == set(paths(PlantSettings))


def test_the_reference_states_unit_and_range_of_every_key_and_no_other() -> None:
    stated = {}
    group = ""
    text = (ROOT / "docs/reference/randomisation.md").read_text(encoding="utf-8")
    for line in text.splitlines():
        if heading := re.fullmatch(r"### `(.+)`", line):
            group = heading.group(1)
        elif row := re.fullmatch(r"\| `(\w+)` \| (.*?) ?\| (.+?) \| .+ \|", line):
            key, unit, valid = row.groups()
            stated[f"{group}.{key}"] = (unit, valid)
    assert stated == {
        row.path.replace("[1]", ""): (row.unit, row.range) for row in (*SPREADS, *NUMBERS)
    }


def test_files_of_the_folder_load() -> None:
    assert {file.name for file in Path(SHIPPED).iterdir()} == {"nominal.yaml", "wide.yaml"}
