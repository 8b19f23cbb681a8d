"""Contact or no contact, against MuJoCo's own narrow phase.

The hole's polygon touches its circle from outside, so the boundaries differ by a band: displacement
of the shaft's axis in the hole times 1 - cos(pi/n), up to 28.3 nm for 64 sides, 7.2 nm for 128.
Where an end's slanted face crosses a rim's plane it may cut the deepest point off; what is left can
lie in a corner of the polygon, and the boundaries differ by up to its sagitta: 612 and 153 nm.
"""

import numpy as np
import pytest

from simulator.checks import FloatArray
from simulator.geometry import Hole, Part
from tests.simulator.mujoco.agreement import Verdicts, verdicts
from tests.simulator.mujoco.cases import CASES, Case
from tests.simulator.mujoco.model import build
from tests.simulator.mujoco.stations import of_mujoco

pytestmark = pytest.mark.slow

POSES = 2000
each_case = pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
each_ring = pytest.mark.parametrize("sides", [64, 128])


def judge(case: Case, poses: FloatArray, sides: int) -> Verdicts:
    return verdicts(case, poses, of_mujoco(build(case.part, case.shaft, sides), poses), sides)


@each_ring
@each_case
def test_random_poses_agree(case: Case, sides: int) -> None:
    found = judge(case, case.poses(POSES, seed=3), sides)
    assert 0.6 < found.touching.mean() < 0.9
    assert found.differ.mean() <= 0.01
    assert found.outside_band.mean() > 0.98
    within = found.outside_band & ~found.crossing
    assert within.mean() > 0.75
    assert not (found.differ & within).any()


@each_ring
@each_case
def test_poses_with_an_end_at_a_rim_agree(case: Case, sides: int) -> None:
    found = judge(case, case.poses_at_rims(POSES, seed=4), sides)
    assert found.crossing.all()
    assert 0.5 < found.touching.mean() < 0.9
    assert found.differ.mean() <= 0.01


@each_ring
@each_case
def test_differences_are_those_of_a_polygon_around_the_circle(case: Case, sides: int) -> None:
    """What MuJoCo touches, we touch; what overlaps by more than the sagitta, MuJoCo touches."""
    poses = np.concatenate([case.poses(POSES, seed=5), case.poses_at_rims(POSES, seed=6)])
    found = judge(case, poses, sides)
    assert not found.missed.any()
    assert not found.deep_alone.any()


@pytest.mark.parametrize(
    ("change", "diameter_m"),
    [((1, 1, 1, -1, 1), 1.01e-3), ((1, 1, 1, 1, 1), 1.0101e-3)],
    ids=["sign of rx", "hole 0.1 um wider"],
)
def test_a_mistake_changes_verdicts(change: tuple[int, ...], diameter_m: float) -> None:
    case, poses = CASES[0], CASES[0].poses(POSES, seed=7)
    seen = of_mujoco(build(case.part, case.shaft, 128), poses)
    part = Part((Hole(diameter_m, 5e-4), Hole(diameter_m, 5e-4, 1.5e-3)))
    found = verdicts(Case("wrong", part, case.shaft), poses * change, seen, 128)
    assert (found.differ & found.outside_band & ~found.crossing).any()
