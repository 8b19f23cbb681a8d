"""Bits do not depend on the batch; every pose may have its own law and geometry."""

import numpy as np
import pytest

from simulator.engine.batch import Batch
from simulator.engine.block import solve_blocks
from simulator.engine.solve import solve
from simulator.engine.table import Table, tabulate
from simulator.geometry import Hole, Part, Shaft
from simulator.profile import Chamfer
from tests.simulator.engine.test_agreement import PLAIN, directions, insertion_poses
from tests.simulator.shapes import PARTS, SHAFTS

N = 5000
GEOMETRIES = [
    (PLAIN, Shaft(1e-3, 4e-3)),
    (PARTS["two chamfered"], SHAFTS["chamfered"]),
    (PARTS["one hole"], SHAFTS["rounded"]),
    (PARTS["three"], SHAFTS["barrel"]),
    (Part((Hole(1.002e-3, 4e-4, entry=Chamfer(2e-5, 1e-5)),)), Shaft(1e-3, 2e-3)),
]


def bits(batch: Batch) -> list[bytes]:
    return [array.tobytes() for array in batch.arrays()]


@pytest.fixture(scope="module")
def table() -> Table:
    return tabulate(GEOMETRIES)


def test_bits_are_those_of_any_batch(table: Table) -> None:
    poses, sliding = insertion_poses(N, 1), directions(N, 2)
    rows = np.random.default_rng(3).integers(0, len(GEOMETRIES), N)
    whole = solve(table, poses, sliding, geometry=rows)
    order = np.random.default_rng(4).permutation(N)
    turned = solve(table, poses[order], sliding[order], geometry=rows[order])
    for expected, found in zip(whole.arrays(), turned.arrays(), strict=True):
        assert expected[order].tobytes() == found.tobytes()
    for first in (*range(0, N, 700), N - 1):
        part = slice(first, first + 1 + first % 131)
        alone = solve(table, poses[part], sliding[part], geometry=rows[part])
        for expected, found in zip(whole.arrays(), alone.arrays(), strict=True):
            assert expected[part].tobytes() == found.tobytes()


@pytest.mark.parametrize("threads", [2, 3, 7])
def test_bits_are_those_of_any_number_of_threads(table: Table, threads: int) -> None:
    n = 120_000
    poses, sliding = insertion_poses(n, 5), directions(n, 6)
    assert bits(solve(table, poses, sliding, threads=threads)) == bits(solve(table, poses, sliding))


def test_a_law_and_a_geometry_for_each_pose(table: Table) -> None:
    n = 2000
    rng = np.random.default_rng(7)
    poses, sliding = insertion_poses(n, 8), directions(n, 9)
    rows = rng.integers(0, len(GEOMETRIES), n)
    stiffness, friction = rng.uniform(1e3, 8e3, n), rng.uniform(0.0, 0.8, n)
    mixed = solve(table, poses, sliding, stiffness_N_m=stiffness, friction=friction, geometry=rows)
    for row, geometry in enumerate(GEOMETRIES):
        of_row = np.flatnonzero(rows == row)
        own = solve(
            tabulate([geometry]),
            poses[of_row],
            sliding[of_row],
            stiffness_N_m=stiffness[of_row],
            friction=friction[of_row],
        )
        for expected, found in zip(own.arrays(), mixed.arrays(), strict=True):
            np.testing.assert_array_equal(found[of_row], expected)


def test_results_go_where_they_are_wanted(table: Table) -> None:
    poses = insertion_poses(300, 10)
    out = Batch.empty(300)
    out.wrench[:] = np.nan
    assert solve(table, poses, (0.0, 0.0, 1.0), out=out) is out
    assert bits(out) == bits(solve(table, poses, (0.0, 0.0, 1.0)))


def test_no_pose_is_a_batch_too(table: Table) -> None:
    assert solve(table, np.empty((0, 5)), (0.0, 0.0, 1.0)).wrench.shape == (0, 6)


def test_one_kernel_serves_every_kind_of_argument(table: Table) -> None:
    poses = insertion_poses(40, 11)
    locked = poses.copy()
    locked.setflags(write=False)
    expected = bits(solve(table, poses, (0.0, 0.0, 1.0)))
    kinds = (locked, poses.tolist(), np.asfortranarray(poses), np.repeat(poses, 2, axis=0)[::2])
    for kind in kinds:
        assert bits(solve(table, kind, [0, 0, 1], geometry=np.int32(0))) == expected
    solve(table, poses, (0.0, 0.0, 1.0), entered=np.zeros((40, 3), dtype=np.bool_))
    assert len(solve_blocks.signatures) == 1  # type: ignore[attr-defined]
