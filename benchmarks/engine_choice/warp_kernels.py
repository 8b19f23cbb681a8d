"""NVIDIA Warp kernel, one thread per pose; Warp's own language inside Python functions."""

from dataclasses import dataclass

import warp as wp

from benchmarks.engine_choice import problem
from benchmarks.engine_choice.problem import Held
from simulator.checks import FloatArray

wp.config.log_level = wp.LOG_ERROR
real = wp.float64
vec2 = wp.types.vector(length=2, dtype=real)

ZERO, ONE = wp.constant(real(0.0)), wp.constant(real(1.0))
RIM = wp.constant(real(problem.RIM_RADIUS_M))
SHAFT = wp.constant(real(problem.SHAFT_RADIUS_M))
STIFFNESS = wp.constant(real(problem.STIFFNESS_N_m))
TINY, FLOOR = wp.constant(real(problem.TINY)), wp.constant(real(problem.FLOOR))
UPRIGHT = wp.constant(real(problem.UPRIGHT))
STEPS = wp.constant(problem.NEWTON_STEPS)
RIMS = wp.constant(len(problem.RIM_DEPTHS_M))
DEPTHS = wp.constant(
    wp.types.vector(length=len(problem.RIM_DEPTHS_M), dtype=real)(*problem.RIM_DEPTHS_M)
)


@wp.func
def copysign(magnitude: real, sign: real) -> real:
    return wp.where(sign < ZERO, -magnitude, magnitude)


@wp.func
def fourth_root(x: real) -> real:
    return wp.sqrt(wp.sqrt(x))


@wp.func
def direction(m1: real, m2: real, b: real) -> vec2:
    a = wp.abs(m1)
    c = wp.abs(m2)
    largest = wp.max(b, c) + a + TINY
    a = a + FLOOR * largest
    root = fourth_root(a / largest * (a / largest) * (b / largest))
    scale = largest * (ONE + root * fourth_root(root))
    a = a / scale
    c = c / scale
    curvature = b / scale
    e1 = wp.sqrt(ONE - c * c)
    e2 = c
    for _ in range(STEPS):
        e1 = a + curvature * (e1 * e1 * e1)
        e2 = c - curvature * (e2 * e2 * e2)
        length = wp.sqrt(e1 * e1 + e2 * e2)
        e1 = e1 / length
        e2 = e2 / length
    return vec2(copysign(e1, m1), copysign(e2, m2))


@wp.func
def rim_force(height: real, p1: real, p2: real, sin: real, cos: real) -> vec2:
    e = direction((sin * height + cos * p1) * cos, p2, RIM * sin * sin)
    offset_x = (RIM * e[0] - p1) * cos - sin * height
    offset_y = RIM * e[1] - p2
    distance = wp.sqrt(offset_x * offset_x + offset_y * offset_y)
    overlap = SHAFT - distance
    load = wp.where(overlap > ZERO, STIFFNESS * overlap, ZERO) / distance
    return vec2(load * offset_x, load * offset_y)


@wp.kernel(enable_backward=False)
def solve_pose(poses: wp.array2d(dtype=real), forces: wp.array2d(dtype=real)) -> None:
    i = wp.tid()
    x = poses[0, i]
    y = poses[1, i]
    sin_x = wp.sin(poses[3, i])
    cos_x = wp.cos(poses[3, i])
    sin_y = wp.sin(poses[4, i])
    cos_y = wp.cos(poses[4, i])
    turn_x = sin_y * cos_x
    turn_y = -sin_x
    sin = wp.sqrt(turn_x * turn_x + turn_y * turn_y)
    cos = cos_x * cos_y
    upright = sin < UPRIGHT
    divisor = wp.where(upright, ONE, sin)
    turn_x = wp.where(upright, ONE, turn_x / divisor)
    turn_y = wp.where(upright, ZERO, turn_y / divisor)
    p1 = turn_x * x + turn_y * y
    p2 = turn_x * y - turn_y * x
    f = vec2(ZERO, ZERO)
    for rim in range(RIMS):
        f += rim_force(DEPTHS[rim] - poses[2, i], p1, p2, sin, cos)
    lateral = cos * f[0]
    forces[0, i] = turn_x * lateral - turn_y * f[1]
    forces[1, i] = turn_y * lateral + turn_x * f[1]
    forces[2, i] = -sin * f[0]


@dataclass(frozen=True, slots=True)
class WarpKernel:
    device: str

    def place(self, poses: FloatArray) -> Held:
        return wp.array(poses, dtype=real, device=self.device)

    def solve(self, placed: Held) -> Held:
        forces = wp.empty((3, placed.shape[1]), dtype=real, device=self.device)
        wp.launch(solve_pose, placed.shape[1], [placed], [forces], device=self.device)
        wp.synchronize_device(self.device)
        return forces

    def fetch(self, forces: Held) -> FloatArray:
        found: FloatArray = forces.numpy()
        return found
