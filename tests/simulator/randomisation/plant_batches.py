"""A distribution of plants in which everything differs, and batches drawn from it."""

from collections.abc import Iterator
from dataclasses import fields, is_dataclass

import numpy as np

from simulator.checks import FloatArray
from simulator.randomisation.distributions import (
    NONE,
    Constant,
    LogUniform,
    TruncatedNormal,
    Uniform,
)
from simulator.randomisation.geometry import (
    ChamferDistribution,
    HoleDistribution,
    ShaftDistribution,
)
from simulator.randomisation.holder import HolderDistribution
from simulator.randomisation.plants import PlantDistribution, Plants, draw_plants
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
CHAMFER = ChamferDistribution(Uniform(5e-6, 3e-5), LogUniform(5e-6, 2e-5))
WIDE = PlantDistribution(
    stiffness_N_m=LogUniform(2e3, 12e3),
    friction=Uniform(0.1, 0.3),
    shaft=ShaftDistribution(
        TruncatedNormal(1e-3, 1e-6, 0.99e-3, 1.01e-3), Constant(4e-3), CHAMFER, trailing=CHAMFER
    ),
    holes=(
        HoleDistribution(Uniform(-2e-6, 14e-6), Uniform(30e-6, 500e-6), entry=CHAMFER),
        HoleDistribution(Uniform(2e-6, 14e-6), Constant(0.5e-3), Uniform(1.5e-3, 2.5e-3), CHAMFER),
    ),
    position_error_m=Constant(1e-5),
    tilt_error_rad=Constant(5e-3),
    sensor=SensorDistribution(
        1000.0,
        SIZES,
        SIZES,
        DriftDistribution(SIZES, (0.01, 1.0)),
        latency_s=2e-3,
        crosstalk=Uniform(-0.02, 0.02),
        range=(2.0, 0.004),
    ),
    stage=StageDistribution(SIZES, SIZES, SIZES, Uniform(0.0, 1.0), SIZES, 0.02),
    arm=ArmDistribution(
        (ThermalDistribution(SIZES, 600.0),), SIZES, (ModeDistribution(SIZES, 12.0, 0.05),)
    ),
    holder=HolderDistribution(
        (LogUniform(5e-5, 5e-4), Uniform(0.0, 5e-5), NONE, Uniform(2.0, 20.0), Constant(50.0)),
        (Uniform(0.1, 0.5), None, None, None, LogUniform(1e-4, 1e-3)),
        (0.0, 0.0, 1.5e-3),
    ),
    position_noise_m=Uniform(0.0, 1e-6),
    stiffness_ratio=Uniform(0.7, 1.0),
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
