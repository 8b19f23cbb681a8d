"""The forces of a run against numbers worked out by hand."""

import math
from collections.abc import Callable

import pytest

from controllers.messages import SkillPhase
from hil.summary import RunSummary, summarise
from tests.hil.report.runs import ONE_HOLE, RunWriter

SAMPLES = (
    ((3.0, 4.0, 10.0), 0.0),
    ((-30.0, 40.0, 20.0), 500.0),
    ((6.0, -8.0, -50.0), 1500.0),
    ((0.0, 0.0, 5.0), 2100.0),
    ((-60.0, -80.0, 15.0), 2200.0),
)
"""Force [mN] and depth [um]; radial 5, 50, 10, 0 and 100 mN."""

mN = pytest.approx


def worked_example(run: RunWriter) -> RunSummary:
    run.sample((500.0, 500.0, 500.0), -300.0)
    run.phase(1, SkillPhase.APPROACH)
    run.now_ns += 1
    run.phase(1, SkillPhase.INSERT)
    for force_mN, depth_um in SAMPLES:
        run.sample(force_mN, depth_um)
    run.now_ns += 1
    run.phase(1, SkillPhase.DONE)
    run.sample((900.0, 900.0, 900.0), 2300.0)
    return summarise(run.close())


@pytest.mark.parametrize("bias_mN", [(0.0, 0.0, 0.0), (12.0, -7.0, 30.0)])
def test_peaks_and_means_are_those_of_the_insert_phase_without_bias(
    write_run: Callable[..., RunWriter], bias_mN: tuple[float, float, float]
) -> None:
    summary = worked_example(write_run(bias_mN=bias_mN))
    forces = summary.insertions[0].forces
    assert forces is not None
    assert forces.samples == 5
    assert forces.x.peak_N == mN(0.060)
    assert forces.x.mean_N == mN(0.0198)  # (3 + 30 + 6 + 0 + 60) / 5
    assert forces.y.peak_N == mN(0.080)
    assert forces.y.mean_N == mN(0.0264)  # (4 + 40 + 8 + 0 + 80) / 5
    assert forces.z.peak_N == mN(-0.050)
    assert forces.z.mean_N == mN(0.0, abs=1e-9)  # (10 + 20 - 50 + 5 + 15) / 5
    assert summary.forces == forces


def test_the_radial_force_is_the_magnitude_across_the_hole(
    write_run: Callable[..., RunWriter],
) -> None:
    forces = worked_example(write_run()).forces
    assert forces is not None
    assert forces.radial.peak_N == mN(0.100)
    assert forces.radial.mean_N == mN(0.033)  # (5 + 50 + 10 + 0 + 100) / 5
    assert forces.radial.median_N == mN(0.010)
    assert forces.radial.p95_N == mN(0.090)  # four fifths of the way from 50 to 100
    assert forces.gentle_share == mN(0.6)


def test_the_lower_hole_begins_at_its_upper_rim(write_run: Callable[..., RunWriter]) -> None:
    run = write_run()
    run.phase(1, SkillPhase.INSERT)
    for radial_mN, depth_um in ((90.0, 1999.0), (30.0, 2000.0), (20.0, 2400.0)):
        run.sample((radial_mN, 0.0, 0.0), depth_um)
    summary = summarise(run.close())
    assert summary.insertions[0].lower_hole_peak_N == mN(0.030)
    assert summary.insertions[0].deepest_m == mN(2400e-6)
    assert summary.lower_hole_peak_N == mN(0.030)


def test_a_part_with_one_hole_has_no_lower_one(write_run: Callable[..., RunWriter]) -> None:
    summary = worked_example(write_run(part=ONE_HOLE))
    assert summary.facts.walls_m == ((0.0, mN(500e-6)),)
    assert math.isnan(summary.insertions[0].lower_hole_peak_N)
    assert math.isnan(summary.lower_hole_peak_N)


def test_the_gentle_band_ends_at_44_mN_and_includes_its_end(
    write_run: Callable[..., RunWriter],
) -> None:
    run = write_run()
    run.phase(1, SkillPhase.INSERT)
    for radial_mN in (44.0, 44.001, 0.0, 100.0):
        run.sample((0.0, radial_mN, 0.0), 100.0)
    forces = summarise(run.close()).forces
    assert forces is not None
    assert forces.gentle_share == 0.5


def test_samples_that_are_not_finite_do_not_count(write_run: Callable[..., RunWriter]) -> None:
    run = write_run()
    run.phase(1, SkillPhase.INSERT)
    run.sample((math.nan, 1.0, 1.0), 100.0)
    run.sample((8.0, 6.0, 2.0), 200.0)
    forces = summarise(run.close()).forces
    assert forces is not None
    assert forces.samples == 1
    assert forces.radial.mean_N == mN(0.010)


def test_the_run_pools_the_samples_of_its_insertions(write_run: Callable[..., RunWriter]) -> None:
    run = write_run(asked=2)
    for number, radial_mN in ((1, 10.0), (2, 60.0)):
        run.phase(number, SkillPhase.INSERT)
        run.sample((radial_mN, 0.0, 0.0), 100.0)
        run.now_ns += 1
        run.phase(number, SkillPhase.DONE)
    forces = summarise(run.close()).forces
    assert forces is not None
    assert forces.samples == 2
    assert forces.x.peak_N == mN(0.060)
    assert forces.radial.mean_N == mN(0.035)
    assert forces.gentle_share == 0.5
