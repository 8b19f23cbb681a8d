"""Working memory of a block of poses: one array per quantity, so that loops over them vectorise."""

import numpy as np

BLOCK = 128
"""Lanes of a block; a multiple of every vector length."""
VECTOR = 8
"""Lanes, and packed ones, are filled up to a multiple of this."""


def _fields(names: str, kind: str) -> list[tuple[str, str, tuple[int]]]:
    return [(name, kind, (BLOCK,)) for name in names.split()]


WRENCH = "force_x force_y force_z torque_x torque_y torque_z"

LANES = np.dtype(
    _fields(
        f"turn_x turn_y sin cos x y z slide_x slide_y slide_z stiffness friction {WRENCH}", "f8"
    )
    + _fields("penetration", "f8")
    + _fields("end_x end_y end_z reach lowest nothing", "f8")
    + _fields("upper lower blocked", "u8")
    + _fields("geometry valid state points near", "i8")
)
"""Poses in their heading frames (see `simulator.deepest`), and the sums of their contacts.

Bit i of `upper` and `lower` tells whether that station of wall i touches.
"""

PAIRS = np.dtype(
    _fields("sin cos x y z slide_x slide_y slide_z friction", "f8")
    + _fields("a b c d e f g h", "f8")
    + _fields(f"penetration {WRENCH}", "f8")
    + _fields("lane", "u4")
    + _fields("search", "i8")
)
"""The lanes of a block near one circle, packed; a to h hold the numbers of circle and solid."""
