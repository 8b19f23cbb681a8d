"""How a policy inserts plants that its training has not drawn."""

from collections.abc import Sequence

import numpy as np

from learning.analytic.plan import AnalyticPlan
from learning.evaluation.contenders import Skill
from learning.evaluation.metrics import Measured, Thresholds, measured
from learning.evaluation.plant import drawn_plants
from learning.evaluation.trials import Case, cases_of, insert_each
from learning.policy.policy import Policy


def judged_cases(plan: AnalyticPlan) -> list[Case]:
    """Draw the plants that the plan judges on; raises `ValueError` if a trial has none of them."""
    chosen = plan.settings.judged
    plants = drawn_plants(plan.plants.distribution(), chosen.count, chosen.seed)
    return cases_of(plants, chosen.seed)


def judged(policy: Policy, cases: Sequence[Case], plan: AnalyticPlan) -> Measured:
    """Insert the plants of `judged_cases`, as `learning/evaluate.py` does."""
    trial = plan.settings.trial
    records = insert_each(Skill(policy), cases, trial.rules())
    return measured(records, Thresholds(trial.step_s, trial.gentle_N))


def metrics(figures: Measured) -> dict[str, float]:
    """Return the figures that a policy's file states, forces in N."""
    values = figures.values
    in_last_N = values["last_hole_peak"][np.isfinite(values["last_hole_peak"])]
    found = {
        "insertions": len(figures.is_success),
        "succeeded": int(figures.is_success.sum()),
        "steps_mean": float(values["steps"].mean()),
        "radial_force_mean_N": float(values["radial_mean"].mean()),
        "radial_force_peak_p95_N": float(np.percentile(values["radial_peak"], 95)),
    }
    if len(in_last_N):
        found["last_hole_peak_p95_N"] = float(np.percentile(in_last_N, 95))
    return found
