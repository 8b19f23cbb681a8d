"""What a training wrote about its rounds, read from TensorBoard's files."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from tensorboard.backend.event_processing.event_accumulator import EventAccumulator

from drivers.contract.errors import TrainingError
from simulator.checks import FloatArray

_FOLDER = "tensorboard"
_TAGS = {
    "success": "round/success",
    "steps": "round/steps",
    "reward_per_step": "round/reward_per_step",
    "peak_mN": "round/peak_radial_force_mN",
}


@dataclass(frozen=True, slots=True, eq=False)
class TrainingLog:
    """Numbers by round, each (rounds,)."""

    success: FloatArray
    """1 or 0."""
    steps: FloatArray
    reward_per_step: FloatArray
    peak_mN: FloatArray
    """Of the radial force."""


def read_training_log(folder: Path) -> TrainingLog:
    """Read what the training in `folder` wrote; raises TrainingError, naming what is missing."""
    scalars = folder / _FOLDER
    if not scalars.is_dir():
        raise TrainingError(f"{folder}: holds no folder {_FOLDER}, so it is of no training")
    events = EventAccumulator(str(scalars), size_guidance={"scalars": 0})
    events.Reload()
    known = events.Tags()["scalars"]
    if missing := [tag for tag in _TAGS.values() if tag not in known]:
        raise TrainingError(f"{scalars}: holds no {', '.join(missing)}")
    rows = {name: _by_round(events, tag) for name, tag in _TAGS.items()}
    if len({len(row) for row in rows.values()}) > 1:
        raise TrainingError(f"{scalars}: its numbers are of different rounds")
    return TrainingLog(**rows)


def _by_round(events: EventAccumulator, tag: str) -> FloatArray:
    """Return the last value of each round: a training that went on repeats some."""
    latest = {event.step: event.value for event in events.Scalars(tag)}
    return np.array([latest[step] for step in sorted(latest)])
