"""Plants to try insertions on: the shipped ones, and ones with an effect of their own."""

from dataclasses import replace

import numpy as np

from learning.evaluation.plant import Plant, drawn_plants
from learning.randomisation import load_randomisation
from simulator.effects.stage import StageEffects
from simulator.randomisation.plants import PlantDistribution
from tests.hil.config.cell_files import ROOT


def extended() -> PlantDistribution:
    return load_randomisation(ROOT / "config" / "randomisation" / "extended.yaml")


def plant(seed: int = 3) -> Plant:
    return drawn_plants(extended(), 1, seed)[0]


def exact(seed: int = 3, stage: StageEffects | None = None) -> Plant:
    """Without any noise; its stage ideal, or as given."""
    return replace(
        plant(seed),
        position_noise_m=np.zeros(3),
        force_noise=np.zeros(6),
        stage=stage or StageEffects(),
    )
