"""A training by the analytic policy gradient as its files ask for it."""

from dataclasses import dataclass
from pathlib import Path

from pydantic import JsonValue

from drivers.contract.configuration.problems import Problems
from drivers.contract.configuration.yaml_loader import read_yaml
from learning.analytic.plant_batch import drawn_batch
from learning.analytic.settings import AnalyticSettings
from learning.policy.expert import Expert
from learning.randomisation.plant import PlantSettings


@dataclass(frozen=True, slots=True)
class AnalyticPlan:
    """What is trained, and on what."""

    settings: AnalyticSettings
    expert: Expert
    """That the policy corrects."""
    plants: PlantSettings
    """That the plants of training and judgement are drawn from."""

    def configuration(self) -> dict[str, JsonValue]:
        """Return what the plan asks for as JSON, SI units; where its files lie is no part of it."""
        return {
            "training": self.settings.model_dump(
                mode="json", exclude={"plants"}, exclude_none=True
            ),
            "plants": self.plants.model_dump(mode="json", exclude_none=True),
        }


def load_analytic(path: Path) -> AnalyticPlan:
    """Load the training at `path` and the plants that it names.

    Raises ConfigurationError, one line per problem, if one of the files cannot be used.
    """
    problems = Problems()
    _, values = read_yaml(path)
    settings = problems.validated(AnalyticSettings, values, path)
    if settings is None:
        raise problems.error()
    plants_path = path.parent / settings.plants
    _, plants_values = read_yaml(plants_path)
    plants = problems.validated(PlantSettings, plants_values, plants_path)
    if plants is None:
        raise problems.error()
    try:
        drawn_batch(plants.distribution(), 1, 0)
    except ValueError as error:
        problems.add(plants_path, str(error))
        raise problems.error() from error
    return AnalyticPlan(settings, settings.policy_expert, plants)
