"""Plants as the contact engine takes them, many at once."""

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from learning.evaluation.plant import generators_of, unsteady_effects
from simulator.checks import FloatArray
from simulator.engine.solve import solve
from simulator.engine.table import Table, tabulate
from simulator.randomisation.plants import PlantDistribution, Plants, draw_plants


@dataclass(frozen=True, slots=True, eq=False)
class PlantBatch:
    """n rigid plants, SI units; only alignment, part and noise differ from one to the next."""

    table: Table
    geometry: npt.NDArray[np.int64]
    """(n,): row of the table."""
    stiffness_N_m: FloatArray
    """(n,)."""
    friction: FloatArray
    """(n,)."""
    misalignment: FloatArray
    """(n, 5): see `Plants.misalignment`."""
    last_mouth_m: FloatArray
    """(n,): depth of the last hole's upper rim."""
    force_noise: FloatArray
    """(n, 6): standard deviation of a reading [N, N m]."""
    position_noise_m: FloatArray
    """(n, 3): standard deviation of the place that the stage reports."""

    def __len__(self) -> int:
        return len(self.geometry)

    def taken(self, rows: npt.NDArray[np.int64]) -> "PlantBatch":
        """Return the plants with these numbers (m,), in their order."""
        return replace(
            self,
            geometry=self.geometry[rows],
            stiffness_N_m=self.stiffness_N_m[rows],
            friction=self.friction[rows],
            misalignment=self.misalignment[rows],
            last_mouth_m=self.last_mouth_m[rows],
            force_noise=self.force_noise[rows],
            position_noise_m=self.position_noise_m[rows],
        )

    def wrenches(self, poses: FloatArray, travel: FloatArray) -> FloatArray:
        """Return the wrenches (m, n, 6) on the parts, about the origin of M.

        Of m poses (m, n, 5) of each shaft, reached by m translations (m, n, 3).
        """
        repeats = len(poses)
        found = solve(
            self.table,
            poses.reshape(-1, poses.shape[-1]),
            travel.reshape(-1, 3),
            stiffness_N_m=np.tile(self.stiffness_N_m, repeats),
            friction=np.tile(self.friction, repeats),
            geometry=np.tile(self.geometry, repeats),
        )
        return found.wrench.reshape(repeats, len(self), 6)


def drawn_batch(distribution: PlantDistribution, n: int, seed: int) -> PlantBatch:
    """Draw `n` plants, plant i from the seed and i alone.

    Raises `ValueError` for a distribution with effects that the gradient does not lead through.
    """
    plants = draw_plants(distribution, generators_of(seed, n))
    _refuse_effects(plants)
    parts = [plants.part(index) for index in range(n)]
    return PlantBatch(
        table=tabulate([(part, plants.shaft(index)) for index, part in enumerate(parts)]),
        geometry=np.arange(n),
        stiffness_N_m=plants.stiffness_N_m,
        friction=plants.friction,
        misalignment=plants.misalignment,
        last_mouth_m=np.array([part.wall_entries_m[-1] for part in parts]),
        force_noise=plants.sensor.noise_std,
        position_noise_m=plants.position_noise_m,
    )


def _refuse_effects(plants: Plants) -> None:
    stage, holder, crosstalk = plants.stage, plants.holders, plants.sensor.crosstalk
    effects = {
        **unsteady_effects(plants),
        "force_sensor.crosstalk": crosstalk is not None,
        "stage.minimum_step": bool(np.any(stage.minimum_step)),
        "stage.backlash": bool(np.any(stage.backlash)),
        "stage.hysteresis": bool(np.any(stage.hysteresis.weights)),
        "stage.repeatability": bool(np.any(stage.repeatability)),
        "holder": bool(np.any(holder.compliance) or np.isfinite(holder.holding_force).any()),
    }
    if names := [name for name, is_on in effects.items() if is_on]:
        raise ValueError(
            f"plants have {', '.join(names)}; the gradient leads through contact and alignment "
            "alone: leave them out"
        )
