"""Kernels written once on whole arrays: numpy, PyTorch (inductor) and JAX (XLA)."""

from collections.abc import Callable
from dataclasses import dataclass
from types import ModuleType

import numpy as np

from benchmarks.engine_choice import problem
from benchmarks.engine_choice.problem import Held
from simulator.checks import FloatArray


def forces(xp: ModuleType, depths: Held, poses: Held) -> Held:
    """Forces (3, n) at `poses`, shape (5, n), with the functions of the array module `xp`."""
    x, y, z, rx, ry = poses
    sin_x, cos_x, sin_y, cos_y = xp.sin(rx), xp.cos(rx), xp.sin(ry), xp.cos(ry)
    turn_x, turn_y = sin_y * cos_x, -sin_x
    sin, cos = xp.sqrt(turn_x * turn_x + turn_y * turn_y), cos_x * cos_y
    upright = sin < problem.UPRIGHT
    divisor = xp.where(upright, 1.0, sin)
    turn_x = xp.where(upright, 1.0, turn_x / divisor)
    turn_y = xp.where(upright, 0.0, turn_y / divisor)
    p1, p2 = turn_x * x + turn_y * y, turn_x * y - turn_y * x

    height = depths - z
    m1 = (sin * height + cos * p1) * cos
    e1, e2 = _direction(xp, m1, p2 + 0.0 * m1, problem.RIM_RADIUS_M * sin * sin)
    offset_x = (problem.RIM_RADIUS_M * e1 - p1) * cos - sin * height
    offset_y = problem.RIM_RADIUS_M * e2 - p2
    distance = xp.sqrt(offset_x * offset_x + offset_y * offset_y)
    overlap = problem.SHAFT_RADIUS_M - distance
    load = xp.where(overlap > 0.0, problem.STIFFNESS_N_m * overlap, 0.0) / distance
    across, along = load * offset_x, load * offset_y
    f1 = across[0] + across[1] + across[2] + across[3]
    f2 = along[0] + along[1] + along[2] + along[3]
    lateral = cos * f1
    return xp.stack([turn_x * lateral - turn_y * f2, turn_y * lateral + turn_x * f2, -sin * f1])


def _direction(xp: ModuleType, m1: Held, m2: Held, b: Held) -> tuple[Held, Held]:
    a, c = xp.abs(m1), xp.abs(m2)
    largest = xp.where(b > c, b, c) + a + problem.TINY
    a = a + problem.FLOOR * largest
    root = xp.sqrt(xp.sqrt(a / largest * (a / largest) * (b / largest)))
    scale = largest * (1.0 + root * xp.sqrt(xp.sqrt(root)))
    a, c, curvature = a / scale, c / scale, b / scale
    e1, e2 = xp.sqrt(1.0 - c * c), c
    for _ in range(problem.NEWTON_STEPS):
        e1, e2 = a + curvature * (e1 * e1 * e1), c - curvature * (e2 * e2 * e2)
        length = xp.sqrt(e1 * e1 + e2 * e2)
        e1, e2 = e1 / length, e2 / length
    return xp.copysign(e1, m1), xp.copysign(e2, m2)


@dataclass(frozen=True, slots=True)
class ArrayKernel:
    """A compiled `forces` with the ways in and out of its library."""

    place: Callable[[FloatArray], Held]
    solve: Callable[[Held], Held]
    fetch: Callable[[Held], FloatArray]


def _column() -> FloatArray:
    return np.array(problem.RIM_DEPTHS_M)[:, np.newaxis]


def load_numpy() -> ArrayKernel:
    depths = _column()
    return ArrayKernel(np.asarray, lambda p: forces(np, depths, p), np.asarray)


def load_torch(device: str) -> ArrayKernel:
    import torch

    depths = torch.from_numpy(_column()).to(device)

    def solve(poses: Held) -> Held:
        found = compiled(poses)
        if device != "cpu":
            torch.cuda.synchronize()
        return found

    compiled = torch.compile(lambda p: forces(torch, depths, p), dynamic=True)
    return ArrayKernel(lambda p: torch.from_numpy(p).to(device), solve, lambda f: f.cpu().numpy())


def load_jax(device: str) -> ArrayKernel:
    import jax

    jax.config.update("jax_enable_x64", True)
    target = jax.devices(device)[0]
    depths = _column()
    compiled = jax.jit(lambda p: forces(jax.numpy, depths, p))
    return ArrayKernel(
        lambda p: jax.device_put(p, target), lambda p: compiled(p).block_until_ready(), np.asarray
    )
