"""What each ingredient of the look ahead is worth: the extended plants with one of them off.

Prints a table of means over seeds with 95 % intervals (Student's t over the seeds' means). Every
variant inserts the same plants with the same noise.
"""

import argparse
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from machine import cores, describe
from scipy.stats import t as student

from learning.evaluation.comparison import tuned
from learning.evaluation.contenders import Contender, LookAhead
from learning.evaluation.load import load_evaluation
from learning.evaluation.metrics import Thresholds, measured
from learning.evaluation.plant import drawn_plants
from learning.evaluation.trials import Workers, cases_of, workers

COMPARISON = Path(__file__).parents[1] / "config" / "evaluation" / "extended.yaml"
UNHEARD = 1e3
"""A noise so many times too large is a source that is not listened to."""


def variants(full: LookAhead) -> dict[str, LookAhead]:
    """The look ahead, whole and with one ingredient off."""
    s = full.settings

    def but(**changes: object) -> LookAhead:
        return replace(full, settings=s.model_copy(update=changes))

    return {
        "all of it": full,
        "no turns": but(turn_rad=0.0),
        "no torque": but(torque_noise_Nm=UNHEARD * s.torque_noise_Nm),
        "no force, torque alone": but(force_noise_N=UNHEARD * s.force_noise_N),
        "no commands: place by reports alone": but(
            step_std_m=UNHEARD * s.step_std_m, place_std_m=s.report_std_m
        ),
        "no short steps: 60 um always": but(axial_step_m=(s.axial_step_m[1], s.axial_step_m[1])),
        "no quantile: the mean belief decides": but(quantile=0.5),
        "no model error": but(model_error=0.0),
        "128 hypotheses": but(hypotheses=128),
        "3 moves": but(moves=3),
    }


def rows(
    contenders: Mapping[str, Contender], seeds: Sequence[int], plants: int, team: Workers
) -> dict[str, list[list[float]]]:
    """By contender and seed: success [%], steps, mean radial force and last hole's p95 [mN]."""
    evaluation = load_evaluation(COMPARISON)
    trial = evaluation.settings.trial
    thresholds = Thresholds(trial.step_s, trial.gentle_N)
    found: dict[str, list[list[float]]] = {name: [] for name in contenders}
    for seed in seeds:
        cases = cases_of(drawn_plants(evaluation.distribution, plants, seed), seed)
        records = team.insert([*contenders.values()], cases, trial.rules())
        for name, each in zip(contenders, records, strict=True):
            figures = measured(each, thresholds)
            found[name].append(
                [
                    100.0 * float(figures.is_success.mean()),
                    float(figures.values["steps"].mean()),
                    1e3 * float(figures.values["radial_mean"].mean()),
                    1e3 * float(np.nanpercentile(figures.values["last_hole_peak"], 95)),
                ]
            )
    return found


def cell(values: Sequence[float]) -> str:
    """Mean and half the 95 % interval over seeds."""
    half = student.ppf(0.975, len(values) - 1) * np.std(values, ddof=1) / np.sqrt(len(values))
    return f"{np.mean(values):.2f} ± {half:.2f}"


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=5)
    parser.add_argument("--plants", type=int, default=60, help="of each seed")
    chosen = parser.parse_args()
    evaluation = load_evaluation(COMPARISON)
    full = evaluation.entries["look_ahead"].contender
    if not isinstance(full, LookAhead):
        raise TypeError(f"look_ahead in {COMPARISON} is a {type(full).__name__}")
    with workers(cores()) as team:
        gain = tuned(evaluation, team, lambda what, count, total: None, ["tuned"])
        contenders = {**variants(full), "no belief: tuned P-controller": gain["tuned"]}
        found = rows(contenders, range(1, chosen.seeds + 1), chosen.plants, team)
    print(f"{describe()}\n{chosen.seeds} seeds with {chosen.plants} plants each\n")
    print("| | success [%] | steps | radial force, mean [mN] | last hole, p95 peak [mN] |")
    print("|---|---|---|---|---|")
    for name, values in found.items():
        print(f"| {name} | {' | '.join(cell(column) for column in zip(*values, strict=True))} |")


if __name__ == "__main__":
    main()
