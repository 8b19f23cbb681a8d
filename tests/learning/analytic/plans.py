"""Small trainings and plants that several tests use."""

import copy
from pathlib import Path
from typing import Any

import numpy as np
import torch
import yaml
from torch import Tensor

from learning.analytic import closed_loop
from learning.analytic.closed_loop import ClosedLoop
from learning.analytic.contact import wrench_after
from learning.analytic.plan import AnalyticPlan, load_analytic
from learning.analytic.plant_batch import PlantBatch
from learning.networks import Actor
from simulator.checks import FloatArray
from tests.hil.config.cell_files import ROOT, flow

EXTENDED = ROOT / "config/training/extended.yaml"
PAPER = ROOT / "config/training/paper_analytic.yaml"
FILE, PLANTS = "training.yaml", "plants.yaml"
Values = dict[str, Any]


def values(path: Path = EXTENDED) -> Values:
    """A shipped training with small networks, few plants and few updates."""
    loaded: Values = yaml.safe_load(path.read_text(encoding="utf-8"))
    rate = float(loaded["actor"]["learning_rate"])  # YAML 1.1 reads 3e-3 as text
    small: Values = {"actor": {"hidden": [8, 8], "learning_rate": rate}, "plants": PLANTS}
    small |= {"pool": 16, "insertions": 8, "updates": 4, "judged": {"count": 4, "seed": 2001}}
    return loaded | small


def plant_values(name: str = "extended") -> Values:
    """A shipped file of plants."""
    path = ROOT / f"config/randomisation/{name}.yaml"
    loaded: Values = yaml.safe_load(path.read_text(encoding="utf-8"))
    return loaded


def quiet(plants: Values) -> Values:
    """The same plants without any noise."""
    still = copy.deepcopy(plants)
    still["force_sensor"] = {"rate_Hz": 1000}
    still.pop("stage", None)
    return still


def write(folder: Path, training: Values, plants: Values) -> Path:
    """Write both files; return the training's."""
    (folder / FILE).write_text(flow(training), encoding="utf-8")
    (folder / PLANTS).write_text(flow(plants), encoding="utf-8")
    return folder / FILE


def plan(folder: Path, training: Values, plants: Values) -> AnalyticPlan:
    return load_analytic(write(folder, training, plants))


def random_actor(loop: ClosedLoop, last_weight: float = 1.0) -> Actor:
    """An actor whose answers cover much of their range, or less of it."""
    with torch.random.fork_rng(devices=[]):
        torch.manual_seed(1)
        return Actor(loop.n_states, loop.n_actions, (8, 8), last_weight)


def zero_actor(loop: ClosedLoop) -> Actor:
    """An actor that leaves the expert alone."""
    return Actor(loop.n_states, loop.n_actions, (4,), 0.0)


class Watched:
    """Contact as a loop asks for it, kept: put in its place by `monkeypatch`."""

    def __init__(self) -> None:
        self.wrenches: list[FloatArray] = []
        """(n, 6), the first before any step."""
        self.steps: list[FloatArray] = []
        """(n, 3 or 5), as the wrenches."""
        self.poses: list[FloatArray] = []
        """(n, 5), after each step."""

    def __call__(self, pose: Tensor, step: Tensor, plants: PlantBatch) -> Tensor:
        found = wrench_after(pose, step, plants)
        made = step.detach().numpy().copy()
        self.wrenches.append(found.detach().numpy().copy())
        self.steps.append(made)
        self.poses.append(pose.detach().numpy() + np.pad(made, ((0, 0), (0, 5 - made.shape[1]))))
        return found


def watch(monkeypatch: Any) -> Watched:
    """See all that loops ask of the contact from now on."""
    watched = Watched()
    monkeypatch.setattr(closed_loop, "wrench_after", watched)
    return watched
