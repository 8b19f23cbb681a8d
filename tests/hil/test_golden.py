"""One insertion of each controller as it was when somebody last looked: it shows what changes.

The sensor is quieter than the mock cell's, so that the tolerance means something. After a change
that is meant: python -m tests.hil.test_golden, and say in the commit why it moved.
"""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from controllers.control_loop import Subscriber
from controllers.messages import Observation, Proposal, Sent
from drivers.contract.clock import ManualClock
from hil.cell import Cell
from hil.config import load_cell

GOLDEN = {name: Path(__file__).with_name(f"golden_{name}.json") for name in ("expert", "skill")}
CONFIG = Path(__file__).parents[2] / "config"
FORCE_TOLERANCE_MN = 0.5
LENGTH_TOLERANCE_UM = 0.1

Row = dict[str, list[float]]


class Steps(Subscriber):
    """Keeps what was seen and sent at every step."""

    def __init__(self) -> None:
        self.rows: list[Row] = []
        self._observation: Observation | None = None

    def on_proposal(self, observation: Observation, proposal: Proposal) -> None:
        self._observation = observation

    def on_sent(self, sent: Sent) -> None:
        seen = self._observation
        assert seen is not None
        self.rows.append(
            {
                "force_mN": [round(f * 1e3, 3) for f in seen.wrench[:3]],
                "position_um": [round(p * 1e6, 3) for p in seen.pose.position],
                "sent_um": [round(t * 1e6, 3) for t in sent.translation],
            }
        )


def insertion(controller: str) -> list[Row]:
    config = load_cell(CONFIG / "mock_cell.yaml", CONFIG / "parts" / "paper_simulation.yaml")
    quiet = config.force_sensor.settings.model_copy(
        update={
            "force_noise_N_rtHz": 2.2e-6,
            "torque_noise_Nm_rtHz": 9e-9,
            "force_resolution_N": 1e-6,
            "torque_resolution_Nm": 1e-9,
        }
    )
    config = replace(config, force_sensor=replace(config.force_sensor, settings=quiet))
    cell = Cell(config, controller, ManualClock(), np.random.default_rng(1))
    steps = Steps()
    cell.follow(steps)
    cell.connect()
    cell.insert_part(1)
    return steps.rows


@pytest.mark.slow
@pytest.mark.parametrize("controller", sorted(GOLDEN))
def test_the_insertion_is_as_it_was(controller: str) -> None:
    rows, golden = insertion(controller), json.loads(GOLDEN[controller].read_text())
    assert len(rows) == len(golden)
    for row, before in zip(rows, golden, strict=True):
        assert row["force_mN"] == pytest.approx(before["force_mN"], abs=FORCE_TOLERANCE_MN)
        for name in ("position_um", "sent_um"):
            assert row[name] == pytest.approx(before[name], abs=LENGTH_TOLERANCE_UM)


if __name__ == "__main__":
    for name, path in GOLDEN.items():
        lines = ",\n".join(json.dumps(row) for row in insertion(name))
        path.write_text(f"[\n{lines}\n]\n")
