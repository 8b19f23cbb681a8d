"""The engine repeats the numpy reference, for all shapes, laws and sliding directions."""

import numpy as np
import pytest

from simulator.blocking import update_entered
from simulator.checks import FloatArray
from simulator.contact import ContactLaw
from simulator.engine.solve import solve
from simulator.engine.table import tabulate
from simulator.geometry import Hole, Part, Shaft
from simulator.profile import Chamfer, Rounding
from tests.simulator.engine.agreement import difference
from tests.simulator.shapes import PARTS, SHAFTS, pressing_poses

TOLERANCE = 1e-9
PLAIN = Part((Hole(1.01e-3, 5e-4), Hole(1.01e-3, 5e-4, 1.5e-3)))


def insertion_poses(n: int, seed: int) -> FloatArray:
    spread = np.array([1e-5, 1e-5, 1.8e-3, 5e-3, 5e-3])
    draw = np.random.default_rng(seed).uniform(-1.0, 1.0, (n, 5))
    return np.array([0.0, 0.0, 1.4e-3, 0.0, 0.0]) + spread * draw


def directions(n: int, seed: int) -> FloatArray:
    return np.random.default_rng(seed).normal(size=(n, 3))


@pytest.mark.slow
@pytest.mark.parametrize("part", PARTS)
@pytest.mark.parametrize("shaft", SHAFTS)
@pytest.mark.parametrize(("tilt", "away"), [(6e-3, 1.5e-5), (0.05, 6e-5)])
def test_worked_surfaces(shaft: str, part: str, tilt: float, away: float) -> None:
    n = 1000
    poses = pressing_poses(PARTS[part], n, 1, tilt, away)
    law = ContactLaw(2.5e3, 0.35)
    assert difference(PARTS[part], SHAFTS[shaft], poses, directions(n, 2), law) < TOLERANCE


@pytest.mark.slow
def test_a_hundred_thousand_insertion_poses() -> None:
    n = 100_000
    worst = difference(
        PLAIN, Shaft(1e-3, 4e-3), insertion_poses(n, 3), directions(n, 4), ContactLaw()
    )
    assert worst < TOLERANCE


def random_part(rng: np.random.Generator) -> Part:
    holes = []
    for wall in range(rng.integers(1, 5)):
        thickness = rng.uniform(5e-5, 6e-4)
        entry = Chamfer(rng.uniform(1e-6, 1e-4), rng.uniform(1e-6, 0.9 * thickness))
        gap = rng.uniform(0.0, 2e-3) if wall else 0.0
        diameter = 1e-3 + rng.uniform(-1e-5, 3e-5)
        holes.append(Hole(diameter, thickness, gap, entry if rng.random() < 0.5 else None))
    return Part(tuple(holes))


def random_shaft(rng: np.random.Generator) -> Shaft:
    length, kind = rng.uniform(5e-4, 5e-3), rng.integers(4)
    ends = [Chamfer(rng.uniform(1e-6, 3e-4), rng.uniform(1e-6, 0.4 * length)) for _ in range(2)]
    if kind == 0:
        return Shaft(1e-3, length)
    if kind == 1:
        return Shaft(1e-3, length, *ends)
    if kind == 2:
        return Shaft(1e-3, length, Rounding(rng.uniform(1e-7, min(4.9e-4, 0.5 * length))))
    s = np.concatenate([[0.0], np.sort(rng.uniform(0.0, length, rng.integers(2, 6)))])
    radius = 5e-4 - rng.uniform(1e-5, 3e-4) * (s / length - rng.uniform(0.2, 0.8)) ** 2
    return Shaft.of_profile(tuple(zip(s.tolist(), radius.tolist(), strict=True)))


@pytest.mark.slow
def test_random_plants() -> None:
    rng = np.random.default_rng(5)
    n = 300
    for _ in range(80):
        part, shaft = random_part(rng), random_shaft(rng)
        tilt, away = 10.0 ** rng.uniform(-4.0, 0.0), 10.0 ** rng.uniform(-5.0, -3.0)
        poses = pressing_poses(part, n, int(rng.integers(1 << 30)), tilt, away)
        entered = rng.random((n, len(part.holes))) < 0.5 if rng.random() < 0.3 else None
        law = ContactLaw(rng.uniform(1e3, 1e4), rng.uniform(0.0, 1.0))
        assert difference(part, shaft, poses, directions(n, 6), law, entered) < TOLERANCE


def test_upright_and_centred_poses() -> None:
    poses = insertion_poses(400, 7)
    poses[:200, 3:] = 0.0
    poses[100:300, :2] = 0.0
    poses[200:300, 4] = 0.0
    for diameter in (1.01e-3, 1e-3, 0.998e-3):
        part = Part((Hole(diameter, 5e-4), Hole(1.01e-3, 5e-4, 1.5e-3)))
        law = ContactLaw(friction=0.0)
        assert difference(part, Shaft(1e-3, 4e-3), poses, directions(400, 8), law) < TOLERANCE


@pytest.mark.slow
@pytest.mark.parametrize("shaft", ["plain", "rounded", "chamfered"])
@pytest.mark.parametrize("part", PARTS)
def test_blocking(shaft: str, part: str) -> None:
    n = 1000
    poses = pressing_poses(PARTS[part], n, 9, 0.02, 6e-5)
    before = np.random.default_rng(10).random((n, len(PARTS[part].holes))) < 0.5
    carried = before.copy()
    table = tabulate([(PARTS[part], SHAFTS[shaft])])
    solve(table, poses, (0.0, 0.0, 1.0), entered=carried)
    expected = update_entered(PARTS[part], SHAFTS[shaft], poses, before)
    np.testing.assert_array_equal(carried, expected)
    assert (carried != before).any()
    sliding = directions(n, 11)
    worst = difference(PARTS[part], SHAFTS[shaft], poses, sliding, ContactLaw(), before)
    assert worst < TOLERANCE
