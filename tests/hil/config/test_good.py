"""The shipped files load, and every value arrives in SI units."""

import hashlib
import math
from pathlib import Path

import pytest
from pydantic import ValidationError

from controllers.governor import Travel, speed_cap
from controllers.settings import LookAheadControllerSettings, ProportionalSettings
from hil.config import CellConfig, load_cell
from hil.config.load import PolicyConfig
from simulator.contact import ContactLaw
from simulator.geometry import Hole, Part, Shaft
from tests.hil.config.cell_files import ROOT, Load, shipped
from tests.hil.config.key_table import CELL, LIMITS, PART


@pytest.fixture(scope="module")
def config() -> CellConfig:
    return load_cell(ROOT / CELL)


def test_limits(config: CellConfig) -> None:
    degree = math.radians(1.0)
    assert config.limits.model_dump() == {
        "speed_m_s": 0.005,
        "angular_speed_rad_s": degree,
        "arm_speed_m_s": 0.05,
        "step_m": (2e-5, 2e-5, 6e-5),
        "rotation_step_rad": pytest.approx(0.05 * degree, rel=1e-15),
        "workspace_min_m": (-2e-4, -2e-4, -1e-3),
        "workspace_max_m": (2e-4, 2e-4, 3.6e-3),
        "tilt_rad": pytest.approx(0.6 * degree, rel=1e-15),
        "clear_depth_m": -1e-4,
        "arm_tolerance_m": 5e-6,
        "force_N": (0.07, 0.1, 1.0),
        "force_rate_N_s": 40.0,
        "gentle_force_N": 0.044,
        "impulse_N_s": 0.01,
        "sample_age_s": 0.005,
        "device_age_s": 0.03,
        "proposal_age_s": 0.05,
        "heartbeat_s": 0.02,
        "reaction_s": 0.002,
        "deceleration_m_s2": 1.0,
        "radial_stiffness_N_m": 16_000.0,
        "axial_stiffness_N_m": 8_000.0,
        "lever_m": 0.004,
        "creep_speed_m_s": 1e-4,
        "uncertainty_sigmas": 3.0,
    }


def test_the_growth_limit_lies_between_a_governed_move_and_a_crash(config: CellConfig) -> None:
    """A crash into a wall is told one sample before the limit of 70 mN, not after it."""
    growth_N = config.limits.force_rate_N_s / config.force_sensor.settings.rate_Hz
    assert growth_N < 0.070
    zero = (0.0, 0.0, 0.0)
    moves = [(0.0, 0.0, 6e-5), (2e-5, 0.0, 0.0), (2e-5, 2e-5, 6e-5), (2e-5, 0.0, 2e-5)]
    fastest_N = max(
        speed_cap(config.limits, zero, zero, travel)
        * max(16e3 * travel.radial_m + 8e3 * travel.axial_m, 8e3 * travel.length_m)
        / travel.length_m
        * 1e-3
        for travel in (Travel.of(move, zero, 4e-3) for move in moves)
    )
    noise_N = 1e-3  # of a sample
    assert fastest_N + 8.0 * noise_N < growth_N


def test_devices(config: CellConfig) -> None:
    devices = (config.force_sensor, config.stage, config.arm, config.gripper)
    assert [device.backend for device in devices] == ["mock"] * 4
    assert config.force_sensor.settings.model_dump() == {
        "rate_Hz": 1000.0,
        "force_noise_N_rtHz": 4.47e-5,
        "torque_noise_Nm_rtHz": 2.236e-7,
        "bias_N": (0.012, -0.007, 0.03),
        "force_resolution_N": 2e-4,
        "torque_resolution_Nm": 1e-6,
        "force_range_N": 12.0,
        "torque_range_Nm": 0.12,
        "origin_m": (0.0, 0.0, 0.04),
        "latency_s": 0.0,
        "drift": None,
        "crosstalk": None,
    }
    assert config.stage.settings.model_dump() == {
        "speed_m_s": 0.005,
        "angular_speed_rad_s": math.radians(1.0),
        "acceleration_m_s2": 1.0,
        "telemetry_rate_Hz": 500.0,
        "travel_m": (5e-4, 5e-4, 4e-3),
        "minimum_step_m": 0.0,
        "minimum_step_rad": 0.0,
        "backlash_m": 0.0,
        "backlash_rad": 0.0,
        "hysteresis_gap_m": 0.0,
        "hysteresis_gap_rad": 0.0,
        "hysteresis_weight": 0.0,
        "repeatability_m": 0.0,
        "repeatability_rad": 0.0,
        "settling_time_constant_s": 0.0,
    }
    assert config.arm.settings.model_dump() == {
        "telemetry_rate_Hz": 125.0,
        "acceleration_m_s2": 0.5,
        "walk_m_rts": 0.0,
        "walk_rad_rts": 0.0,
        "thermal": (),
        "vibration": (),
    }
    assert config.gripper.settings.model_dump() == {
        "telemetry_rate_Hz": 125.0,
        "vacuum_rise_s": 0.04,
    }


def test_use_of_the_devices(config: CellConfig) -> None:
    assert config.arm_poses.model_dump() == {"hold_m": (0, 0, 0), "tray_m": (0.1, 0, 0.05)}
    assert config.filter.model_dump() == {
        "force_acceleration_std_N_s2": 100.0,
        "torque_acceleration_std_Nm_s2": 1.0,
        "gate_probability": 0.99999,
        "rejections_max": 2,
        "tare_samples": 100,
        "bias_change_max_N": 0.005,
    }
    assert config.skill.model_dump() == {
        "start_depth_m": -3e-4,
        "settle_s": 0.01,
        "hold_timeout_s": 0.5,
        "contact_force_N": 0.01,
    }
    for name, gain in (("expert", 0.2), ("p", 1.0)):
        choice = config.controllers[name]
        assert isinstance(choice, ProportionalSettings)
        assert choice.model_dump() == {
            "kind": "proportional",
            "force_jacobian_m_N": 8e-4,
            "gain_factor": gain,
        }


def test_the_look_ahead(config: CellConfig) -> None:
    choice = config.controllers["look_ahead"]
    assert isinstance(choice, LookAheadControllerSettings)
    assert choice.model_dump() == {
        "kind": "look_ahead",
        "stiffness_N_m": (2e3, 12e3),
        "clearance_m": (2e-6, 14e-6),
        "friction": (0.1, 0.3),
        "place_std_m": pytest.approx(2e-7, rel=1e-15),
        "report_std_m": pytest.approx(1e-7, rel=1e-15),
        "step_std_m": pytest.approx(1e-7, rel=1e-15),
        "model_error": 0.02,
        "axial_step_m": (2.5e-6, 6e-5),
        "force_budget_N": 0.008,
        "quantile": 0.9,
        "hypotheses": 512,
        "moves": 8,
        "samples": 128,
    }


@pytest.mark.parametrize(
    ("pair_um", "steps_um"),
    [
        ([2.5, 60], [60, 30, 15, 7.5, 3.75, 2.5]),
        ([5, 40], [40, 20, 10, 5]),
        ([40, 60], [60, 40]),
        ([60, 60], [60]),
    ],
)
def test_the_longest_step_is_halved_down_to_the_shortest(
    pair_um: list[float], steps_um: list[float], load: Load
) -> None:
    files = shipped()
    files[CELL]["controllers"]["look_ahead"]["axial_step_um"] = pair_um
    choice = load(files).controllers["look_ahead"]
    assert isinstance(choice, LookAheadControllerSettings)
    assert choice.axial_steps_m == pytest.approx([s * 1e-6 for s in steps_um], rel=1e-12)


def test_a_policy_is_found_beside_the_cell(load: Load) -> None:
    choice = load(shipped()).controllers["skill"]
    assert isinstance(choice, PolicyConfig)
    assert choice.path == Path("config/../policies/zero.safetensors")
    assert choice.stored.sha256 == hashlib.sha256(choice.path.read_bytes()).hexdigest()
    assert choice.stored.policy.expert.step_box_m == (2e-5, 2e-5, 6e-5)


@pytest.mark.parametrize(
    ("name", "gap_m", "error_m", "tilt_deg", "stroke_m", "axial_step_m"),
    [
        ("paper_online", 2.5e-3, 2e-6, 0.1, 3.2e-3, 6e-5),
        ("paper_simulation", 1.5e-3, 1e-5, 0.3, 2.3e-3, 5e-5),
    ],
)
def test_parts(
    name: str, gap_m: float, error_m: float, tilt_deg: float, stroke_m: float, axial_step_m: float
) -> None:
    part = load_cell(ROOT / CELL, ROOT / f"config/parts/{name}.yaml").part
    assert part.name == name
    assert part.simulated_shaft() == Shaft(diameter_m=1e-3, length_m=4e-3)
    upper = Hole(diameter_m=1.01e-3, thickness_m=5e-4, gap_m=0.0)
    lower = Hole(diameter_m=1.01e-3, thickness_m=5e-4, gap_m=gap_m)
    assert part.simulated_part() == Part(holes=(upper, lower))
    assert part.contact_law() == ContactLaw(stiffness_N_m=4000.0, friction=0.2)
    assert part.alignment.position_error_m == error_m
    assert part.alignment.tilt_error_rad == pytest.approx(math.radians(tilt_deg), rel=1e-15)
    assert part.insertion.model_dump() == {
        "stroke_m": stroke_m,
        "steps_max": 1000,
        "finish_force_N": 1.0,
        "axial_step_m": axial_step_m,
    }
    assert all(value is None for value in part.limits.model_dump().values())


def test_sources_are_the_files_that_were_read() -> None:
    override = ROOT / "config/parts/paper_simulation.yaml"
    sources = load_cell(ROOT / CELL, override).sources
    assert [source.path for source in sources] == [ROOT / CELL, ROOT / LIMITS, override]
    for source in sources:
        content = source.path.read_bytes()
        assert source.text == content.decode()
        assert source.sha256 == hashlib.sha256(content).hexdigest()


def test_files_are_found_beside_the_cell(tmp_path: Path, load: Load) -> None:
    files = shipped()
    files[CELL]["limits"] = str(tmp_path / LIMITS)
    files[CELL]["part"] = "../config/parts/paper_online.yaml"
    assert [source.path for source in load(files).sources] == [
        Path(CELL),
        tmp_path / LIMITS,
        Path("config/../config/parts/paper_online.yaml"),
    ]


def test_part_tightens_the_machine(load: Load) -> None:
    files = shipped()
    files[PART]["limits"] = {"speed_limit_mm_s": 2, "force_limit_mN": [50, 100, 1000]}
    limits = load(files).limits
    assert limits.speed_m_s == 0.002
    assert limits.force_N == (0.05, 0.1, 1.0)
    assert limits.gentle_force_N == 0.044


def test_one_hole_and_a_chain_of_three(load: Load) -> None:
    wall = {"diameter_um": 1010, "thickness_um": 500}
    files = shipped()
    files[PART]["holes"] = [wall]
    assert len(load(files).part.simulated_part().holes) == 1
    gap = {**wall, "gap_um": 1000}
    files[PART]["holes"] = [{**wall, "gap_um": 0}, gap, gap]
    assert len(load(files).part.simulated_part().holes) == 3


def test_frozen(config: CellConfig) -> None:
    with pytest.raises(ValidationError, match="frozen"):
        config.limits.speed_m_s = 1.0  # type: ignore[misc]  # must fail: it is frozen
    with pytest.raises(AttributeError):
        config.limits = config.limits  # type: ignore[misc]  # must fail: it is frozen
