"""Depth, normal, resultant force and torque, against those of MuJoCo's narrow phase.

MuJoCo finds depth, normal and point of each contact; the law, 4 mN/um times depth, is put on the
deepest one of each station of each wall. There is no friction, and no end crosses a rim.

The bounds restate what the polygon of n sides and the tilt, up to 0.3 degrees, explain. In `cases`
the axis is displaced by D <= 10 um + 0.3 degrees * depth = 23.4 um (shorter shaft: 22.9 um).

- depth: D (1 - cos(pi/n)) + 0.1 nm = 28.3 nm for 64 sides, 7.2 nm for 128;
- normal: a side's is up to pi/n off the deepest direction, and MuJoCo turns it by up to the tilt
  into the side's face: hypot(180 / n, 0.3) degrees = 2.83 and 1.44 degrees;
- force: per station stiffness * (depth * that angle + depth's bound), as `differences` adds it up;
- torque: per station the same times its arm, plus the force times R pi/n along the rim.
"""

from collections.abc import Callable

import numpy as np
import pytest

from simulator.checks import FloatArray
from simulator.geometry import Hole, Part
from tests.simulator.mujoco.agreement import Differences, axial_normal_differences, differences
from tests.simulator.mujoco.cases import CASES, Case
from tests.simulator.mujoco.model import Collider, build
from tests.simulator.mujoco.stations import of_mujoco

pytestmark = pytest.mark.slow

POSES = 2000
WIDER = Part((Hole(1.0101e-3, 5e-4), Hole(1.0101e-3, 5e-4, 1.5e-3)))
Mistake = Callable[[Case, FloatArray], tuple[Case, FloatArray]]
each_case = pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
each_ring = pytest.mark.parametrize(
    ("sides", "depth_m", "normal_deg"), [(64, 28.3e-9, 2.83), (128, 7.2e-9, 1.44)]
)


def poses_between_rims(case: Case) -> FloatArray:
    poses = case.poses(POSES, seed=8)
    return poses[~case.crossing(poses)]


@each_ring
@each_case
def test_stations_and_wrenches_agree(
    case: Case, sides: int, depth_m: float, normal_deg: float
) -> None:
    poses = poses_between_rims(case)
    found = of_mujoco(build(case.part, case.shaft, sides), poses)
    off = differences(case, poses, found, sides)
    assert off.depth.values.size > 2000
    assert off.depth.values.max() <= depth_m
    assert np.degrees(off.normal.values.max()) <= normal_deg
    assert off.force_size_N.max() > 0.08
    assert off.force.share_of_bound() <= 1.0
    assert off.torque.share_of_bound() <= 1.0
    # The bounds say something: they are small beside the forces.
    assert np.median(off.force.bounds / off.force_size_N) < 0.1


@each_case
def test_normals_of_single_contacts_agree_axially_as_well(case: Case) -> None:
    """Within tilt * pi/n = 2.6e-4; to drop the axial part would be seen at up to 5.2e-3."""
    poses = poses_between_rims(case)
    scene = build(case.part, case.shaft, 64, collider=Collider(flags='multiccd="disable"'))
    off = axial_normal_differences(case, poses, of_mujoco(scene, poses), 64)
    assert off.values.size > 1000
    assert off.values.max() <= 2.6e-4


@pytest.mark.parametrize(
    ("mistake", "noticed"),
    [
        (lambda case, poses: (Case("", WIDER, case.shaft), poses), {"depth", "force", "torque"}),
        (
            lambda case, poses: (case, poses * [1, 1, 1, -1, 1]),
            {"depth", "normal", "force", "torque"},
        ),
        (
            lambda case, poses: (case, poses[:, [1, 0, 2, 3, 4]]),
            {"depth", "normal", "force", "torque"},
        ),
    ],
    ids=["hole 0.1 um wider", "sign of rx", "x and y exchanged"],
)
def test_a_mistake_exceeds_the_bounds(mistake: Mistake, noticed: set[str]) -> None:
    case, poses = CASES[0], poses_between_rims(CASES[0])
    found = of_mujoco(build(case.part, case.shaft, 128), poses)
    off: Differences = differences(*mistake(case, poses), found, 128)
    shares = {name: getattr(off, name).share_of_bound() for name in sorted(noticed)}
    assert min(shares.values()) > 1.5, shares
