"""One plant of a batch, and what is refused."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from simulator.contact import ContactLaw
from simulator.geometry import Hole, Shaft
from simulator.holder import Holder
from simulator.profile import Chamfer, Rounding
from simulator.randomisation.distributions import NONE, Constant
from simulator.randomisation.geometry import (
    SHARP,
    ChamferDistribution,
    HoleDistribution,
    ShaftDistribution,
)
from simulator.randomisation.holder import HolderDistribution
from simulator.randomisation.rig import Axes, StageDistribution
from simulator.stick import StickLaw
from tests.simulator.randomisation.plant_batches import WIDE, plants


def test_one_plant_of_a_batch_is_geometry_and_contact_law() -> None:
    d = replace(
        WIDE,
        friction=Constant(0.25),
        shaft=ShaftDistribution(Constant(1e-3), Constant(4e-3)),
        stiffness_ratio=Constant(0.5),
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
    assert (first.entry, second.entry) == (None, None)
    stiffness = float(drawn.stiffness_N_m[1])
    assert drawn.law(1) == ContactLaw(stiffness, 0.25)
    assert drawn.stick_law(1) == StickLaw(drawn.law(1), 0.5 * stiffness)


def test_worked_edges_of_one_plant() -> None:
    entry = ChamferDistribution(Constant(2e-5), Constant(3e-5))
    leading = ChamferDistribution(Constant(1e-5), Constant(4e-5))
    trailing = ChamferDistribution(Constant(6e-6), Constant(7e-6))
    shaft = ShaftDistribution(Constant(1e-3), Constant(4e-3), leading, trailing=trailing)
    holes = (
        HoleDistribution(Constant(1e-5), Constant(5e-4)),
        HoleDistribution(Constant(1e-5), Constant(2e-4), Constant(1.5e-3), entry),
    )
    drawn = plants((1, 2), replace(WIDE, shaft=shaft, holes=holes))
    assert drawn.shaft(1) == Shaft(1e-3, 4e-3, Chamfer(1e-5, 4e-5), Chamfer(6e-6, 7e-6))
    diameter = float(drawn.hole_diameter_m[1, 1])
    assert drawn.part(1).holes == (
        Hole(diameter, 5e-4),
        Hole(diameter, 2e-4, 1.5e-3, Chamfer(2e-5, 3e-5)),
    )
    rounded = replace(shaft, leading=SHARP, rounding_m=Constant(5e-5))
    drawn = plants((1, 2), replace(WIDE, shaft=rounded))
    assert drawn.shaft(1) == Shaft(1e-3, 4e-3, Rounding(5e-5), Chamfer(6e-6, 7e-6))


def test_the_holder_of_one_plant() -> None:
    drawn = plants((1, 2))
    one = drawn.holder(1)
    np.testing.assert_array_equal(one.compliance, drawn.holders.compliance[1])
    np.testing.assert_array_equal(one.compliance[[2, 4]], [0.0, 50.0])
    np.testing.assert_array_equal(one.holding_force[1:4], np.inf)
    assert 0.1 <= one.holding_force[0] <= 0.5
    np.testing.assert_array_equal(one.pivot_m, [0.0, 0.0, 1.5e-3])


def test_an_axis_that_never_slips_takes_its_number_all_the_same() -> None:
    never = replace(WIDE.holder, holding_force=(None, *WIDE.holder.holding_force[1:]))
    one, other = plants((1, 2)).holders, plants((1, 2), replace(WIDE, holder=never)).holders
    np.testing.assert_array_equal(other.holding_force[:, 0], np.inf)
    np.testing.assert_array_equal(one.holding_force[:, 1:], other.holding_force[:, 1:])


def test_range_and_resolution_of_the_sensor() -> None:
    sensor = plants(
        (1, 2), replace(WIDE, sensor=replace(WIDE.sensor, resolution=(1e-4, 1e-6)))
    ).sensor
    np.testing.assert_array_equal(sensor.range, [2.0, 2.0, 2.0, 4e-3, 4e-3, 4e-3])
    np.testing.assert_array_equal(sensor.resolution, [1e-4, 1e-4, 1e-4, 1e-6, 1e-6, 1e-6])


def test_a_holder_that_is_left_out_is_the_rigid_one() -> None:
    one, rigid = plants((1, 2), replace(WIDE, holder=HolderDistribution())).holder(1), Holder()
    np.testing.assert_array_equal(one.compliance, rigid.compliance)
    np.testing.assert_array_equal(one.holding_force, rigid.holding_force)
    np.testing.assert_array_equal(one.pivot_m, rigid.pivot_m)


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
    deep = ChamferDistribution(Constant(1e-5), Constant(5e-4))
    hole = HoleDistribution(Constant(1e-5), Constant(5e-4), entry=deep)
    with pytest.raises(ValueError, match=r"Hole.entry.height_m is 0.0005; it must be below"):
        plants((1,), replace(WIDE, holes=(hole,))).part(0)
    half = ChamferDistribution(width_m=Constant(1e-5))
    with pytest.raises(ValueError, match=r"Chamfer.height_m is 0.0; it must be"):
        plants((1,), replace(WIDE, shaft=replace(WIDE.shaft, leading=half))).shaft(0)


CONTRADICTIONS: list[tuple[Callable[[], object], str]] = [
    (
        lambda: replace(WIDE.shaft, rounding_m=Constant(1e-5)),
        r"ShaftDistribution.rounding_m is Constant\(value=1e-05\); it must be "
        r"Constant\(value=0.0\) where the leading end has a chamfer",
    ),
    (
        lambda: replace(WIDE.sensor, range=(2.0, np.inf)),
        r"SensorDistribution.range is \(2.0, inf\); it must be finite, for crosstalk is a share",
    ),
    (
        lambda: HolderDistribution((NONE,) * 6),
        r"HolderDistribution.compliance has 6 entries; it must have 5",
    ),
    (
        lambda: HolderDistribution(holding_force=(None,) * 3),
        r"HolderDistribution.holding_force has 3 entries; it must have 5",
    ),
]


@pytest.mark.parametrize(("call", "message"), CONTRADICTIONS, ids=[m for _, m in CONTRADICTIONS])
def test_contradictions_are_refused(call: Callable[[], object], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        call()
