"""Where a shaft that a spring presses against the part comes to rest, in MuJoCo and with `solve`.

MuJoCo's own law, solver and steps. Of a ring of many boxes dozens touch at once and their springs
add up, which no stiffness per contact can match. So the ring is a square around the circle and the
shaft moves in the plane x, z, where only one side is touched, in the middle: there it is exact.
"""

from dataclasses import dataclass

import mujoco
import numpy as np
from scipy.optimize import brentq

from simulator.checks import FloatArray
from tests.simulator.mujoco.cases import LAW, TILT_RAD, Case
from tests.simulator.mujoco.model import MM_PER_M, ContactSpring, Scene, build, joints

HOLDER_N_M = 2e3
PRESS_M = 2.5e-5
"""The holder's spring is at ease up to this far from the hole's axis."""
SQUARE = 4
STEPS = 5000
RESTING_MM_S = 1e-8
SETTLED_S = 0.05
SAME_POINT_MM = 1e-6


@dataclass(frozen=True, slots=True)
class Rest:
    """Where the shaft comes to rest, and the force on the part there."""

    x_m: float
    force_N: float


def planar_poses(case: Case, count: int, seed: int) -> FloatArray:
    """Poses in the plane x, z where no end crosses a rim; the holder is at ease there."""
    poses, rng = case.poses(4 * count, seed), np.random.default_rng(seed + 1)
    poses[:, 0] = rng.uniform(-PRESS_M, PRESS_M, len(poses))
    poses[:, 4] = rng.uniform(-TILT_RAD, TILT_RAD, len(poses))
    poses[:, [1, 3]] = 0.0
    return poses[~case.crossing(poses)][:count]


def rest_in_mujoco(scene: Scene, eased: FloatArray) -> tuple[Rest, set[int]]:
    """Step until nothing moves: the rest, and how often MuJoCo lists its contacts then."""
    data = mujoco.MjData(scene.model)
    data.qpos[:] = joints(eased)
    data.qfrc_applied[:3] = HOLDER_N_M * data.qpos[:3]
    for _ in range(STEPS):
        mujoco.mj_step(scene.model, data)
        if data.time > SETTLED_S and np.abs(data.qvel[:3]).max() < RESTING_MM_S:
            break
    else:
        raise RuntimeError(f"the shaft still moves at {data.qvel[:3]} mm/s")
    at = np.round(data.contact.pos / SAME_POINT_MM).astype(np.int64)
    listed = np.unique(at, axis=0, return_counts=True)[1]
    rest = Rest(float(data.qpos[0]) / MM_PER_M, -float(data.qfrc_constraint[0]) * 1e-3)
    return rest, set(listed.tolist())


def rest_of_simulator(case: Case, eased: FloatArray, listed: int) -> Rest:
    """Where the holder's force equals that of the analytic contacts, counted `listed` times."""

    def force(x: float) -> float:
        return listed * float(case.solve(np.array([x, *eased[1:]])).wrench[0])

    x = brentq(lambda x: force(x) - HOLDER_N_M * (eased[0] - x), -1e-4, 1e-4, xtol=1e-14)
    return Rest(x, force(x))


@dataclass(frozen=True, slots=True)
class RestDifferences:
    """Absolute differences of one pose each: arrays."""

    x_m: FloatArray
    force_N: FloatArray
    force_size_N: FloatArray
    left_out: int
    """Poses at which MuJoCo lists only some of its contacts twice: they push twice as hard."""


def rest_differences(case: Case, poses: FloatArray, ours: Case) -> RestDifferences:
    """MuJoCo's rests of `case` against the simulator's of `ours`, which is the same or wrong."""
    scene = build(case.part, case.shaft, SQUARE, ContactSpring(LAW.stiffness_N_m), HOLDER_N_M)
    rows, left_out = [], 0
    for eased in poses:
        theirs, listed = rest_in_mujoco(scene, eased)
        if len(listed) > 1:
            left_out += 1
            continue
        rest = rest_of_simulator(ours, eased, max(listed, default=1))
        rows.append((rest.x_m - theirs.x_m, rest.force_N - theirs.force_N, rest.force_N))
    return RestDifferences(*np.abs(np.array(rows)).T, left_out)
