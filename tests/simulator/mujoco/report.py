"""Print the tables of docs/reference/mujoco-comparison.md.

From the repository's root: python -m tests.simulator.mujoco.report [poses]
"""

import sys
from importlib.metadata import version

import numpy as np

from simulator.checks import FloatArray
from tests.simulator.mujoco.agreement import (
    Difference,
    axial_normal_differences,
    differences,
    verdicts,
)
from tests.simulator.mujoco.cases import CASES, CROSSING_M, BoolArray, Case
from tests.simulator.mujoco.model import Collider, build
from tests.simulator.mujoco.rest import planar_poses, rest_differences
from tests.simulator.mujoco.stations import of_mujoco, of_simulator

RINGS = (64, 128, 256)
COLLIDERS = {
    "metres, tolerance 1e-6": Collider(1.0, 1e-6),
    "metres, tolerance 1e-12": Collider(1.0, 1e-12),
    "mm, tolerance 1e-6": Collider(1e3, 1e-6),
    "mm, tolerance 1e-9": Collider(),
    "mm, tolerance 1e-9, multiccd off": Collider(flags='multiccd="disable"'),
    "mm, tolerance 1e-9, nativeccd off": Collider(flags='nativeccd="disable"'),
}
tell = sys.stdout.write


def quantiles(values: FloatArray, scale: float) -> str:
    """Median, 99 % and largest."""
    cells = (f"{value * scale:.3g}" for value in np.quantile(values, [0.5, 0.99, 1.0]))
    return " / ".join(cells)


def report_verdicts(case: Case, count: int) -> None:
    for name, poses in (
        ("any depth", case.poses(count)),
        ("an end at a rim", case.poses_at_rims(count)),
    ):
        for sides in RINGS:
            found = of_mujoco(build(case.part, case.shaft, sides), poses)
            v = verdicts(case, poses, found, sides)
            outside = v.differ & v.outside_band
            tell(
                f"  {name}, {sides} sides, band {case.band_m(sides) * 1e9:.1f} nm: "
                f"{v.touching.sum()} touch, {(~v.outside_band).sum()} in band, "
                f"{v.crossing.sum()} crossing; differ {v.differ.sum()}, outside band "
                f"{outside.sum()}, of these not crossing {(outside & ~v.crossing).sum()}; "
                f"missed by us {v.missed.sum()}\n"
            )


def report_differences(case: Case, count: int) -> None:
    poses = case.poses(count)
    poses = poses[~case.crossing(poses)]
    single = Collider(flags='multiccd="disable"')
    for sides in RINGS:
        scene = build(case.part, case.shaft, sides)
        off = differences(case, poses, of_mujoco(scene, poses), sides)
        large = off.force_size_N > 1e-3
        share = off.force.values[large] / off.force_size_N[large]
        alone = of_mujoco(build(case.part, case.shaft, sides, collider=single), poses)
        tell(f"  {sides} sides, {len(poses)} poses with no end crossing: median / p99 / max\n")
        for name, part, scale in (
            ("depth nm", off.depth, 1e9),
            ("normal degrees", off.normal, 180.0 / np.pi),
            ("force mN", off.force, 1e3),
            ("torque uN*m", off.torque, 1e6),
            ("axial part of single", axial_normal_differences(case, poses, alone, sides), 1.0),
        ):
            shares = Difference(part.values, part.bounds).share_of_bound()
            tell(
                f"    {name:22}{quantiles(part.values, scale):28}"
                f"largest share of its bound {shares:.2f}\n"
            )
        tell(f"    {'force %':22}{quantiles(share, 100.0)}\n")


def leaving(case: Case, poses: FloatArray) -> BoolArray:
    """Where an end crosses the rim through which it leaves a wall (B2 the lower, B1 the upper)."""
    lead = np.abs(poses[:, 2, np.newaxis] - case.part.wall_exits_m)
    trail = np.abs(poses[:, 2, np.newaxis] - case.shaft.length_m - case.part.wall_entries_m)
    return np.asarray(np.minimum(lead, trail).min(axis=1) < CROSSING_M)


def report_crossing(case: Case, count: int) -> None:
    poses = case.poses_at_rims(count)
    found = of_mujoco(build(case.part, case.shaft, 256), poses)
    of_walls = found.depth.max(axis=-1) - of_simulator(case, poses).depth.max(axis=-1)
    off = np.abs(of_walls).max(axis=-1)
    axial = np.abs(found.normal[..., 2]).max(axis=(1, 2)) > 0.5
    leaves = leaving(case, poses)
    for name, chosen in (("entering", ~leaves), ("leaving", leaves)):
        tell(
            f"  an end {name} at a rim, 256 sides, {chosen.sum()} poses: depth of a wall nm "
            f"{quantiles(off[chosen], 1e9)}; MuJoCo pushes axially in {axial[chosen].mean():.1%}\n"
        )


def report_colliders(case: Case, count: int) -> None:
    poses = case.poses(count)
    poses = poses[~case.crossing(poses)]
    tell(f"{case.name}, 128 sides, {len(poses)} poses: station depth nm, verdicts that differ\n")
    for name, collider in COLLIDERS.items():
        found = of_mujoco(build(case.part, case.shaft, 128, collider=collider), poses)
        v = verdicts(case, poses, found, 128)
        depth = differences(case, poses, found, 128).depth.values
        tell(f"  {name:36}{quantiles(depth, 1e9):28}{(v.differ & v.outside_band).sum()}\n")


def report_rest(case: Case, count: int) -> None:
    off = rest_differences(case, planar_poses(case, count, seed=1), case)
    tell(
        f"  at rest: {len(off.x_m)} poses, {off.left_out} left out, "
        f"{(off.force_size_N > 0.0).sum()} pressed with up to {off.force_size_N.max() * 1e3:.1f} mN"
        f"; x differs by at most {off.x_m.max() * 1e9:.3f} nm, "
        f"force by {off.force_N.max() * 1e6:.3f} uN\n"
    )


def main() -> None:
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 4000
    tell(f"mujoco-core {version('mujoco-core')}, {count} poses to a table\n")
    for case in CASES:
        tell(f"{case.name}\n")
        report_verdicts(case, count)
        report_differences(case, count)
        report_crossing(case, count)
        report_rest(case, count // 20)
    report_colliders(CASES[0], count // 4)


if __name__ == "__main__":
    main()
