"""The shipped policy for parts of which little is known is what its file trains, and is gentle."""

from pathlib import Path

import numpy as np
import pytest

from learning.analytic.judged import judged, judged_cases, metrics
from learning.analytic.plan import load_analytic
from learning.policy.file import read_policy

CONFIG = Path("config/training/extended.yaml")
SHIPPED = Path("policies/extended.safetensors")


def test_it_was_trained_as_the_files_say() -> None:
    about = read_policy(SHIPPED).manifest.about
    assert about["configuration"] == load_analytic(CONFIG).configuration()
    assert about["seed"] == 0
    assert about["updates"] == 1200


@pytest.mark.slow
def test_it_inserts_plants_of_which_little_is_known() -> None:
    """Gently, and with the forces that its file states."""
    stored, plan = read_policy(SHIPPED), load_analytic(CONFIG)
    figures = judged(stored.policy, judged_cases(plan), plan)
    assert metrics(figures) == pytest.approx(stored.manifest.about["metrics"], rel=1e-2)
    assert figures.is_success.mean() >= 0.995
    assert figures.values["steps"].mean() <= 60.0
    assert figures.values["radial_mean"].mean() < 1e-3
    assert np.percentile(figures.values["last_hole_peak"], 95) < 5e-3
