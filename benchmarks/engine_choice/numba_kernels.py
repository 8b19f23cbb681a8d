"""Numba on the CPU: scalar functions in a plain loop, and in blocks of loops for SIMD.

The scalar functions keep to what Numba compiles for CUDA, too (`cuda_kernel.py`): conditional
expressions in place of `max`, and no cube root.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numba import njit, prange

from benchmarks.engine_choice import problem
from simulator.checks import FloatArray

RIM, SHAFT, STIFFNESS = problem.RIM_RADIUS_M, problem.SHAFT_RADIUS_M, problem.STIFFNESS_N_m
TINY, FLOOR, UPRIGHT, STEPS = problem.TINY, problem.FLOOR, problem.UPRIGHT, problem.NEWTON_STEPS
DEPTHS = problem.RIM_DEPTHS_M
BLOCK = 128
SERIAL = 1024

# Division as in numpy: a check for zero in every division would keep a loop from being vectorised.
scalar = njit(error_model="numpy", forceinline=True)


@scalar
def heading(
    x: float, y: float, rx: float, ry: float
) -> tuple[float, float, float, float, float, float]:
    """Horizontal unit vector of the tilt, the centre turned by it, sine and cosine of the tilt."""
    sin_x, cos_x, sin_y, cos_y = math.sin(rx), math.cos(rx), math.sin(ry), math.cos(ry)
    turn_x, turn_y = sin_y * cos_x, -sin_x
    sin, cos = math.sqrt(turn_x * turn_x + turn_y * turn_y), cos_x * cos_y
    upright = sin < UPRIGHT
    divisor = 1.0 if upright else sin
    turn_x = 1.0 if upright else turn_x / divisor
    turn_y = 0.0 if upright else turn_y / divisor
    return turn_x, turn_y, turn_x * x + turn_y * y, turn_x * y - turn_y * x, sin, cos


@scalar
def direction(m1: float, m2: float, b: float) -> tuple[float, float]:
    """Unit vector that maximises 2 m.e + b e1^2."""
    a, c = abs(m1), abs(m2)
    largest = (b if b > c else c) + a + TINY
    a += FLOOR * largest
    root = fourth_root(a / largest * (a / largest) * (b / largest))
    scale = largest * (1.0 + root * fourth_root(root))
    a, c, curvature = a / scale, c / scale, b / scale
    e1, e2 = math.sqrt(1.0 - c * c), c
    for _ in range(STEPS):
        e1, e2 = a + curvature * (e1 * e1 * e1), c - curvature * (e2 * e2 * e2)
        length = math.sqrt(e1 * e1 + e2 * e2)
        e1, e2 = e1 / length, e2 / length
    return math.copysign(e1, m1), math.copysign(e2, m2)


@scalar
def fourth_root(x: float) -> float:
    return math.sqrt(math.sqrt(x))


@scalar
def rim_force(height: float, p1: float, p2: float, sin: float, cos: float) -> tuple[float, float]:
    """Force of one rim across the shaft's axis, in the plane of the tilt and along y."""
    e1, e2 = direction((sin * height + cos * p1) * cos, p2, RIM * sin * sin)
    offset_x = (RIM * e1 - p1) * cos - sin * height
    offset_y = RIM * e2 - p2
    distance = math.sqrt(offset_x * offset_x + offset_y * offset_y)
    overlap = SHAFT - distance
    load = (STIFFNESS * overlap if overlap > 0.0 else 0.0) / distance
    return load * offset_x, load * offset_y


@scalar
def turned(
    turn_x: float, turn_y: float, sin: float, cos: float, f1: float, f2: float
) -> tuple[float, float, float]:
    """Force in the part's frame."""
    lateral = cos * f1
    return turn_x * lateral - turn_y * f2, turn_y * lateral + turn_x * f2, -sin * f1


@scalar
def force(x: float, y: float, z: float, rx: float, ry: float) -> tuple[float, float, float]:
    """Force of all rims at one pose."""
    turn_x, turn_y, p1, p2, sin, cos = heading(x, y, rx, ry)
    f1, f2 = 0.0, 0.0
    for depth in DEPTHS:
        across, along = rim_force(depth - z, p1, p2, sin, cos)
        f1 += across
        f2 += along
    return turned(turn_x, turn_y, sin, cos, f1, f2)


@scalar
def plain_span(poses: FloatArray, forces: FloatArray, start: int, stop: int) -> None:
    for i in range(start, stop):
        forces[0, i], forces[1, i], forces[2, i] = force(
            poses[0, i], poses[1, i], poses[2, i], poses[3, i], poses[4, i]
        )


@scalar
def blocked_span(poses: FloatArray, forces: FloatArray, start: int, stop: int) -> None:
    """As `plain_span`, but every stage runs over a block; those without libm calls use SIMD."""
    count = stop - start
    turn_x, turn_y, p1, p2, sin, cos, f1, f2 = np.empty((8, BLOCK))
    for i in range(count):
        j = start + i
        turn_x[i], turn_y[i], p1[i], p2[i], sin[i], cos[i] = heading(
            poses[0, j], poses[1, j], poses[3, j], poses[4, j]
        )
        f1[i], f2[i] = 0.0, 0.0
    for depth in DEPTHS:
        for i in range(count):
            height = depth - poses[2, start + i]
            across, along = rim_force(height, p1[i], p2[i], sin[i], cos[i])
            f1[i] += across
            f2[i] += along
    for i in range(count):
        forces[0, start + i], forces[1, start + i], forces[2, start + i] = turned(
            turn_x[i], turn_y[i], sin[i], cos[i], f1[i], f2[i]
        )


Span = Callable[[FloatArray, FloatArray, int, int], None]


@dataclass(frozen=True, slots=True)
class CpuKernel:
    """A span over a whole batch: small ones in the caller's thread, others on all cores."""

    serial: Callable[[FloatArray], FloatArray]
    parallel: Callable[[FloatArray], FloatArray]

    @classmethod
    def of(cls, span: Span) -> "CpuKernel":
        @njit
        def serial(poses: FloatArray) -> FloatArray:
            n = poses.shape[1]
            forces = np.empty((3, n))
            for block in range((n + BLOCK - 1) // BLOCK):
                span(poses, forces, block * BLOCK, min(n, (block + 1) * BLOCK))
            return forces

        @njit(parallel=True)
        def parallel(poses: FloatArray) -> FloatArray:
            n = poses.shape[1]
            forces = np.empty((3, n))
            for block in prange((n + BLOCK - 1) // BLOCK):
                span(poses, forces, block * BLOCK, min(n, (block + 1) * BLOCK))
            return forces

        return cls(serial, parallel)

    def place(self, poses: FloatArray) -> FloatArray:
        return poses

    def solve(self, placed: FloatArray) -> FloatArray:
        return self.serial(placed) if placed.shape[1] <= SERIAL else self.parallel(placed)

    def fetch(self, forces: FloatArray) -> FloatArray:
        return forces
