"""Records made by hand, and files of small comparisons."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from learning.evaluation.trial import Record

ROOT = Path(__file__).parents[3]

FILE = f"""\
plants: {{file: {ROOT}/config/randomisation/extended.yaml, count: 4, seed: 1}}
tuning: {{count: 2, seed: 2}}
trial:
  step_box_um: [20, 20, 60]
  turn_deg: 0.05
  force_limit_mN: [70, 100, 1000]
  start_depth_um: -20
  beyond_um: 300
  steps_max: 1000
  sensor_um: [0, 0, 40000]
  step_time_ms: 100
  gentle_force_mN: 44
bootstrap: {{samples: 100, seed: 0}}
figures: {{insertions: 3, compared: [mild, privileged]}}
controllers:
  mild: {{kind: proportional, force_jacobian_um_N: 800, lambda: 0.05, axial_step_um: 60}}
  tuned: {{kind: tuned, gain_um_N: [20, 80], axial_step_um: 60}}
  admittance:
    kind: admittance
    lateral_um_N: [40, 80]
    axial_um_N: [200, 400]
    lag_steps: [0.4, 0.8]
    axial_step_um: 60
  look_ahead:
    kind: look_ahead
    position_error_um: 10
    tilt_error_deg: 0.3
    stiffness_mN_um: [2, 12]
    clearance_um: [2, 14]
    friction: [0.1, 0.3]
    force_noise_mN: 2
    torque_noise_uNm: 10
    place_std_um: 0.1
    report_std_um: 0.5
    step_std_um: 0.02
    model_error_percent: 5
    axial_step_um: [2.5, 60]
    turn_deg: 0.05
    force_budget_mN: 8
    quantile: 0.9
    hypotheses: 64
    moves: 1
    samples: 16
  skill: {{kind: skill, policy: {ROOT}/policies/paper.safetensors}}
  privileged: {{kind: privileged, tilt: false}}
  bound: {{kind: privileged, tilt: true}}
"""


def record(
    forces_mN: Sequence[tuple[float, float, float]],
    depths_um: Sequence[float],
    torques_uNm: Sequence[tuple[float, float]] | None = None,
    is_inserted: bool = True,
) -> Record:
    """An insertion with these loads after its steps; the last hole begins at 2 mm."""
    count = len(forces_mN)
    poses, wrenches = np.zeros((count, 5)), np.zeros((count, 6))
    poses[:, 2] = np.array(depths_um) * 1e-6
    wrenches[:, :3] = np.array(forces_mN) * 1e-3
    if torques_uNm is not None:
        wrenches[:, 3:5] = np.array(torques_uNm) * 1e-6
    return Record(poses, wrenches, 2e-3, (0.07, 0.1, 1.0), is_inserted, 0)


def radial_record(*forces_mN: float) -> Record:
    """An insertion of these forces along x, the last of them in the last hole."""
    depths = [*range(100, 100 * len(forces_mN), 100), 2100]
    return record([(f, 0.0, 0.0) for f in forces_mN], depths)
