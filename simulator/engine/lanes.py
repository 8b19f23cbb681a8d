"""Working memory of a block of poses: one array per quantity, so that loops over them vectorise."""

from typing import Any

import numpy as np
import numpy.typing as npt

from simulator.checks import FloatArray
from simulator.engine.table import MOST_RIMS

BLOCK = 128
"""Lanes of a block; a multiple of every vector length."""
VECTOR = 8
"""Loops over lanes start and end at multiples of this."""
_PAD = VECTOR
"""Room behind each field: fields do not all lie in the same cache sets."""
LINE = 64
"""Bytes of a cache line, and of the longest vector."""


def _fields(names: str, kind: str, length: int) -> list[tuple[str, str, tuple[int]]]:
    return [(name, kind, (length,)) for name in names.split()]


LANES = np.dtype(
    _fields(
        "turn_x turn_y sin cos x y z slide_x slide_y slide_z stiffness friction "
        "force_x force_y force_z torque_x torque_y torque_z penetration "
        "end_x end_y end_z reach lowest nothing "
        "shaft length first per_first last per_last rounding a b c d e f g h "
        "e1 e2 ratio point_x point_y point_z normal_x normal_y normal_z effective",
        "f8",
        BLOCK + _PAD,
    )
    + _fields("upper lower blocked at rims_passed", "u8", BLOCK + _PAD)
    + _fields("geometry valid state points near search", "i8", BLOCK + _PAD)
    + _fields("place", "u8", MOST_RIMS + 1)
)
"""Poses in their heading frames (see `simulator.deepest`), and the sums of their contacts.

Pose i of the block is in lane `at[i]`. Bit i of `upper` and `lower` tells whether that station of
wall i touches. From `shaft` on: one circle per lane, `shaft` to `h` the numbers of circle and
solid, then what is found for it.
"""


def working_memory(columns: int) -> tuple[npt.NDArray[np.void], FloatArray]:
    """Lanes, one element, and the numbers of a geometry (columns, lanes); zeros."""
    numbers = np.dtype((np.float64, (columns, BLOCK + _PAD)))
    return _zeros(LANES), _zeros(numbers)[0]


def _zeros(kind: np.dtype[Any]) -> npt.NDArray[Any]:
    """One element of zeros that starts at a cache line."""
    room = np.zeros(kind.itemsize + LINE, dtype=np.uint8)
    start = -room.ctypes.data % LINE
    return np.ndarray(1, kind, room.data, start)
