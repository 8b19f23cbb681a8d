"""A mock cell on simulated time, and one who watches it."""

from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from controllers.control_loop import Subscriber
from controllers.messages import Severity, Tick
from drivers.contract.clock import ManualClock
from drivers.contract.messages import Vector3
from hil.cell import Cell
from hil.config import CellConfig, load_cell

CONFIG = Path(__file__).parents[2] / "config"
LIMITS_N = np.array([0.070, 0.100, 1.000])


@dataclass
class Watcher(Subscriber):
    """Keeps raw force less bias, verdicts and phases of every tick."""

    forces: list[Vector3] = field(default_factory=list)
    severities: list[Severity] = field(default_factory=list)
    depths: list[float] = field(default_factory=list)

    def on_tick(self, tick: Tick) -> None:
        sample, stage = tick.snapshot.sample, tick.snapshot.stage
        if sample is not None and stage is not None:
            fx, fy, fz = (
                w - b for w, b in zip(sample.wrench[:3], tick.snapshot.bias[:3], strict=True)
            )
            self.forces.append((fx, fy, fz))
            self.severities.append(tick.verdict.severity)
            self.depths.append(stage.pose.position[2])

    @property
    def force(self) -> NDArray[np.float64]:
        return np.array(self.forces)


def make_cell(
    controller: str = "expert",
    seed: int = 1,
    part: str = "paper_online",
    change: Callable[[CellConfig], CellConfig] = lambda config: config,
) -> tuple[Cell, Watcher, ManualClock]:
    clock = ManualClock()
    config = change(load_cell(CONFIG / "mock_cell.yaml", CONFIG / "parts" / f"{part}.yaml"))
    cell = Cell(config, controller, clock, np.random.default_rng(seed))
    watcher = Watcher()
    cell.follow(watcher)
    cell.connect()
    return cell, watcher, clock
