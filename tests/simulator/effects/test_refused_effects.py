"""Invalid parameters and arguments are refused by name, with what is valid."""

from collections.abc import Callable

import numpy as np
import pytest

from simulator.effects import arm, sensor, stage
from simulator.effects.approach import approach
from simulator.effects.draws import standard_normals
from simulator.effects.flicker import Ladder, flicker
from simulator.effects.hysteresis import PrandtlIshlinskii
from simulator.effects.latency import full_of
from simulator.effects.vibration import VibrationMode

NAN, INF = float("nan"), float("inf")
ZEROS, ONES, ROWS = np.zeros(6), np.ones(6), np.ones((2, 6))
BELOW = np.array([0.0, 0.0, -1.0, 0.0, 0.0, 0.0])
BROKEN = np.array([0.0, NAN, 0.0, 0.0, 0.0, 0.0])
STAGE, ARM, SENSOR = stage.StageEffects(), arm.ArmEffects(), sensor.SensorEffects(1000.0)
RESTING = stage.at_rest(STAGE, ZEROS)
COLD = arm.cold(ARM, np.zeros(0))
WARM = sensor.warmed_up(SENSOR, ZEROS, np.zeros(0))

CASES: list[tuple[Callable[[], object], str]] = [
    (
        lambda: stage.StageEffects(minimum_step=BELOW),
        r"StageEffects.minimum_step is -1.0 at index \(2,\); it must be at least 0",
    ),
    (lambda: stage.StageEffects(backlash=BELOW), r"StageEffects.backlash is -1.0 at index \(2,\)"),
    (
        lambda: stage.StageEffects(backlash=BROKEN),
        r"StageEffects.backlash is nan at index \(1,\); every entry must be finite",
    ),
    (
        lambda: stage.StageEffects(repeatability=np.ones(5)),
        r"StageEffects.repeatability has shape \(5,\); it must be \(..., 6\)",
    ),
    (
        lambda: stage.StageEffects(settling_time_constant_s=-0.1),
        r"StageEffects.settling_time_constant_s is -0.1; it must be finite and at least 0",
    ),
    (lambda: PrandtlIshlinskii(-ROWS, 0.1 * ROWS), r"PrandtlIshlinskii.gaps is -1.0"),
    (lambda: PrandtlIshlinskii(ROWS, -ROWS), r"PrandtlIshlinskii.weights is -1.0"),
    (lambda: PrandtlIshlinskii(ONES, ONES), r"PrandtlIshlinskii.gaps has shape \(6,\)"),
    (lambda: PrandtlIshlinskii(ROWS, 0.1 * ONES), r"PrandtlIshlinskii.weights has shape \(6,\)"),
    (
        lambda: PrandtlIshlinskii(ROWS, np.full((3, 6), 0.1)),
        r"PrandtlIshlinskii.weights has shape \(3, 6\); .* the same K for gaps and weights",
    ),
    (
        lambda: PrandtlIshlinskii(ROWS, 0.6 * ROWS),
        r"PrandtlIshlinskii.weights sum to 1.2 on an axis; they may sum to at most 1",
    ),
    (lambda: stage.at_rest(STAGE, BROKEN), r"position is nan at index \(1,\)"),
    (lambda: stage.move(STAGE, BROKEN, RESTING, 0.0, ZEROS), r"command is nan at index \(1,\)"),
    (
        lambda: stage.move(STAGE, ROWS, RESTING, 0.0, ZEROS),
        r"command has shape \(2, 6\); it must be \(6,\)",
    ),
    (lambda: stage.move(STAGE, ZEROS, RESTING, 0.0, ROWS), r"draws has shape \(2, 6\)"),
    (
        lambda: stage.move(STAGE, ZEROS, RESTING, -1.0, ZEROS),
        r"elapsed_s is -1.0; it must be at least 0",
    ),
    (lambda: approach(ZEROS, ONES, NAN, 1.0), r"elapsed_s is nan"),
    (
        lambda: arm.ThermalDrift(0.0, ONES),
        r"ThermalDrift.time_constant_s is 0.0; it must be finite and greater than 0",
    ),
    (lambda: arm.ThermalDrift(NAN, ONES), r"ThermalDrift.time_constant_s is nan"),
    (lambda: arm.ThermalDrift(1.0, BROKEN), r"ThermalDrift.end is nan at index \(1,\)"),
    (lambda: arm.ArmEffects(walk_density=BELOW), r"ArmEffects.walk_density is -1.0"),
    (lambda: VibrationMode(0.0, 0.1, ONES), r"VibrationMode.frequency_Hz is 0.0"),
    (
        lambda: VibrationMode(10.0, 0.0, ONES),
        r"VibrationMode.damping_ratio is 0.0; it must lie inside \(0, 1\)",
    ),
    (lambda: VibrationMode(10.0, 1.0, ONES), r"VibrationMode.damping_ratio is 1.0"),
    (lambda: VibrationMode(10.0, NAN, ONES), r"VibrationMode.damping_ratio is nan"),
    (lambda: VibrationMode(10.0, 0.1, np.ones(3)), r"VibrationMode.rms has shape \(3,\)"),
    (lambda: arm.cold(ARM, np.zeros(2)), r"draws has shape \(2,\); it must be \(..., 0\)"),
    (lambda: arm.step(ARM, COLD, 0.0, ZEROS), r"dt_s is 0.0; it must be finite and greater"),
    (
        lambda: arm.step(ARM, COLD, 1.0, ROWS),
        r"draws has shape \(1, 2, 6\); it must be \('T', 6\)",
    ),
    (lambda: sensor.SensorEffects(0.0), r"SensorEffects.sample_rate_Hz is 0.0"),
    (
        lambda: sensor.SensorEffects(1.0, crosstalk=ONES),
        r"SensorEffects.crosstalk has shape \(6,\); it must be \(..., 6, 6\)",
    ),
    (
        lambda: sensor.SensorEffects(1.0, crosstalk=np.ones((3, 6))),
        r"SensorEffects.crosstalk has shape \(3, 6\)",
    ),
    (lambda: sensor.SensorEffects(1.0, crosstalk=np.eye(5)), r"SensorEffects.crosstalk has shape"),
    (lambda: sensor.SensorEffects(1.0, bias=BROKEN), r"SensorEffects.bias is nan"),
    (lambda: sensor.SensorEffects(1.0, noise_density=BELOW), r"SensorEffects.noise_density is -1"),
    (lambda: sensor.SensorEffects(1.0, resolution=BELOW), r"SensorEffects.resolution is -1.0"),
    (lambda: sensor.SensorEffects(1.0, range=ZEROS), r"SensorEffects.range is .* greater than 0"),
    (lambda: sensor.SensorEffects(1.0, range=BROKEN + 1.0), r"SensorEffects.range is .*nan"),
    (lambda: sensor.SensorEffects(1.0, range=np.ones(2)), r"SensorEffects.range is .* shape"),
    (
        lambda: sensor.SensorEffects(1.0, latency_samples=-0.5),
        r"SensorEffects.latency_samples is -0.5; it must be finite and at least 0",
    ),
    (lambda: sensor.SensorEffects(1.0, latency_samples=INF), r"SensorEffects.latency_samples is"),
    (lambda: full_of(ZEROS, -1.0), r"latency_samples is -1.0"),
    (lambda: Ladder((1.0, 0.0), ONES), r"Ladder.corners_Hz\[1\] is 0.0"),
    (lambda: Ladder((1.0,), BELOW), r"Ladder.rms is -1.0 at index \(2,\)"),
    (lambda: flicker(ONES, (1.0, 1.0)), r"band_Hz is \(1.0, 1.0\); it must be \(low, high\)"),
    (lambda: flicker(ONES, (0.0, 1.0)), r"band_Hz is \(0.0, 1.0\)"),
    (lambda: flicker(ONES, (1.0, INF)), r"band_Hz is \(1.0, inf\)"),
    (lambda: flicker(BELOW, (1.0, 2.0)), r"density_at_1_Hz is -1.0 at index \(2,\)"),
    (lambda: sensor.warmed_up(SENSOR, BROKEN, np.zeros(0)), r"load is nan at index \(1,\)"),
    (lambda: sensor.warmed_up(SENSOR, ZEROS, ZEROS), r"draws has shape \(6,\)"),
    (
        lambda: sensor.sample(SENSOR, ROWS, WARM, ZEROS),
        r"loads has shape \(1, 2, 6\); it must be \('T', 6\)",
    ),
    (
        lambda: sensor.warmed_up(sensor.SensorEffects(1.0, bias=ROWS), ZEROS, np.zeros(0)),
        r"SensorEffects.bias is of a batch of shape \(2,\); the state's is \(\)",
    ),
    (
        lambda: sensor.warmed_up(sensor.SensorEffects(1.0, np.ones((3, 6, 6))), ROWS, ROWS[:, :0]),
        r"SensorEffects.crosstalk is of a batch of shape \(3,\); the state's is \(2,\)",
    ),
    (
        lambda: sensor.warmed_up(
            sensor.SensorEffects(9.0, drift=Ladder((1.0,), ROWS)), ZEROS, ZEROS
        ),
        r"Ladder.rms is of a batch of shape \(2,\)",
    ),
    (
        lambda: stage.at_rest(stage.StageEffects(backlash=ROWS), ZEROS),
        r"StageEffects.backlash is of a batch of shape \(2,\); the state's is \(\)",
    ),
    (
        lambda: stage.at_rest(
            stage.StageEffects(hysteresis=PrandtlIshlinskii(ROWS[np.newaxis], ROWS * 0.1)), ZEROS
        ),
        r"PrandtlIshlinskii.gaps is of a batch of shape \(1,\)",
    ),
    (
        lambda: arm.cold(arm.ArmEffects(walk_density=ROWS), np.zeros(0)),
        r"ArmEffects.walk_density is of a batch of shape \(2,\)",
    ),
    (
        lambda: arm.cold(arm.ArmEffects((arm.ThermalDrift(1.0, ROWS),)), np.zeros(0)),
        r"ThermalDrift.end is of a batch of shape \(2,\)",
    ),
    (
        lambda: arm.cold(arm.ArmEffects(modes=(VibrationMode(1.0, 0.1, ROWS),)), np.zeros(2)),
        r"VibrationMode.rms is of a batch of shape \(2,\)",
    ),
    (lambda: sensor.sample(SENSOR, ZEROS, WARM, BROKEN), r"draws is nan at index \(0, 1\)"),
    (lambda: standard_normals([], -1), r"count is -1; it must be at least 0"),
]


@pytest.mark.parametrize(("call", "message"), CASES, ids=[message for _, message in CASES])
def test_refused(call: Callable[[], object], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        call()
