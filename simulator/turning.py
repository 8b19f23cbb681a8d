"""Turns of vectors by a tilt (rx, ry): about x by rx, then about the fixed y by ry."""

import numpy as np

from simulator.checks import FloatArray


def turned(vector: FloatArray, rotation: FloatArray) -> FloatArray:
    """Vectors (..., 3) turned by the tilts `rotation`, (..., 2); the shapes broadcast."""
    (x, y, z), (sin, cos) = np.moveaxis(vector, -1, 0), _sin_cos(rotation)
    y, z = cos[0] * y - sin[0] * z, sin[0] * y + cos[0] * z
    return np.stack([cos[1] * x + sin[1] * z, y, cos[1] * z - sin[1] * x], axis=-1)


def turned_back(vector: FloatArray, rotation: FloatArray) -> FloatArray:
    """The inverse of `turned`."""
    (x, y, z), (sin, cos) = np.moveaxis(vector, -1, 0), _sin_cos(rotation)
    x, z = cos[1] * x - sin[1] * z, sin[1] * x + cos[1] * z
    return np.stack([x, cos[0] * y + sin[0] * z, cos[0] * z - sin[0] * y], axis=-1)


def _sin_cos(rotation: FloatArray) -> tuple[FloatArray, FloatArray]:
    angles = np.moveaxis(rotation, -1, 0)
    return np.sin(angles), np.cos(angles)
