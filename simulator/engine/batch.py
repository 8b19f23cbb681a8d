"""What a batch of poses is solved from and into, and the checks of it."""

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from simulator.checks import FloatArray
from simulator.engine.table import IntArray, Table
from simulator.geometry import POSE_SIZE

BoolArray = npt.NDArray[np.bool_]


class Given(NamedTuple):
    """n poses and what goes with each; of all but the poses also one for all."""

    poses: FloatArray
    """(n, 5)."""
    sliding: FloatArray
    """(n, 3) or (1, 3)."""
    stiffness: FloatArray
    """(n,) or (1,) [N/m]."""
    friction: FloatArray
    """(n,) or (1,)."""
    geometry: IntArray
    """(n,) or (1,): row of the table."""
    entered: BoolArray
    """(n, N) with blocking, else (0, N); carried on in place."""


class Found(NamedTuple):
    """Results for n poses; see `Batch`."""

    wrench: FloatArray
    penetration: FloatArray
    state: npt.NDArray[np.int8]
    points: npt.NDArray[np.int16]


@dataclass(frozen=True, slots=True)
class Batch:
    """Contacts of n poses.

    A pose that is not finite, slides in a direction that is not, is tilted by a quarter turn or
    more or holds a number above 1e100, has a wrench and penetration of NaN, the state -1 and no
    points.
    """

    wrench: FloatArray
    """(n, 6) [N, N*m]: force on the part, and torque about the origin of M."""
    penetration: FloatArray
    """(n,) [m]: the largest of all circles, at least 0."""
    state: npt.NDArray[np.int8]
    """(n,): `simulator.states.ContactState`, or -1."""
    points: npt.NDArray[np.int16]
    """(n,): number of stations that touch."""

    @classmethod
    def empty(cls, n: int) -> "Batch":
        """Memory for the results of n poses."""
        return cls(np.empty((n, 6)), np.empty(n), np.empty(n, np.int8), np.empty(n, np.int16))

    def arrays(self) -> Found:
        """The arrays as kernels take them."""
        return Found(self.wrench, self.penetration, self.state, self.points)


def checked(
    table: Table,
    poses: npt.ArrayLike,
    sliding: npt.ArrayLike,
    stiffness_N_m: npt.ArrayLike,
    friction: npt.ArrayLike,
    geometry: npt.ArrayLike,
    entered: BoolArray | None,
) -> Given:
    """The arguments of `solve` as arrays for a kernel; all but `entered` are locked views.

    So they are of the same types in every call, and the kernel is compiled once.
    """
    pose = np.ascontiguousarray(poses, dtype=np.float64)
    if pose.ndim != 2 or pose.shape[1] != POSE_SIZE:
        raise ValueError(f"poses has shape {pose.shape}; it must be (n, {POSE_SIZE})")
    n, walls = len(pose), len(table.mouths)
    slide = np.ascontiguousarray(sliding, dtype=np.float64)
    if slide.shape not in ((3,), (n, 3)):
        raise ValueError(f"sliding has shape {slide.shape}; it must be (3,) or {(n, 3)}")
    if slide.ndim == 1 and not np.isfinite(slide).all():
        raise ValueError(f"sliding is {slide}; every entry must be finite")
    stiffness = _numbers("stiffness_N_m", stiffness_N_m, n)
    if not ((stiffness > 0.0) & (stiffness < np.inf)).all():
        raise ValueError("stiffness_N_m must be finite and greater than 0")
    drag = _numbers("friction", friction, n)
    if not ((drag >= 0.0) & (drag < np.inf)).all():
        raise ValueError("friction must be finite and at least 0")
    row = np.asarray(geometry)
    if row.dtype.kind not in "iu" or row.shape not in ((), (n,)):
        raise ValueError(
            f"geometry is {row.dtype} of shape {row.shape}; it must be integer, () or {(n,)}"
        )
    if row.size and not (row.min() >= 0 and row.max() < len(table.columns)):
        raise ValueError(f"geometry must be from 0 to {len(table.columns) - 1}")
    if entered is None:
        entered = np.empty((0, walls), dtype=np.bool_)
    elif entered.dtype != np.bool_ or entered.shape != (n, walls) or not entered.flags.carray:
        raise ValueError(
            f"entered is {entered.dtype} of shape {entered.shape}; "
            f"it must be bool of shape {(n, walls)}, in C order and open to writing"
        )
    rows: IntArray = np.ascontiguousarray(np.atleast_1d(row), dtype=np.int64)
    return Given(
        _locked(pose),
        _locked(slide.reshape(-1, 3)),
        _locked(stiffness),
        _locked(drag),
        _locked(rows),
        entered,
    )


def _locked(array: npt.NDArray[Any]) -> npt.NDArray[Any]:
    view = array.view()
    view.setflags(write=False)
    return view


def _numbers(name: str, value: npt.ArrayLike, n: int) -> FloatArray:
    array = np.ascontiguousarray(np.atleast_1d(np.asarray(value, dtype=np.float64)))
    if array.shape not in ((1,), (n,)):
        raise ValueError(f"{name} has shape {array.shape}; it must be one number or {(n,)}")
    return array


def checked_out(out: Batch, n: int) -> Batch:
    """Return `out` if it is memory for n poses."""
    like = Batch.empty(0)
    for name in Batch.__dataclass_fields__:
        array, model = getattr(out, name), getattr(like, name)
        shape = (n, *model.shape[1:])
        if array.shape != shape or array.dtype != model.dtype or not array.flags.carray:
            raise ValueError(
                f"out.{name} is {array.dtype} of shape {array.shape}; "
                f"it must be {model.dtype} of shape {shape}, in C order and open to writing"
            )
    return out
