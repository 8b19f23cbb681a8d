"""Free parameters of a controller: those with the least mean radial force on training plants."""

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from learning.evaluation.contenders import Admittance, Contender, Proportional
from learning.evaluation.metrics import mean_radial_force
from learning.evaluation.settings import AdmittanceSettings, TunedSettings
from learning.evaluation.trial import Record

_PLACES = 7
"""Values of a parameter that are tried at a time."""
_ROUNDS = 3
"""Each narrows every parameter to the neighbours of its best value."""

Ends = tuple[float, float]
Judge = Callable[[Sequence[Contender]], Sequence[Sequence[Record]]]
"""Inserts all training plants by each contender."""

TRIED = {"tuned": _PLACES * _ROUNDS, "admittance": 3 * _PLACES * _ROUNDS}
"""Controllers that are tried in tuning one of a kind."""


def tune(settings: TunedSettings | AdmittanceSettings, judge: Judge) -> Contender:
    """The best controller of its kind; raises `ValueError` where none inserts all plants."""
    if isinstance(settings, TunedSettings):
        return _best(
            {"gain": settings.gain_um_N},
            lambda p: Proportional(p["gain"] * 1e-6, settings.axial_step_m),
            judge,
        )
    ends = {
        "lateral": settings.lateral_um_N,
        "axial": settings.axial_um_N,
        "lag": settings.lag_steps,
    }
    return _best(
        ends,
        lambda p: Admittance(
            p["lateral"] * 1e-6, p["axial"] * 1e-6, p["lag"], settings.axial_step_m
        ),
        judge,
    )


def _best(
    ends: Mapping[str, Ends], make: Callable[[Mapping[str, float]], Contender], judge: Judge
) -> Contender:
    """Search one parameter after the other by ratios, in rounds that narrow down."""
    around = dict(ends)
    best = {name: float(np.sqrt(low * high)) for name, (low, high) in ends.items()}
    least = np.inf
    for _ in range(_ROUNDS):
        for name in ends:
            low, high = around[name]
            values = np.geomspace(low, high, _PLACES)
            tried = [{**best, name: float(value)} for value in values]
            forces = [_force(records) for records in judge([make(each) for each in tried])]
            place = int(np.argmin(forces))
            if forces[place] < least:
                best, least = tried[place], forces[place]
            nearest = int(np.argmin(np.abs(np.log(values / best[name]))))
            around[name] = (
                float(values[max(nearest - 1, 0)]),
                float(values[min(nearest + 1, _PLACES - 1)]),
            )
    if not np.isfinite(least):
        raise ValueError("no values between the ends insert all training plants")
    return make(best)


def _force(records: Sequence[Record]) -> float:
    """Mean radial force [N]; infinite where a plant was not inserted: lingering is no merit."""
    if not all(record.is_inserted for record in records):
        return np.inf
    return float(np.mean([mean_radial_force(record) for record in records]))
