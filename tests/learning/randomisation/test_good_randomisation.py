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
from simulator.geometry import Shaft
from simulator.randomisation.distributions import (
    Choice,
    Constant,
    Distribution,
    LogUniform,
    TruncatedNormal,
    Uniform,
)
from simulator.randomisation.geometry import (
    SHARP,
    ChamferDistribution,
    HoleDistribution,
    ShaftDistribution,
)
from simulator.randomisation.holder import HolderDistribution
from simulator.randomisation.plants import PlantDistribution, draw_plants
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
from tests.learning.randomisation.plant_files import (
    NUMBERS,
    ROUNDING,
    SPREADS,
    Load,
    drop,
    full,
    put,
)

SHIPPED = ROOT / "config" / "randomisation"
HALF_UM, HALF_DEG = Constant(5e-7), Constant(math.pi / 360.0)
HALF = Axes(HALF_UM, HALF_DEG)


def test_every_key_arrives_in_si_units_where_it_belongs(load: Load) -> None:
    """Of a file in which nearly every number is a half, in the unit of its key."""
    drift = ThermalDistribution(HALF, 0.5)
    mode = ModeDistribution(HALF, 0.5, 0.5)
    chamfer = ChamferDistribution(HALF_UM, HALF_UM)
    shift, turn = Constant(5e-4), Constant(0.5)
    force, torque = Constant(5e-4), HALF_UM
    thickness = Constant(5e-4)
    assert load(full()) == PlantDistribution(
        stiffness_N_m=Constant(500.0),
        friction=Constant(0.5),
        shaft=ShaftDistribution(Constant(1e-3), Constant(4e-3), leading=chamfer, trailing=chamfer),
        holes=(
            HoleDistribution(HALF_UM, thickness, entry=chamfer),
            HoleDistribution(HALF_UM, thickness, HALF_UM, chamfer),
        ),
        position_error_m=HALF_UM,
        tilt_error_rad=HALF_DEG,
        sensor=SensorDistribution(
            1000.0,
            noise_density=Axes(HALF_UM, Constant(5e-10)),
            bias=Axes(Constant(5e-4), HALF_UM),
            drift=DriftDistribution(Axes(HALF_UM, Constant(5e-10)), (0.001, 0.4)),
            latency_s=5e-4,
            crosstalk=Constant(5e-3),
            range=(2.0, 4e-3),
            resolution=(5e-4, 5e-7),
        ),
        stage=StageDistribution(HALF, HALF, HALF, Constant(0.5), HALF, 5e-4),
        arm=ArmDistribution((drift, drift), HALF, (mode, mode)),
        holder=HolderDistribution(
            (shift, shift, shift, turn, turn),
            (force, force, force, torque, torque),
            (1.5e-3, 1.5e-3, 0.0),
        ),
        position_noise_m=HALF_UM,
        common_clearance_m=HALF_UM,
        stiffness_ratio=Constant(0.5),
    )


def test_a_rounded_leading_end(load: Load) -> None:
    shaft = load(full(ROUNDING)).shaft
    assert shaft == replace(load(full()).shaft, leading=SHARP, rounding_m=HALF_UM)


def test_each_axis_of_the_holder_is_its_own(load: Load) -> None:
    file = full()
    compliance = [f"{axis}_um_mN" for axis in "xyz"] + [f"{axis}_urad_uNm" for axis in ("rx", "ry")]
    holding = [f"force_{axis}_mN" for axis in "xyz"] + [
        f"torque_{axis}_uNm" for axis in ("rx", "ry")
    ]
    for number, (soft, strong) in enumerate(zip(compliance, holding, strict=True), start=1):
        put(file, f"holder.compliance_{soft}", {"constant": number})
        put(file, f"holder.holding_{strong}", {"constant": number})
    put(file, "holder.pivot_um", [1, 2, 3])
    assert load(file).holder == HolderDistribution(
        tuple(Constant(c) for c in (1e-3, 2e-3, 3e-3, 4.0, 5.0)),
        tuple(Constant(f) for f in (1e-3, 2e-3, 3e-3, 4e-6, 5e-6)),
        (1e-6, 2e-6, 3e-6),
    )


def test_each_group_has_its_own_key(load: Load) -> None:
    """No two keys lead to the same place: changing one changes the plant, each in its own way."""
    seen = [load(full())]
    for row in SPREADS:
        file = full(row.path)
        put(file, f"{row.path}.constant", 1.25 * drop(file, f"{row.path}.constant"))
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
    for path in (
        "stage",
        "arm",
        "holder",
        "common_clearance_um",
        "contact.tangential_stiffness_ratio",
        "shaft.leading_chamfer",
        "shaft.trailing_chamfer",
        "holes[0].entry_chamfer",
        "holes[1].entry_chamfer",
    ):
        drop(file, path)
    assert load(file) == replace(
        bare,
        shaft=ShaftDistribution(Constant(1e-3), Constant(4e-3)),
        holes=tuple(replace(hole, entry=SHARP) for hole in bare.holes),
        sensor=SensorDistribution(500.0),
        stage=StageDistribution(),
        arm=ArmDistribution(),
        holder=HolderDistribution(),
        position_noise_m=Constant(0.0),
        common_clearance_m=Constant(0.0),
        stiffness_ratio=Constant(0.825),
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
        assert (first.entry, second.entry) == (None, None)
        assert plants.shaft(index) == Shaft(1e-3, 4e-3)
        assert not plants.holder(index).compliance.any()
        assert np.isinf(plants.holder(index).holding_force).all()
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
        (plants.tangential_stiffness_N_m / plants.stiffness_N_m, 0.7, 1.0),
        *((plants.hole_entry_m[:, hole, size], 5e-6, 30e-6) for hole in (0, 1) for size in (0, 1)),
        *((plants.shaft_leading_m[:, size], 2e-6, 20e-6) for size in (0, 1)),
        (plants.sensor.crosstalk[:, 3, 5], -0.01, 0.01),
        (plants.holders.compliance[:, 0], 5e-5, 5e-4),
        (plants.holders.compliance[:, 1], 5e-6, 5e-5),
        (plants.holders.compliance[:, 2], 5e-6, 5e-5),
        (plants.holders.compliance[:, 3], 2.0, 20.0),
        (plants.holders.compliance[:, 4], 5.0, 50.0),
        (plants.holders.holding_force[:, 0], 0.05, 0.3),
        (plants.hole_gap_m[:, 1], 1.5e-3, 2.5e-3),
        (np.hypot(*plants.misalignment[:, :2].T) ** 2, 0.0, 1e-10),
        (np.hypot(*plants.misalignment[:, 3:].T) ** 2, 0.0, math.radians(0.3) ** 2),
    ):
        margin = 0.01 * (high - low)
        assert low - 1e-9 * high <= values.min() < low + margin
        assert high - margin < values.max() <= high * (1.0 + 1e-9)
    assert 2e-6 - 1e-15 <= clearance.min() < 2.5e-6
    assert 13.5e-6 < clearance.max() <= 14e-6 + 1e-15
    assert 3.5e-6 < np.abs(clearance[:, 1] - clearance[:, 0]).max() <= 4e-6 + 1e-15
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
            stated[f"{group}.{key}".removeprefix(".")] = (unit, valid)
    assert stated == {
        row.path.replace("[1]", ""): (row.unit, row.range) for row in (*SPREADS, *NUMBERS)
    }


def test_files_of_the_folder_load() -> None:
    names = {file.name for file in Path(SHIPPED).iterdir()}
    assert names == {"extended.yaml", "nominal.yaml", "online.yaml", "wide.yaml"}
