"""A vacuum gripper that holds the part with compliance and lets it slip above a holding force.

A displacement of the part has five axes (..., 5): x, y, z [m] and the rotations rx, ry [rad] about
a pivot, in the order and sense of a pose's tilt (about x, then about y). It is counted from where
the part sits when it is brought. M moves with the part; M0, where M is without a
displacement, stands still. F, the frame of the force sensor, is parallel to M0.

Each axis is an elastic, perfectly plastic spring. The axes slip on their own, because different
features hold them: suction along x, a fixture's stop and its friction along y.
"""

from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from simulator.checks import FloatArray, finite_array, read_only
from simulator.geometry import checked_poses, shaft_axis, tilt_of
from simulator.turning import turned, turned_back
from simulator.wrench import move_torque

HOLDER_AXES = 5


@dataclass(frozen=True, slots=True, eq=False)
class Holder:
    """Springs between the part and the arm. The default holds rigidly and never slips.

    `compliance` [m/N, rad/(N m)] has shape (5,) or, for different holders, (..., 5) as the poses;
    0 is rigid. `holding_force` [N, N m] of the same shapes is what an axis bears before the part
    slips along it; infinite by default. `pivot_m`, shape (3,), is the point of M0 about which the
    part turns. Raises `ValueError` for a compliance below 0 or not finite, a holding force that is
    not above 0, and a pivot that is not finite.
    """

    compliance: FloatArray = field(default_factory=lambda: np.zeros(HOLDER_AXES))
    holding_force: FloatArray = field(default_factory=lambda: np.full(HOLDER_AXES, np.inf))
    pivot_m: FloatArray = field(default_factory=lambda: np.zeros(3))

    def __post_init__(self) -> None:
        compliance = finite_array("Holder.compliance", self.compliance, HOLDER_AXES).copy()
        if (compliance < 0.0).any():
            raise ValueError(f"Holder.compliance is {compliance}; every entry must be at least 0")
        force = np.array(self.holding_force, dtype=np.float64)
        if force.shape[-1:] != (HOLDER_AXES,) or not (force > 0.0).all():
            raise ValueError(
                f"Holder.holding_force is {force}; it must be (..., 5), every entry above 0"
            )
        pivot = finite_array("Holder.pivot_m", self.pivot_m, 3).copy()
        if pivot.ndim != 1:
            raise ValueError(f"Holder.pivot_m has shape {pivot.shape}; it must be (3,)")
        object.__setattr__(self, "compliance", read_only(compliance))
        object.__setattr__(self, "holding_force", read_only(force))
        object.__setattr__(self, "pivot_m", read_only(pivot))

    def poses_in_part(self, poses: FloatArray, displacement: FloatArray) -> FloatArray:
        """Poses of the shaft in M, (..., 5), for poses in M0 and displacements of the part.

        The shaft's turn about its own axis, of second order in the tilts, is left out.
        """
        arm = poses[..., :3] - self.pivot_m - displacement[..., :3]
        tip = turned_back(arm, displacement[..., 3:]) + self.pivot_m
        axis = turned_back(shaft_axis(poses), displacement[..., 3:])
        return np.concatenate([tip, tilt_of(axis)], axis=-1)

    def load(self, wrench: FloatArray, displacement: FloatArray) -> FloatArray:
        """Load of each axis [N, N m], (..., 5), under a `wrench` (..., 6) on the part, in M.

        It is the generalised force of the displacement: its product with a small change of the
        displacement is the work on the part.
        """
        rx = displacement[..., 3]
        torque = move_torque(wrench, self.pivot_m)[..., 3:]
        about_y = np.cos(rx) * torque[..., 1] - np.sin(rx) * torque[..., 2]
        force = turned(wrench[..., :3], displacement[..., 3:])
        return np.concatenate([force, torque[..., :1], about_y[..., np.newaxis]], axis=-1)

    def wrench_at(
        self, sensor_m: npt.ArrayLike, wrench: npt.ArrayLike, displacement: npt.ArrayLike
    ) -> FloatArray:
        """The wrench on the part as the sensor sees it: (..., 6) [N, N m] in F.

        `wrench` (..., 6) is in M about its origin, `displacement` (..., 5) that of the part,
        `sensor_m` (3,) the sensor's origin in M0, which stands still. Raises `ValueError` for wrong
        shapes or entries that are not finite.
        """
        moved = finite_array("displacement", displacement, HOLDER_AXES)
        in_part = move_torque(wrench, self.pivot_m)
        force = turned(in_part[..., :3], moved[..., 3:])
        torque = turned(in_part[..., 3:], moved[..., 3:])
        about_pivot = np.concatenate([force, torque], axis=-1)
        return move_torque(about_pivot, np.asarray(sensor_m) - self.pivot_m - moved[..., :3])


def checked_offset(offset: npt.ArrayLike, poses: npt.ArrayLike) -> tuple[FloatArray, FloatArray]:
    """Return offset and poses, both (..., 5), as arrays of one shape; see `checked_poses`."""
    checked = checked_poses(poses)
    kept = finite_array("offset", offset, HOLDER_AXES)
    if kept.shape not in ((HOLDER_AXES,), checked.shape):
        raise ValueError(
            f"offset has shape {kept.shape}; it must be (5,) or, as the poses, {checked.shape}"
        )
    return np.broadcast_to(kept, checked.shape), checked
