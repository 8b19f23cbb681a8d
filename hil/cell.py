"""A cell put together from its configuration, and the cycle that inserts one part.

Composition happens here and nowhere else: devices, filter, supervisor's gate, loop and skill.
"""

import math
from collections.abc import Callable
from contextlib import ExitStack
from dataclasses import dataclass
from functools import partial
from typing import cast

import numpy as np

from controllers.control_loop import ControlLoop, Subscriber
from controllers.force_filter import ForceFilter
from controllers.gate import Gate
from controllers.insertion import InsertionSkill
from controllers.messages import ResetRecord, Severity, SkillPhase, Tick
from drivers.backends import DeviceClass, device_class
from drivers.contract.clock import Clock
from drivers.contract.errors import DeviceTimeoutError, SafetyError
from drivers.contract.interfaces import Arm, Device, ForceSensor, Gripper, Stage
from drivers.contract.messages import Pose
from drivers.mock_world import MockWorld, WorldSettings
from hil.config import CellConfig, DeviceConfig
from hil.config.load import DeviceSettings
from hil.controller_factory import controller_factory

_VACUUM_TIMEOUT_S = 2.0
_ARM_TIMEOUT_S = 30.0
_REST_TIMEOUT_S = 1.0
_CALM_S = 0.05
"""Rest before a bias is taken, after the part is let go, and at the end of an interrupted run."""


@dataclass(frozen=True, slots=True)
class Outcome:
    """How an insertion ended."""

    number: int
    phase: SkillPhase
    reason: str
    """Why it failed, or why the shaft could not be taken out afterwards; empty if all went well."""
    steps: int
    is_clear: bool
    """Whether the cell has put the part away and is ready for the next one."""


class Cell:
    """Inserts one part after another. Close it, whatever happened: that brings it to rest."""

    def __init__(
        self,
        config: CellConfig,
        controller: str,
        clock: Clock,
        generator: np.random.Generator,
    ) -> None:
        """Build the cell.

        Raises ConfigurationError for a controller that the configuration does not name, one whose
        policy does not fit the limits, or a backend that cannot be imported.
        """
        self._config = config
        self._controller_name = controller
        self._hold_pose = Pose(config.arm_poses.hold_m)
        self._tray_pose = Pose(config.arm_poses.tray_m)
        self._start = Pose((0.0, 0.0, config.skill.start_depth_m))
        self.world = MockWorld(
            WorldSettings(
                config.part.simulated_shaft(),
                config.part.simulated_part(),
                config.part.contact_law(),
                config.part.alignment.position_error_m,
                config.part.alignment.tilt_error_rad,
                self._start,
                self._tray_pose,
            ),
            generator,
        )
        build = partial(_built, clock, self.world)
        sensor = cast(ForceSensor, build(DeviceClass.FORCE_SENSOR, config.force_sensor))
        stage = cast(Stage, build(DeviceClass.STAGE, config.stage))
        arm = cast(Arm, build(DeviceClass.ARM, config.arm))
        gripper = cast(Gripper, build(DeviceClass.GRIPPER, config.gripper))
        (chance,) = generator.spawn(1)
        self._new_controller = controller_factory(config, controller, sensor.noise_std, chance)
        self._devices: tuple[Device, ...] = (sensor, stage, arm, gripper)
        self._closing = ExitStack()
        self._gate = Gate(config.limits, self._hold_pose, stage, arm, gripper)
        period_s = 1.0 / sensor.rate_Hz
        self._loop = ControlLoop(
            clock,
            sensor,
            ForceFilter(config.filter, sensor.noise_std, period_s),
            self._gate,
            config.skill.settle_s,
        )

    def follow(self, subscriber: Subscriber) -> None:
        """Let `subscriber` follow the loop, after those before it."""
        self._loop.follow(subscriber)

    def connect(self) -> None:
        """Connect all devices; raises DeviceError where one cannot be reached."""
        for device in self._devices:
            self._closing.callback(device.close)
            device.connect()
        self._closing.callback(self._gate.hold)

    def insert_part(self, number: int) -> Outcome:
        """Pick a part, bring it, tare, insert, let go and withdraw, or put it back after a failure.

        Raises SafetyError and TareRefusedError where the cell is not in the state that the next
        action needs, and DeviceError where a device fails.
        """
        config = self._config
        self._switch_valve(True)
        self._move_arm(self._hold_pose)
        self._loop.wait(_CALM_S)
        self._loop.tare(config.filter.tare_samples, config.limits.clear_depth_m)
        skill = InsertionSkill(
            config.skill, config.part.insertion, self._new_controller(), config.limits.step_m
        )
        self._loop.insert(skill, number, self._controller_name)
        obstacle = self._latched() or self._put_away(skill.phase)
        return Outcome(
            number, skill.phase, skill.reason or obstacle, skill.steps, is_clear=not obstacle
        )

    def hold(self) -> None:
        """Bring everything to rest where it is, and turn the loop until that is on file."""
        self._gate.hold()
        self._turn_until(_at_rest, _REST_TIMEOUT_S, "stage and arm do not come to rest")
        self._loop.wait(_CALM_S)

    def reset(self, operator: str) -> ResetRecord:
        """Clear the latched stops on an operator's word, and tell the subscribers.

        Whether part and cell are in order only a person can see; a cause that persists latches
        again.
        """
        return self._loop.reset(operator)

    def close(self) -> None:
        """Halt what moves and close the devices; one that fails does not keep the others open."""
        self._closing.close()

    def _latched(self) -> str:
        return "; ".join(str(reason) for reason in self._gate.latched)

    def _put_away(self, phase: SkillPhase) -> str:
        """Make the cell ready for the next part; return why the shaft stays in this one, if so.

        Raises SafetyError for a stop that comes once the shaft is out.
        """
        is_out = True
        if phase is SkillPhase.DONE:
            self._switch_valve(False)
        if phase is SkillPhase.DONE or self._is_clear(self._loop.tick()):
            is_out = self._loop.withdraw(self._start)
        tick = self._loop.wait(_CALM_S)
        if not is_out or not self._is_clear(tick):
            reasons = "; ".join(str(reason) for reason in tick.verdict.reasons)
            return self._latched() or reasons or "the shaft was not withdrawn"
        self._move_arm(self._tray_pose)
        if phase is not SkillPhase.DONE:
            self._switch_valve(False)
        if self._gate.latched:
            raise SafetyError(self._latched())
        return ""

    def _is_clear(self, tick: Tick) -> bool:
        stage = tick.snapshot.stage
        return stage is not None and stage.pose.position[2] <= self._config.limits.clear_depth_m

    def _switch_valve(self, is_open: bool) -> None:
        self._loop.wait(_CALM_S)
        self._gate.send_valve(is_open, self._calm().snapshot)
        self._turn_until(
            lambda t: t.snapshot.gripper is not None and t.snapshot.gripper.part_held is is_open,
            _VACUUM_TIMEOUT_S,
            "no vacuum: is there a part?" if is_open else "the vacuum does not go",
        )

    def _move_arm(self, target: Pose) -> None:
        """Bring the arm to `target`, setting out again after a hold on the way."""
        tick = self._calm()
        end_ns = tick.end_ns + round(_ARM_TIMEOUT_S * 1e9)
        while tick.end_ns < end_ns:
            arm = tick.snapshot.arm
            tolerance_m = self._config.limits.arm_tolerance_m
            if arm is not None and math.dist(arm.pose.position, target.position) < tolerance_m:
                return
            self._gate.send_arm(target, tick.snapshot)
            self._turn_until(_at_rest, _ARM_TIMEOUT_S, "the arm does not come to rest")
            tick = self._calm()
        raise DeviceTimeoutError(f"the arm has not arrived within {_ARM_TIMEOUT_S:g} s")

    def _calm(self) -> Tick:
        """Return a tick at which nothing moves and nothing is held; a stop is not waited out."""
        return self._turn_until(
            lambda t: (
                t.verdict.severity is Severity.STOP
                or (t.verdict.severity < Severity.HOLD and _at_rest(t))
            ),
            _REST_TIMEOUT_S,
            "the cell does not become calm",
        )

    def _turn_until(
        self, condition: Callable[[Tick], bool], timeout_s: float, failure: str
    ) -> Tick:
        tick = self._loop.tick()
        end_ns = tick.end_ns + round(timeout_s * 1e9)
        while not condition(tick):
            if tick.end_ns > end_ns:
                standing = "".join(f"; {reason}" for reason in tick.verdict.reasons)
                raise DeviceTimeoutError(f"{failure} (waited {timeout_s:g} s){standing}")
            tick = self._loop.tick()
        return tick


def _built(
    clock: Clock, world: MockWorld, kind: DeviceClass, choice: DeviceConfig[DeviceSettings]
) -> Device:
    build = device_class(kind, choice.backend)
    shared = (clock, world) if choice.backend == "mock" else (clock,)
    return build(choice.settings, *shared)


def _at_rest(tick: Tick) -> bool:
    stage, arm = tick.snapshot.stage, tick.snapshot.arm
    return stage is not None and arm is not None and not (stage.moving or arm.moving)
