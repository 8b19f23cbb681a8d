"""What insertions are measured by. Forces are those on the part, free of a sensor's noise."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
from scipy.stats import binomtest

from learning.evaluation.trial import Record
from simulator.checks import FloatArray

IntArray = npt.NDArray[np.int64]

CONFIDENCE = 0.95
_CHUNK = 256
"""Bootstrap samples that are drawn at a time."""


class Quantity(NamedTuple):
    """A number that every insertion has."""

    title: str
    unit: str
    """Of what people are shown."""
    per_si: float
    """Times the SI value gives the value in that unit."""
    meaning: str


QUANTITIES: Mapping[str, Quantity] = MappingProxyType(
    {
        "steps": Quantity("Steps", "", 1.0, "until inserted or given up"),
        "radial_mean": Quantity(
            "Radial force, mean", "mN", 1e3, "over all steps, those in free air included"
        ),
        "radial_peak": Quantity("Radial force, peak", "mN", 1e3, "largest of all steps"),
        "radial_contact_mean": Quantity(
            "Radial force, mean after first contact",
            "mN",
            1e3,
            "over the steps from the first one with a force on; 0 where there was none",
        ),
        "last_hole_peak": Quantity(
            "Radial force, peak in the last hole",
            "mN",
            1e3,
            "largest of the steps that end below the last hole's upper rim; "
            "of insertions that came so far",
        ),
        "axial_mean": Quantity("Axial force, mean", "mN", 1e3, "of |f_z| over all steps"),
        "axial_peak": Quantity("Axial force, peak", "mN", 1e3, "largest |f_z| of all steps"),
        "torque_peak": Quantity(
            "Tilting torque, peak",
            "uN m",
            1e6,
            "largest about the centre of the first hole's upper rim; a jammed shaft shows here "
            "where its forces cancel each other",
        ),
        "impulse": Quantity(
            "Radial impulse", "mN s", 1e3, "sum of the radial forces times the time of a step"
        ),
        "hard_time": Quantity(
            "Time above the gentle force",
            "s",
            1.0,
            "steps with a larger radial force times the time of a step",
        ),
        "hard_share": Quantity(
            "Share of steps above the gentle force", "%", 1e2, "of an insertion's steps"
        ),
    }
)
"""Every quantity by name, in the order in which it is shown."""


class Interval(NamedTuple):
    """A value, and the interval that the true one lies in with `CONFIDENCE`."""

    value: float
    low: float
    high: float


@dataclass(frozen=True, slots=True, eq=False)
class Measured:
    """Insertions by one controller; entry i of every array belongs to plant i."""

    values: Mapping[str, FloatArray]
    """By name of `QUANTITIES`, each (n,), SI units. NaN in `last_hole_peak` where no step ended in
    the last hole."""
    is_success: FloatArray
    """(n,): 1 where inserted with no force above its limit, else 0."""


class Spread(NamedTuple):
    """A quantity over all insertions, in SI units."""

    mean: Interval
    p50: float
    p95: float
    largest: float


class Thresholds(NamedTuple):
    """What the measuring of steps depends on."""

    step_s: float
    """What a step takes."""
    gentle_N: float
    """Radial force over which a step is not gentle."""


def radial_forces(record: Record) -> FloatArray:
    """Radial force after each step [N], shape (T,)."""
    return np.hypot(record.wrenches[:, 0], record.wrenches[:, 1])


def mean_radial_force(record: Record) -> float:
    """Over all steps [N]."""
    return float(radial_forces(record).mean())


def measured(records: Sequence[Record], thresholds: Thresholds) -> Measured:
    """Measure insertions; a record holds at least one step."""
    rows = [_quantities(record, thresholds) for record in records]
    return Measured(
        {name: np.array([row[name] for row in rows]) for name in QUANTITIES},
        np.array([float(record.is_success) for record in records]),
    )


def _quantities(record: Record, thresholds: Thresholds) -> dict[str, float]:
    radial, axial = radial_forces(record), np.abs(record.wrenches[:, 2])
    touched = np.flatnonzero((radial > 0.0) | (axial > 0.0))
    in_last = radial[record.poses[:, 2] > record.last_mouth_m]
    is_hard = radial > thresholds.gentle_N
    return {
        "steps": float(len(radial)),
        "radial_mean": mean_radial_force(record),
        "radial_peak": float(radial.max()),
        "radial_contact_mean": float(radial[touched[0] :].mean()) if touched.size else 0.0,
        "last_hole_peak": float(in_last.max()) if in_last.size else np.nan,
        "axial_mean": float(axial.mean()),
        "axial_peak": float(axial.max()),
        "torque_peak": float(np.hypot(record.wrenches[:, 3], record.wrenches[:, 4]).max()),
        "impulse": float(radial.sum()) * thresholds.step_s,
        "hard_time": float(is_hard.sum()) * thresholds.step_s,
        "hard_share": float(is_hard.mean()),
    }


def success_rate(is_success: FloatArray) -> Interval:
    """Share of successes with Wilson's interval."""
    n, successes = len(is_success), int(is_success.sum())
    interval = binomtest(successes, n).proportion_ci(CONFIDENCE, method="wilson")
    return Interval(successes / n, float(interval.low), float(interval.high))


def spread(values: FloatArray, samples: int, generator: np.random.Generator) -> Spread:
    """Sum up one value per insertion (n,); NaN are left out, and all is NaN where nothing is left.

    The interval of the mean is the percentile bootstrap's, of `samples` samples.
    """
    known = values[np.isfinite(values)]
    if not known.size:
        return Spread(Interval(np.nan, np.nan, np.nan), np.nan, np.nan, np.nan)
    means = np.concatenate([known[rows].mean(axis=1) for rows in _rows(known, samples, generator)])
    p50, p95 = np.percentile(known, (50, 95))
    return Spread(_interval(float(known.mean()), means), float(p50), float(p95), float(known.max()))


class Gap(NamedTuple):
    """What one of three paired controllers closes of the gap between the other two."""

    radial_mean: Interval
    """Gap in the mean of `radial_mean`."""
    last_hole_p95: Interval
    """Gap in the 95th percentile of `last_hole_peak`."""


def gap_closed(
    of: Measured, tuned: Measured, bound: Measured, samples: int, generator: np.random.Generator
) -> Gap:
    """Share of the gap from `tuned` to `bound` that `of` closes: 0 is `tuned`, 1 is `bound`.

    Plants are drawn together with all three of their insertions, so that what is common to them
    does not widen the interval.
    """
    three = (of, tuned, bound)
    mean = np.stack([m.values["radial_mean"] for m in three])
    peak = np.stack([m.values["last_hole_peak"] for m in three])
    shares: tuple[list[FloatArray], list[FloatArray]] = ([], [])
    for rows in _rows(mean[0], samples, generator):
        shares[0].append(_share(mean[:, rows].mean(axis=-1)))
        shares[1].append(_share(np.nanpercentile(peak[:, rows], 95, axis=-1)))
    return Gap(
        _interval(float(_share(mean.mean(axis=-1))), np.concatenate(shares[0])),
        _interval(float(_share(np.nanpercentile(peak, 95, axis=-1))), np.concatenate(shares[1])),
    )


def _share(three: FloatArray) -> FloatArray:
    of, tuned, bound = three
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.asarray((tuned - of) / (tuned - bound))


def _rows(values: FloatArray, samples: int, generator: np.random.Generator) -> list[IntArray]:
    """Numbers of insertions drawn again, (samples, n) in pieces."""
    n = len(values)
    sizes = [min(_CHUNK, samples - first) for first in range(0, samples, _CHUNK)]
    return [generator.integers(n, size=(size, n)) for size in sizes]


def _interval(value: float, drawn: FloatArray) -> Interval:
    tail = 50.0 * (1.0 - CONFIDENCE)
    low, high = np.percentile(drawn, (tail, 100.0 - tail))
    return Interval(value, float(low), float(high))
