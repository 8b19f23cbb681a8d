"""Trials: one insertion of one plant by one controller, step by step, without a cell around it.

Quasi-static: a step ends with the stage at rest, then the sensor is read once. The supervisor's
limits on step and force hold here as in the cell. A force above its limit makes the insertion a
failure but does not end it: controllers are compared over the same way.
"""

import math
from dataclasses import dataclass

import numpy as np

from controllers.insertion import Controller
from controllers.messages import Move, Observation
from drivers.contract.messages import Pose, Vector3, Wrench
from learning.evaluation.plant import Plant
from simulator.checks import FloatArray
from simulator.effects.stage import at_rest, move
from simulator.engine.solve import solve
from simulator.equilibrium import settle
from simulator.geometry import POSE_SIZE
from simulator.holder import HOLDER_AXES
from simulator.wrench import move_torque

REACHED_M = 1e-8
"""A depth this close to the stroke counts as reached."""
_STEP_NS = 100_000_000
"""Time stamps of a trial count its steps."""


@dataclass(frozen=True, slots=True)
class TrialRules:
    """What holds for every controller; vectors are x, y, z in M."""

    step_box_m: Vector3 = (20e-6, 20e-6, 60e-6)
    turn_rad: float = math.radians(0.05)
    """Largest turn about x and about y in a step."""
    force_limit_N: Vector3 = (0.07, 0.1, 1.0)
    start_depth_m: float = -20e-6
    beyond_m: float = 3e-4
    """Depth below the last mouth at which the part is inserted."""
    steps_max: int = 1000
    sensor_m: Vector3 = (0.0, 0.0, 0.04)
    """Origin of frame F in M."""


@dataclass(frozen=True, slots=True, eq=False)
class Record:
    """What really happened in a trial; rows are steps."""

    poses: FloatArray
    """(T, 5): of the shaft, in the M of a part without load."""
    wrenches: FloatArray
    """(T, 6): on the part, in the M of a part without load, about its origin [N, N m]."""
    last_mouth_m: float
    force_limit_N: Vector3
    is_inserted: bool
    """Whether the stroke was reached within the steps allowed."""
    unsettled: int
    """Steps at which the held part's equilibrium was only found roughly."""

    @property
    def is_success(self) -> bool:
        """Inserted, and no force ever above its limit."""
        return self.is_inserted and bool((np.abs(self.wrenches[:, :3]) <= self.force_limit_N).all())


class Trial:
    """An insertion under way."""

    def __init__(self, plant: Plant, rules: TrialRules, generator: np.random.Generator) -> None:
        self._plant = plant
        self.rules = rules
        self._generator = generator
        self._commanded = np.array([0.0, 0.0, rules.start_depth_m, 0.0, 0.0, 0.0])
        self._stage = at_rest(plant.stage, self._commanded)
        self._origin = self._commanded[:3]
        self._sliding = np.zeros(3)
        self._is_rigid = not plant.holder.compliance.any() and bool(
            np.isinf(plant.holder.holding_force).all()
        )
        self._offset = np.zeros(HOLDER_AXES)
        self._unsettled = 0
        self._poses: list[FloatArray] = []
        self._wrenches: list[FloatArray] = []
        self._wrench = self._solved()

    @property
    def stroke_m(self) -> float:
        return self._plant.last_mouth_m + self.rules.beyond_m

    @property
    def shaft_pose(self) -> FloatArray:
        """Where the shaft really is in M, shape (5,)."""
        pose: FloatArray = self._stage.position[:5] + self._plant.misalignment
        return pose

    @property
    def is_inserted(self) -> bool:
        return bool(self._commanded[2] >= self.stroke_m - REACHED_M)

    def observe(self) -> Observation:
        """Read sensor and stage, both with noise."""
        plant, generator = self._plant, self._generator
        read = plant.crosstalk @ move_torque(self._wrench, self.rules.sensor_m)
        read = read + plant.force_noise * generator.standard_normal(6)
        place = self._stage.position[:3] + plant.position_noise_m * generator.standard_normal(3)
        return Observation(
            _STEP_NS * len(self._poses),
            len(self._poses),
            _wrench(read),
            _wrench(plant.force_noise),
            Pose(_vector(place), _vector(self._stage.position[3:])),
            _vector(place - self._origin),
            Pose(_vector(self._commanded[:3]), _vector(self._commanded[3:])),
        )

    def step(self, wanted: Move) -> None:
        """Move by what the step box leaves of `wanted`, and no deeper than the stroke."""
        rules, before = self.rules, self._stage.position[:3]
        box = np.array([*rules.step_box_m, rules.turn_rad, rules.turn_rad, 0.0])
        step = np.array([*wanted.translation, *wanted.rotation])
        if not np.isfinite(step).all():
            raise ValueError(f"the move {wanted} is not finite")
        self._commanded = self._commanded + np.clip(step, -box, box)
        self._commanded[2] = min(self._commanded[2], self.stroke_m)
        draws = self._generator.standard_normal(6)
        self._stage = move(self._plant.stage, self._commanded, self._stage, math.inf, draws)
        self._sliding = self._stage.position[:3] - before
        self._wrench = self._solved()
        self._poses.append(self.shaft_pose)
        self._wrenches.append(self._wrench)

    def record(self) -> Record:
        """All steps so far."""
        return Record(
            np.array(self._poses).reshape(-1, 5),
            np.array(self._wrenches).reshape(-1, 6),
            self._plant.last_mouth_m,
            self.rules.force_limit_N,
            self.is_inserted,
            self._unsettled,
        )

    def _solved(self) -> FloatArray:
        """The wrench at rest; a part that is held softly gives way, and may slip for good."""
        if self._is_rigid:
            return self._contact(self.shaft_pose)
        holder = self._plant.holder
        rest = settle(holder, self._offset, self.shaft_pose, self._contact)
        self._offset = rest.offset
        self._unsettled += not rest.converged
        return holder.wrench_at(np.zeros(3), rest.wrench, rest.displacement)

    def _contact(self, poses: FloatArray) -> FloatArray:
        """Wrenches (..., 6) of poses (..., 5), in M."""
        law = self._plant.law
        found = solve(
            self._plant.table,
            poses.reshape(-1, POSE_SIZE),
            self._sliding,
            stiffness_N_m=law.stiffness_N_m,
            friction=law.friction,
        )
        return found.wrench.reshape(*poses.shape[:-1], 6)


def insert(trial: Trial, controller: Controller) -> Record:
    """Lead a trial that has not begun to its end."""
    for _ in range(trial.rules.steps_max):
        observation = trial.observe()
        for _pause in controller.think(observation):
            pass
        trial.step(controller.step(observation))
        if trial.is_inserted:
            break
    return trial.record()


def _vector(values: FloatArray) -> Vector3:
    x, y, z = values.tolist()
    return (x, y, z)


def _wrench(values: FloatArray) -> Wrench:
    fx, fy, fz, tx, ty, tz = values.tolist()
    return (fx, fy, fz, tx, ty, tz)
