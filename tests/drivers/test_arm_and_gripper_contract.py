"""What every arm and every vacuum gripper must do."""

import math

import pytest

from drivers.arm.mock import MockArm
from drivers.contract.clock import ManualClock
from drivers.contract.errors import CommandRefusedError, DeviceError
from drivers.contract.interfaces import Arm, Gripper
from drivers.contract.messages import Pose
from drivers.gripper.mock import MockGripper
from drivers.mock_world import MockWorld
from tests.drivers.conftest import ARM, GRIPPER, TRAY

MS = 1_000_000


def wait(clock: ManualClock, duration_ms: int) -> None:
    clock.sleep_until_ns(clock.now_ns() + duration_ms * MS)


def test_not_connected(arm: Arm, gripper: Gripper) -> None:
    for call in (
        arm.state,
        arm.halt,
        lambda: arm.move_to(Pose(), 0.05),
        gripper.state,
        lambda: gripper.set_valve(True),
    ):
        with pytest.raises(DeviceError, match="not connected"):
            call()


def test_the_arm_moves_in_time_and_refuses_a_second_move(arm: Arm, clock: ManualClock) -> None:
    """53.85 mm at 50 mm/s and 0.5 m/s^2: 0.1 s to either side and 0.977 s at speed."""
    arm.connect()
    arm.move_to(Pose(), 0.05)
    wait(clock, 600)
    state = arm.state()
    assert state.moving
    assert 0.0 < math.dist(state.pose.position, TRAY.position) < 0.05
    with pytest.raises(CommandRefusedError, match="moving"):
        arm.move_to(TRAY, 0.05)
    wait(clock, 600)
    assert not arm.state().moving
    assert arm.state().pose.position == pytest.approx((0.0, 0.0, 0.0), abs=1e-12)
    assert clock.now_ns() - arm.state().stamp_ns < 8 * MS


@pytest.mark.parametrize("speed", [0.0, -0.01, math.nan])
def test_the_arm_refuses_a_speed_that_is_none(arm: Arm, speed: float) -> None:
    arm.connect()
    with pytest.raises(CommandRefusedError, match="more than 0"):
        arm.move_to(Pose(), speed)
    assert not arm.state().moving


def test_the_arm_halts_within_its_braking_way(arm: Arm, clock: ManualClock) -> None:
    """From 50 mm/s at 0.5 m/s^2: 2.5 mm and 0.1 s."""
    arm.connect()
    arm.move_to(Pose(), 0.05)
    wait(clock, 400)
    arm.halt()
    began = arm.state().pose.position
    wait(clock, 110)
    arm.halt()
    assert not arm.state().moving
    assert math.dist(arm.state().pose.position, began) <= 2.5e-3 + 0.05 * 8e-3
    arm.close()
    arm.close()


def test_vacuum_builds_up_on_a_part_and_goes_at_once(gripper: Gripper, clock: ManualClock) -> None:
    gripper.connect()
    assert (gripper.state().valve_open, gripper.state().part_held) == (False, False)
    gripper.set_valve(True)
    assert (gripper.state().valve_open, gripper.state().part_held) == (True, False)
    wait(clock, 39)
    assert not gripper.state().part_held
    wait(clock, 9)
    assert gripper.state().part_held
    gripper.set_valve(False)
    assert (gripper.state().valve_open, gripper.state().part_held) == (False, False)


def test_away_from_the_tray_there_is_no_part(world: MockWorld, clock: ManualClock) -> None:
    arm, gripper = MockArm(ARM, clock, world), MockGripper(GRIPPER, clock, world)
    arm.connect()
    gripper.connect()
    arm.move_to(Pose(), 0.05)
    wait(clock, 2000)
    gripper.set_valve(True)
    wait(clock, 1000)
    assert (gripper.state().valve_open, gripper.state().part_held) == (True, False)


def test_opening_an_open_valve_does_not_pick_again(world: MockWorld, clock: ManualClock) -> None:
    gripper = MockGripper(GRIPPER, clock, world)
    gripper.connect()
    gripper.set_valve(True)
    version = world.version
    gripper.set_valve(True)
    assert world.version == version


def test_closing_the_connection_does_not_drop_the_part(
    gripper: Gripper, clock: ManualClock
) -> None:
    gripper.connect()
    gripper.set_valve(True)
    wait(clock, 50)
    gripper.close()
    gripper.close()
    gripper.connect()
    assert gripper.state().part_held
