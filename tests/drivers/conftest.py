"""One mock world and its clock; every backend of a device class passes the same suite."""

import math
from collections.abc import Callable

import numpy as np
import pytest

from drivers.arm.mock import MockArm, MockArmSettings
from drivers.contract.clock import ManualClock
from drivers.contract.interfaces import Arm, ForceSensor, Gripper, Stage
from drivers.contract.messages import Pose
from drivers.force_sensor.mock import MockForceSensor, MockForceSensorSettings
from drivers.gripper.mock import MockGripper, MockGripperSettings
from drivers.mock_world import MockWorld, WorldSettings
from drivers.stage.mock import MockStage, MockStageSettings
from simulator.contact import ContactLaw
from simulator.geometry import Hole, Part, Shaft

TRAY = Pose((0.05, 0.0, 0.02))


@pytest.fixture
def clock() -> ManualClock:
    return ManualClock(1_000_000_000)


@pytest.fixture
def make_world() -> Callable[[int], MockWorld]:
    def make(seed: int) -> MockWorld:
        return MockWorld(
            WorldSettings(
                shaft=Shaft(1e-3, 4e-3),
                part=Part((Hole(1.01e-3, 0.5e-3), Hole(1.01e-3, 0.5e-3, 2.5e-3))),
                law=ContactLaw(4e3, 0.2),
                position_error_m=2e-6,
                tilt_error_rad=math.radians(0.1),
                stage_start=Pose((0.0, 0.0, -300e-6)),
                tray=TRAY,
            ),
            np.random.default_rng(seed),
        )

    return make


@pytest.fixture
def world(make_world: Callable[[int], MockWorld]) -> MockWorld:
    return make_world(1)


SENSOR = MockForceSensorSettings.model_validate(
    {
        "rate_Hz": 1000.0,
        "force_noise_uN_rtHz": 44.7,
        "torque_noise_nNm_rtHz": 223.6,
        "bias_mN": (12.0, -7.0, 30.0),
        "force_resolution_mN": 0.2,
        "torque_resolution_uNm": 1.0,
        "force_range_mN": 200.0,
        "torque_range_uNm": 10_000.0,
        "origin_um": (0.0, 0.0, 40_000.0),
    }
)
STAGE = MockStageSettings.model_validate(
    {
        "telemetry_rate_Hz": 500.0,
        "speed_limit_mm_s": 5.0,
        "angular_speed_limit_deg_s": 1.0,
        "travel_um": (500.0, 500.0, 4000.0),
        "acceleration_mm_s2": 1000.0,
    }
)
ARM = MockArmSettings.model_validate({"telemetry_rate_Hz": 125.0, "acceleration_mm_s2": 500.0})
GRIPPER = MockGripperSettings.model_validate({"telemetry_rate_Hz": 125.0, "vacuum_rise_ms": 40.0})


SENSORS = {"mock": lambda clock, world: MockForceSensor(SENSOR, clock, world)}
STAGES = {"mock": lambda clock, world: MockStage(STAGE, clock, world)}
ARMS = {"mock": lambda clock, world: MockArm(ARM, clock, world)}
GRIPPERS = {"mock": lambda clock, world: MockGripper(GRIPPER, clock, world)}


@pytest.fixture(params=SENSORS)
def sensor(request: pytest.FixtureRequest, clock: ManualClock, world: MockWorld) -> ForceSensor:
    return SENSORS[request.param](clock, world)


@pytest.fixture(params=STAGES)
def stage(request: pytest.FixtureRequest, clock: ManualClock, world: MockWorld) -> Stage:
    return STAGES[request.param](clock, world)


@pytest.fixture(params=ARMS)
def arm(request: pytest.FixtureRequest, clock: ManualClock, world: MockWorld) -> Arm:
    return ARMS[request.param](clock, world)


@pytest.fixture(params=GRIPPERS)
def gripper(request: pytest.FixtureRequest, clock: ManualClock, world: MockWorld) -> Gripper:
    return GRIPPERS[request.param](clock, world)
