"""The supervisor's rules on where stage, arm and part are. Limits are literals."""

import math

import pytest

from controllers.faults import Memory
from controllers.messages import Rule, Severity
from controllers.supervisor import watch
from drivers.contract.messages import Pose, Vector3
from tests.controllers.builders import (
    HOLD_POSE,
    LIMITS,
    MS,
    NOW,
    arm,
    down,
    fires,
    gripper,
    snapshot,
    stage,
    up,
    watched,
)


@pytest.mark.parametrize(("speed_mm_s", "stops"), [(5.0, False), (5.0999, False), (5.1001, True)])
def test_measured_speed(speed_mm_s: float, stops: bool) -> None:
    """2 % above 5 mm/s, along any direction."""
    for direction in ((1.0, 0.0, 0.0), (0.0, -1.0, 0.0), (0.0, 0.6, 0.8)):
        velocity = tuple(speed_mm_s * 1e-3 * d for d in direction)
        assert fires(Rule.SPEED, Severity.STOP, stage=stage(velocity=velocity)) is stops


@pytest.mark.parametrize(("speed_deg_s", "stops"), [(1.0, False), (1.0199, False), (1.0201, True)])
def test_measured_angular_speed(speed_deg_s: float, stops: bool) -> None:
    for direction in ((1.0, 0.0, 0.0), (0.0, 0.6, -0.8)):
        velocity = tuple(math.radians(speed_deg_s) * d for d in direction)
        assert fires(Rule.SPEED, Severity.STOP, stage=stage(angular_velocity=velocity)) is stops


@pytest.mark.parametrize(
    ("axis", "low_um", "high_um"), [(0, -200, 200), (1, -200, 200), (2, -1000, 3600)]
)
def test_measured_place_may_leave_the_workspace_by_one_micrometre(
    axis: int, low_um: float, high_um: float
) -> None:
    for place_um, stops in (
        (low_um - 1.01, True),
        (low_um - 0.99, False),
        (high_um + 0.99, False),
        (high_um + 1.01, True),
    ):
        position = [0.0, 0.0, 0.0]
        position[axis] = place_um * 1e-6
        state = stage(pose=Pose((position[0], position[1], position[2])))
        assert fires(Rule.WORKSPACE, Severity.STOP, stage=state) is stops


@pytest.mark.parametrize(("tilt_deg", "stops"), [(0.5999, False), (0.6001, True)])
def test_measured_tilt(tilt_deg: float, stops: bool) -> None:
    rotation = (math.radians(tilt_deg) * 0.6, math.radians(tilt_deg) * -0.8, 0.0)
    state = stage(pose=Pose((0.0, 0.0, 0.0), rotation))
    assert fires(Rule.WORKSPACE, Severity.STOP, stage=state) is stops


@pytest.mark.parametrize(("depth_um", "inside"), [(-100.01, False), (-99.99, True)])
def test_inside_the_part_the_arm_stays_and_the_part_is_held(depth_um: float, inside: bool) -> None:
    state = stage(depth_um * 1e-6)
    away = arm(pose=Pose((0.0, 3.1e-6, 4.1e-6)))
    near = arm(pose=Pose((0.0, 2.9e-6, 3.9e-6)))
    assert fires(Rule.KEEP_OUT, Severity.STOP, stage=state, arm=away) is inside
    assert not fires(Rule.KEEP_OUT, Severity.STOP, stage=state, arm=near)
    assert fires(Rule.KEEP_OUT, Severity.STOP, stage=state, arm=arm(moving=True)) is inside
    lost = gripper(part_held=False)
    assert fires(Rule.VACUUM, Severity.STOP, stage=state, gripper=lost) is inside
    let_go = gripper(valve_open=False, part_held=False)
    assert not fires(Rule.VACUUM, Severity.STOP, stage=state, gripper=let_go)


@pytest.mark.parametrize(
    ("distance_m", "stops"), [(4.99e-6, False), (5e-6, False), (5.01e-6, True)]
)
def test_distance_of_the_arm(distance_m: float, stops: bool) -> None:
    away = arm(pose=Pose((0.0, -distance_m, 0.0)))
    assert fires(Rule.KEEP_OUT, Severity.STOP, arm=away) is stops


@pytest.mark.parametrize(("depth_m", "inside"), [(-100e-6, False), (up(-100e-6), True)])
def test_the_clear_depth_itself_is_clear(depth_m: float, inside: bool) -> None:
    moving = arm(moving=True)
    assert fires(Rule.KEEP_OUT, Severity.STOP, stage=stage(depth_m), arm=moving) is inside


@pytest.mark.parametrize(("speed_m_s", "stops"), [(5.1e-3, False), (up(5.1e-3), True)])
def test_measured_speed_at_its_limit(speed_m_s: float, stops: bool) -> None:
    state = stage(velocity=(speed_m_s, 0.0, 0.0))
    assert fires(Rule.SPEED, Severity.STOP, stage=state) is stops


@pytest.mark.parametrize(("share", "stops"), [(1.02, False), (up(1.02), True)])
def test_measured_angular_speed_at_its_limit(share: float, stops: bool) -> None:
    state = stage(angular_velocity=(math.radians(1.0) * share, 0.0, 0.0))
    assert fires(Rule.SPEED, Severity.STOP, stage=state) is stops


@pytest.mark.parametrize(
    ("x_m", "stops"),
    [
        (-200.999e-6, False),
        (-200e-6 - 1e-6, False),
        (down(-200e-6 - 1e-6), True),
        (-201.001e-6, True),
        (200.999e-6, False),
        (200e-6 + 1e-6, False),
        (up(200e-6 + 1e-6), True),
        (201.001e-6, True),
    ],
)
def test_measured_place_at_its_limit(x_m: float, stops: bool) -> None:
    state = stage(pose=Pose((x_m, 0.0, 0.0)))
    assert fires(Rule.WORKSPACE, Severity.STOP, stage=state) is stops


@pytest.mark.parametrize(("tilt_rad", "stops"), [(math.radians(0.6), False), (0.0104719756, True)])
def test_measured_tilt_at_its_limit(tilt_rad: float, stops: bool) -> None:
    state = stage(pose=Pose((0.0, 0.0, 0.0), (0.0, tilt_rad, 0.0)))
    assert fires(Rule.WORKSPACE, Severity.STOP, stage=state) is stops


@pytest.mark.parametrize(
    ("rotation", "y_um", "stops"),
    [
        # 5 um on a lever of 4 mm are 1.25 mrad
        ((1.249e-3, 0.0, 0.0), 0.0, False),
        ((1.251e-3, 0.0, 0.0), 0.0, True),
        ((0.0, -1.251e-3, 0.0), 0.0, True),
        ((0.0, 0.0, 1.251e-3), 0.0, True),
        ((0.0, 0.75e-3, -1.0e-3), 0.01, True),
        ((0.5e-3, 0.0, 0.0), 2.99, False),
        ((0.5e-3, 0.0, 0.0), 3.01, True),
        ((0.5, 0.0, 0.0), 0.0, True),
        ((2.0 * math.pi, -4.0 * math.pi, 1e-3), 0.0, False),
    ],
)
def test_a_turn_of_the_arm_counts_with_the_lever(
    rotation: Vector3, y_um: float, stops: bool
) -> None:
    turned = arm(pose=Pose((0.0, y_um * 1e-6, 0.0), rotation))
    assert fires(Rule.KEEP_OUT, Severity.STOP, arm=turned) is stops


def test_the_turn_of_the_arm_is_told_and_taken_from_its_hold_pose() -> None:
    turned = snapshot(arm=arm(pose=Pose((0.0, 3e-6, 4e-6), (0.0, math.radians(0.5), 0.0))))
    verdict, _ = watch(LIMITS, HOLD_POSE, Memory(), turned, None)
    assert [str(r) for r in verdict.reasons] == [
        "arm and stage keep-out: stage in the part, "
        "arm 5.0 um and 0.500 deg from where it holds the part"
    ]
    aslant = Pose((1.0, 2.0, 3.0), (0.3, -0.5, 0.7))
    verdict, _ = watch(LIMITS, aslant, Memory(), snapshot(arm=arm(pose=aslant)), None)
    assert verdict.reasons == ()


@pytest.mark.parametrize("axis", range(3))
@pytest.mark.parametrize("sign", [-1.0, 1.0])
@pytest.mark.parametrize(
    ("way_um", "turn_mrad", "stops"),
    [
        # 4 ms at 5.1 mm/s and 1 um; 4 ms at 1.02 deg/s and 0.25 mrad
        (21.39, 0.0, False),
        (21.41, 0.0, True),
        (1000.0, 0.0, True),
        (0.0, 0.3211, False),
        (0.0, 0.3213, True),
    ],
)
def test_a_stage_that_is_where_it_cannot_be_yet_stops(
    axis: int, sign: float, way_um: float, turn_mrad: float, stops: bool
) -> None:
    """Whatever speed it reports; time counts from its state before to now."""
    position, rotation = [0.0, 0.0, 1e-3], [0.0, 0.0, 0.0]
    position[axis] += sign * way_um * 1e-6
    rotation[axis] = sign * turn_mrad * 1e-3
    before = Memory(NOW - MS, stage=stage(stamp_ns=NOW - 4 * MS))
    there = Pose((position[0], position[1], position[2]), (rotation[0], rotation[1], rotation[2]))
    seen = stage(pose=there, stamp_ns=NOW - 2 * MS)
    assert fires(Rule.SPEED, Severity.STOP, memory=before, stage=seen) is stops


@pytest.mark.parametrize(
    ("there", "stops"),
    [
        (Pose((1e-6, 0.0, 0.0)), False),
        (Pose((up(1e-6), 0.0, 0.0)), True),
        (Pose((0.0, 0.0, 0.0), (0.0, 1e-6 / 4e-3, 0.0)), False),
        (Pose((0.0, 0.0, 0.0), (0.0, up(1e-6 / 4e-3), 0.0)), True),
    ],
)
def test_a_leap_at_its_limit(there: Pose, stops: bool) -> None:
    before = Memory(NOW - MS, stage=stage(pose=Pose()))
    assert fires(Rule.SPEED, Severity.STOP, memory=before, stage=stage(pose=there)) is stops


def test_a_leap_of_the_stage_is_told() -> None:
    before = Memory(NOW - MS, stage=stage(stamp_ns=NOW - MS))
    verdict, memory = watched(before, stage=stage(2e-3))
    assert [str(r) for r in verdict.reasons] == [
        "speed limit: stage displaced by 1000.0 um and 0.0000 deg, faster than its limit"
    ]
    assert memory.stage == stage(2e-3)


def test_a_state_from_the_future_makes_no_way_of_its_own() -> None:
    """A second ahead is too far for a state to be believed, but the stage has not moved."""
    before = Memory(NOW - MS, stage=stage(stamp_ns=NOW + 1000 * MS))
    assert not fires(Rule.SPEED, Severity.STOP, memory=before)
