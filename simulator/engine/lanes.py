"""Working memory of a block of poses: one array per quantity, so that loops over them vectorise."""

from typing import Any

import numpy as np
import numpy.typing as npt

from simulator.checks import FloatArray

BLOCK = 128
"""Lanes of a block; a multiple of every vector length."""
VECTOR = 8
"""Loops over lanes and pairs run to a multiple of this."""
LIST = 4 * BLOCK
_PAD = VECTOR
"""Room behind each field: loops may run over, and fields do not all lie in the same cache sets."""
_LINE = 64
"""Bytes of a cache line, and of the longest vector."""
"""Pairs that are solved together at most."""


def _fields(names: str, kind: str, length: int) -> list[tuple[str, str, tuple[int]]]:
    return [(name, kind, (length + _PAD,)) for name in names.split()]


WRENCH = "force_x force_y force_z torque_x torque_y torque_z"

LANES = np.dtype(
    _fields(
        "turn_x turn_y sin cos x y z slide_x slide_y slide_z stiffness friction "
        f"{WRENCH} penetration end_x end_y end_z reach lowest nothing",
        "f8",
        BLOCK,
    )
    + _fields("upper lower blocked", "u8", BLOCK)
    + _fields("geometry valid state points near", "i8", BLOCK)
)
"""Poses in their heading frames (see `simulator.deepest`), and the sums of their contacts.

Bit i of `upper` and `lower` tells whether that station of wall i touches.
"""

PAIRS = np.dtype(
    _fields("sin cos x y z slide_x slide_y slide_z friction", "f8", LIST)
    + _fields(
        "shaft length first per_first last per_last a b c d e f g h "
        f"e1 e2 ratio point_x point_y point_z normal_x normal_y normal_z penetration {WRENCH}",
        "f8",
        LIST,
    )
    + _fields("wall lower", "u8", LIST)
    + _fields("lane search", "i8", LIST)
)
"""Pairs of a lane and a circle near it; a to h hold the numbers of circle and solid.

`lower` is 1 for the lower station of wall number `wall`, else 0.
"""


def working_memory(columns: int) -> tuple[npt.NDArray[np.void], npt.NDArray[np.void], FloatArray]:
    """Lanes and pairs, one element each, and the numbers of a geometry (columns, lanes); zeros."""
    numbers = np.dtype((np.float64, (columns, BLOCK + _PAD)))
    return _zeros(LANES), _zeros(PAIRS), _zeros(numbers)[0]


def _zeros(kind: np.dtype[Any]) -> npt.NDArray[Any]:
    """One element of zeros that starts at a cache line."""
    room = np.zeros(kind.itemsize + _LINE, dtype=np.uint8)
    start = -room.ctypes.data % _LINE
    return np.ndarray(1, kind, room.data, start)
