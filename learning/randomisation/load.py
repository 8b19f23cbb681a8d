"""Loads the file that states what plants are drawn from."""

from pathlib import Path

from drivers.contract.configuration.problems import Problems
from drivers.contract.configuration.yaml_loader import read_yaml
from learning.randomisation.plant import PlantSettings
from simulator.randomisation.plants import PlantDistribution


def load_randomisation(path: Path) -> PlantDistribution:
    """Load the file at `path`; raises ConfigurationError, one line per problem, if it cannot."""
    problems = Problems()
    _, values = read_yaml(path)
    settings = problems.validated(PlantSettings, values, path)
    if settings is None:
        raise problems.error()
    return settings.distribution()
