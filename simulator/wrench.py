"""Friction at a contact, resultant of contact forces, and a change of the torque's reference."""

import numpy as np
import numpy.typing as npt

from simulator.checks import FloatArray, finite_array

_TINY = 1e-150
_PARALLEL = 1e-9


def friction_direction(normal: FloatArray, sliding: FloatArray) -> FloatArray:
    """Unit vectors of the sliding direction's component tangential to each contact: (3, C, P).

    `normal` (3, C, P) holds unit vectors, `sliding` (3, 1, P) or (3, 1, 1) directions of any
    length; a zero vector gives zero. Sliding within 1e-9 rad of the normal has no usable tangential
    direction: there the result shrinks to zero.
    """
    product = normal * sliding
    along = product[0] + product[1]
    along += product[2]
    np.multiply(along, normal, out=product)
    tangent = np.subtract(sliding, product)
    np.multiply(tangent, tangent, out=product)
    length = product[0] + product[1]
    length += product[2]
    np.sqrt(length, out=length)
    np.abs(along, out=along)
    along *= _PARALLEL
    along += _TINY
    tangent /= np.maximum(length, along, out=length)
    return tangent


def resultant(point: FloatArray, force: FloatArray) -> FloatArray:
    """Force and torque about the origin, shape (6, P), of forces (3, C, P) at points (3, C, P)."""
    cyclic = np.empty((2, 5, *force.shape[1:]))
    cyclic[0, :3], cyclic[1, :3] = point, force
    cyclic[:, 3:] = cyclic[:, :2]
    arm, pull = cyclic[0], cyclic[1]
    each = np.empty((6, *force.shape[1:]))
    each[:3] = force
    np.multiply(arm[1:4], pull[2:5], out=each[3:])
    each[3:] -= arm[2:5] * pull[1:4]
    # Added up by halves, not by `sum`: the order, and so every bit, is then the same for any batch.
    left = each.shape[1]
    while left > 1:
        half = left // 2
        each[:, :half] += each[:, left - half : left]
        left -= half
    return each[:, 0]


def move_torque(wrench: npt.ArrayLike, origin: npt.ArrayLike) -> FloatArray:
    """The same wrench with its torque about `origin` in place of the frame's origin.

    `wrench` (..., 6) [N, N*m], `origin` (3,) or (..., 3) [m], both in one frame: torque' = torque -
    origin x force. Raises `ValueError` for wrong shapes or entries that are not finite.
    """
    moved = finite_array("wrench", wrench, 6).copy()
    moved[..., 3:] -= np.cross(finite_array("origin", origin, 3), moved[..., :3])
    return moved
