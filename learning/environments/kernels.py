"""One step of many environments, around the contact solve: compiled, nothing is allocated.

`move` makes the poses, the contact model their forces, `judge` rewards, outcomes and observations.
Rows are environments; none depends on another, so any block of rows can be worked on its own.
"""

import math
from enum import IntEnum

import numpy as np
import numpy.typing as npt

from learning.environments.config import Float32Array, Rules
from learning.environments.philox import normals, uniforms
from simulator.checks import FloatArray
from simulator.compiled import kernel, scalar

IntArray = npt.NDArray[np.int64]
CodeArray = npt.NDArray[np.int8]
Pose = tuple[float, float, float, float, float]


class Outcome(IntEnum):
    """How an episode stands."""

    RUNNING = 0
    INSERTED = 1
    """Terminated: the stroke is reached."""
    FORCE_X = 2
    """Terminated: the force along x is over its limit."""
    FORCE_Y = 3
    FORCE_Z = 4
    NOT_FINITE = 5
    """Terminated: the action was not finite (vector environment only)."""
    OUT_OF_STEPS = 6
    """Truncated."""


_RUNNING = int(Outcome.RUNNING)
_INSERTED = int(Outcome.INSERTED)
_FORCE_X = int(Outcome.FORCE_X)
_FORCE_Y = int(Outcome.FORCE_Y)
_FORCE_Z = int(Outcome.FORCE_Z)
_NOT_FINITE = int(Outcome.NOT_FINITE)
_OUT_OF_STEPS = int(Outcome.OUT_OF_STEPS)

_FOR_START = 0
_FOR_NOISE = 1
"""What a draw is for: the third word of the generator's counter, after step and episode."""


@scalar
def start_pose(rules: Rules, key: np.uint64, stream: int, episode: int) -> Pose:
    """Pose at the start of an episode: offset and tilt uniform in the discs of their errors."""
    a, b, c, d = uniforms(
        np.uint64(0),
        np.uint64(episode),
        np.uint64(_FOR_START),
        np.uint64(0),
        key,
        np.uint64(stream),
    )
    offset, tilt = rules.position_error_m * math.sqrt(a), rules.tilt_error_rad * math.sqrt(c)
    at, about = 2.0 * math.pi * b, 2.0 * math.pi * d
    return (
        offset * math.cos(at),
        offset * math.sin(at),
        rules.start_depth_m,
        tilt * math.cos(about),
        tilt * math.sin(about),
    )


@kernel
def start(
    rules: Rules, key: np.uint64, first_stream: int, episode: IntArray, pose: FloatArray
) -> None:
    """Write the start poses of the episodes (n,) into `pose` (n, 5)."""
    for i in range(len(pose)):
        p = start_pose(rules, key, first_stream + i, episode[i])
        pose[i, 0], pose[i, 1], pose[i, 2], pose[i, 3], pose[i, 4] = p


@scalar
def is_finite(action: Float32Array) -> bool:
    """Whether all of an action (3,) is finite."""
    return math.isfinite(action[0]) and math.isfinite(action[1]) and math.isfinite(action[2])


@scalar
def cut(value: float, bound: float) -> float:
    """`value`, at most `bound` in magnitude."""
    return min(max(value, -bound), bound)


@kernel
def move(
    rules: Rules,
    key: np.uint64,
    first_stream: int,
    action: Float32Array,
    old_pose: FloatArray,
    old_outcome: CodeArray,
    old_steps: IntArray,
    old_episode: IntArray,
    pose: FloatArray,
    travel: FloatArray,
    steps: IntArray,
    episode: IntArray,
) -> None:
    """Write pose (n, 5), travel (n, 3), steps and episode (n,) after the actions (n, 3).

    A row whose episode is over starts a new one, whatever its action. Steps are cut to the box and
    end at the stroke. An action that is not finite moves nothing.
    """
    for i in range(len(action)):
        if old_outcome[i] != _RUNNING:
            steps[i], episode[i] = 0, old_episode[i] + 1
            p = start_pose(rules, key, first_stream + i, episode[i])
            pose[i, 0], pose[i, 1], pose[i, 2], pose[i, 3], pose[i, 4] = p
            travel[i, 0] = travel[i, 1] = travel[i, 2] = 0.0
            continue
        steps[i], episode[i] = old_steps[i] + 1, old_episode[i]
        finite = is_finite(action[i])
        for k in range(3):
            step = cut(action[i, k], 1.0) * rules.step_box_m[k] if finite else 0.0
            pose[i, k] = old_pose[i, k] + step
        pose[i, 2] = min(pose[i, 2], rules.stroke_m)
        pose[i, 3], pose[i, 4] = old_pose[i, 3], old_pose[i, 4]
        for k in range(3):
            travel[i, k] = pose[i, k] - old_pose[i, k]


@scalar
def depth_penalty(axial_step: float, ideal: float, omega: float) -> float:
    """R_n of eq. (13); the step asked for and the ideal one as fractions of the longest step."""
    if axial_step >= ideal:
        return axial_step - ideal
    return (ideal - axial_step) / omega


@scalar
def outcome_of(rules: Rules, wrench: FloatArray, depth: float, steps: int) -> int:
    """`Outcome` of a state that a finite action led to; `wrench` (6,) [N, N*m]."""
    if abs(wrench[0]) > rules.force_limit_N[0]:
        return _FORCE_X
    if abs(wrench[1]) > rules.force_limit_N[1]:
        return _FORCE_Y
    if abs(wrench[2]) > rules.force_limit_N[2]:
        return _FORCE_Z
    if depth >= rules.stroke_m:
        return _INSERTED
    if steps >= rules.steps_max:
        return _OUT_OF_STEPS
    return _RUNNING


@kernel
def judge(
    rules: Rules,
    key: np.uint64,
    first_stream: int,
    action: Float32Array,
    old_terms: FloatArray,
    pose: FloatArray,
    wrench: FloatArray,
    steps: IntArray,
    episode: IntArray,
    terms: FloatArray,
    reward: FloatArray,
    outcome: CodeArray,
    observation: Float32Array,
) -> None:
    """Write terms (n, 4), reward, outcome (n,) and observation (n, 4) of poses and wrenches.

    Columns of the terms: the penalties of f_x and f_y, R_p, R_n. A row at the start of its episode
    has no action and no reward; one whose action is not finite gets NaN.
    """
    for i in range(len(pose)):
        terms[i, 0] = rules.alpha_x * abs(wrench[i, 0]) / rules.force_limit_N[0]
        terms[i, 1] = rules.alpha_y * abs(wrench[i, 1]) / rules.force_limit_N[1]
        terms[i, 2] = 1.0 - terms[i, 0] - terms[i, 1]
        terms[i, 3] = reward[i] = 0.0
        outcome[i] = _RUNNING
        if steps[i] > 0:
            if not is_finite(action[i]):
                terms[i] = reward[i] = math.nan
                observation[i] = math.nan
                outcome[i] = _NOT_FINITE
                continue
            terms[i, 3] = depth_penalty(cut(action[i, 2], 1.0), old_terms[i, 2], rules.omega)
            reward[i] = terms[i, 2] - terms[i, 3]
            outcome[i] = outcome_of(rules, wrench[i], pose[i, 2], steps[i])
        noise = (0.0, 0.0, 0.0, 0.0)
        if rules.is_noisy:
            noise = normals(
                np.uint64(steps[i]),
                np.uint64(episode[i]),
                np.uint64(_FOR_NOISE),
                np.uint64(0),
                key,
                np.uint64(first_stream + i),
            )
        for k in range(3):
            seen = wrench[i, k] / rules.force_limit_N[k] + rules.noise[k] * noise[k]
            observation[i, k] = cut(seen, rules.observation_bound)
        seen = pose[i, 2] / rules.stroke_m + rules.noise[3] * noise[3]
        observation[i, 3] = cut(seen, rules.observation_bound)
