"""What every force sensor must do, and what the mock adds."""

from collections.abc import Callable
from itertools import pairwise

import numpy as np
import pytest

from drivers.arm.mock import MockArm
from drivers.contract.clock import ManualClock, SystemClock
from drivers.contract.errors import DeviceError, DeviceTimeoutError
from drivers.contract.interfaces import ForceSensor
from drivers.contract.messages import ForceSample, Pose, SensorStatus
from drivers.force_sensor.mock import MockForceSensor
from drivers.gripper.mock import MockGripper
from drivers.mock_world import MockWorld, WorldSettings
from drivers.stage.mock import MockStage
from simulator.contact import ContactLaw
from simulator.geometry import Hole, Part, Shaft
from tests.drivers.conftest import ARM, GRIPPER, SENSOR, STAGE, TRAY

MS = 1_000_000


def test_a_sensor_that_is_not_connected_says_so(sensor: ForceSensor) -> None:
    with pytest.raises(DeviceError, match="not connected"):
        sensor.read(0.01)


def test_samples_come_at_the_stated_rate_in_order(sensor: ForceSensor, clock: ManualClock) -> None:
    sensor.connect()
    samples = [sensor.read(0.01) for _ in range(100)]
    assert [s.sequence for s in samples] == list(range(100))
    assert {b.stamp_ns - a.stamp_ns for a, b in pairwise(samples)} == {MS}
    assert all(s.receipt_ns >= s.stamp_ns for s in samples)
    assert samples[-1].stamp_ns == clock.now_ns()
    assert sensor.rate_Hz == 1000.0


def test_a_late_reader_gets_every_sample(sensor: ForceSensor, clock: ManualClock) -> None:
    sensor.connect()
    first = sensor.read(0.01)
    clock.sleep_until_ns(clock.now_ns() + 10 * MS)
    late = [sensor.read(0.01) for _ in range(10)]
    assert [s.sequence for s in late] == list(range(1, 11))
    assert late[0].stamp_ns == first.stamp_ns + MS
    assert {s.receipt_ns for s in late} == {clock.now_ns()}


def test_no_sample_in_time_is_an_error_at_the_deadline(
    sensor: ForceSensor, clock: ManualClock
) -> None:
    sensor.connect()
    begin = clock.now_ns()
    with pytest.raises(DeviceTimeoutError, match=r"no force sample within 0\.4 ms"):
        sensor.read(0.0004)
    assert clock.now_ns() == begin + 400_000
    assert sensor.read(0.01).sequence == 0


def test_unloaded_it_reads_bias_and_the_stated_noise(sensor: ForceSensor) -> None:
    sensor.connect()
    wrenches = np.array([sensor.read(0.01).wrench for _ in range(4000)])
    stated = np.array(sensor.noise_std)
    bias = np.array([12e-3, -7e-3, 30e-3, 0, 0, 0])
    assert np.abs(wrenches.mean(axis=0) - bias).max() < 5.0 * (stated / np.sqrt(4000)).max()
    assert wrenches.std(axis=0) == pytest.approx(stated, rel=0.06)
    assert wrenches[:, :3] / 0.2e-3 == pytest.approx(np.rint(wrenches[:, :3] / 0.2e-3), abs=1e-6)


def test_close_may_be_repeated(sensor: ForceSensor) -> None:
    sensor.connect()
    sensor.close()
    sensor.close()
    with pytest.raises(DeviceError, match="not connected"):
        sensor.read(0.01)


def test_on_the_system_clock_samples_come_in_real_time(world: MockWorld) -> None:
    clock = SystemClock()
    sensor = MockForceSensor(SENSOR, clock, world)
    sensor.connect()
    begin = clock.now_ns()
    samples = [sensor.read(0.1) for _ in range(50)]
    assert clock.now_ns() - begin >= 50 * MS
    assert all(s.receipt_ns >= s.stamp_ns for s in samples)


def pressed(clock: ManualClock, world: MockWorld, offset_um: float) -> list[ForceSample]:
    """Samples while the shaft stands in the upper hole, pushed sideways by `offset_um`."""
    arm, gripper = MockArm(ARM, clock, world), MockGripper(GRIPPER, clock, world)
    stage, sensor = MockStage(STAGE, clock, world), MockForceSensor(SENSOR, clock, world)
    for device in (arm, gripper, stage, sensor):
        device.connect()
    gripper.set_valve(True)
    stage.move_to(Pose((offset_um * 1e-6, 0.0, 250e-6)), 5e-3, 0.01)
    while stage.state().moving:
        sensor.read(0.01)
    return [sensor.read(0.01) for _ in range(200)]


def test_the_force_follows_the_stage(clock: ManualClock, world: MockWorld) -> None:
    """Two points, 4 mN/um each, beyond 5 um of clearance; the alignment is good to 2 um."""
    wrenches = np.array([s.wrench for s in pressed(clock, world, 12.0)])
    force_x, force_z = wrenches[:, 0].mean() - 12e-3, wrenches[:, 2].mean() - 30e-3
    assert force_x == pytest.approx(8e3 * 7e-6, abs=8e3 * 2.5e-6)
    assert force_z == pytest.approx(0.2 * force_x, rel=0.1)


def test_saturation_is_marked(clock: ManualClock, world: MockWorld) -> None:
    samples = pressed(clock, world, 40.0)
    assert {s.status for s in samples} == {SensorStatus.SATURATED}
    assert max(abs(v) for s in samples for v in s.wrench[:3]) == pytest.approx(0.2)


def test_a_command_shows_in_the_very_next_samples(clock: ManualClock, world: MockWorld) -> None:
    """Samples made ahead are thrown away when the stage is commanded."""
    pressed(clock, world, 12.0)
    stage, sensor = MockStage(STAGE, clock, world), MockForceSensor(SENSOR, clock, world)
    sensor.connect()
    sensor.read(0.01)
    world.let_go()
    stage.connect()
    forces = np.array([sensor.read(0.01).wrench[0] for _ in range(5)])
    assert np.abs(forces - 12e-3).max() < 6e-3


def test_the_same_seed_gives_the_same_samples(make_world: Callable[[int], MockWorld]) -> None:
    runs = [pressed(ManualClock(10**9), make_world(seed), 12.0) for seed in (3, 3, 4)]
    assert runs[0] == runs[1]
    assert runs[0] != runs[2]


def test_the_truth_names_the_hole_whatever_their_number(clock: ManualClock) -> None:
    holes = (Hole(1.01e-3, 0.5e-3), Hole(1.01e-3, 0.5e-3, 0.5e-3), Hole(1.01e-3, 0.5e-3, 0.5e-3))
    settings = WorldSettings(
        Shaft(1e-3, 4e-3), Part(holes), ContactLaw(), 0.0, 0.0, Pose((0.0, 0.0, 2.2e-3)), TRAY
    )
    world = MockWorld(settings, np.random.default_rng(1))
    assert world.truth(clock.now_ns()) is None
    gripper, stage = MockGripper(GRIPPER, clock, world), MockStage(STAGE, clock, world)
    gripper.connect()
    gripper.set_valve(True)
    stage.connect()
    truth = world.truth(clock.now_ns())
    assert truth is not None
    assert truth.phase == "inserting into hole 3"
