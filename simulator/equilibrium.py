"""Quasi-static equilibrium of the held part: holder force = contact force.

Per axis, the holder's return mapping is written with one unknown z [N, N m]: its force is z clipped
to the holding force H, the part's displacement is

    w = offset + compliance * clip(z) + slip,    slip = (compliance + c) * (z - clip(z)),

with any c [m/N, rad/(N m)] above 0, so that slip has a slope also for a rigid axis. Every z is a
state of the spring, and equilibrium is clip(z) = load(w), the load of the contact in the shaft's
pose relative to the displaced part. The slip becomes part of the offset, and stays when the load
goes.

The equations have kinks, where contacts open and close and where the part begins to slip, and with
friction no potential energy. They are solved by Newton's method on the force balance itself, with
the one-sided derivative at a kink (L. Qi and J. Sun, "A nonsmooth version of Newton's method",
Mathematical Programming 58, 1993), and the best of several step lengths.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from simulator.checks import FloatArray, read_only
from simulator.contact import ContactLaw, solve
from simulator.geometry import Part, Shaft
from simulator.holder import HOLDER_AXES, Holder, checked_offset
from simulator.stick import StickLaw, StickState, advance

BoolArray = npt.NDArray[np.bool_]
ContactWrench = Callable[[FloatArray], FloatArray]
"""Maps poses of the shaft in M, (K, ..., 5), to wrenches on the part about M's origin, (K, ..., 6);
K trials for each entry of the batch (...). A pure function, the same for every trial."""

TOLERANCE_N = 1e-9
ARM_M = 1e-3
"""Torques count as forces at this arm: the tolerance of a torque is 1e-12 N m."""
ITERATIONS = 60

_STEP = np.array([1e-10, 1e-10, 1e-10, 1e-7, 1e-7])
_FARTHEST = np.array([1e-5, 1e-5, 1e-5, 1e-3, 1e-3])
_ARMS = np.array([1.0, 1.0, 1.0, ARM_M, ARM_M])
# c of the top of this module, about the contact's own compliance; it has no part in the result.
_SLIP_SLOPE = np.array([1e-4, 1e-4, 1e-4, 4.0, 4.0])
_FRACTIONS = 0.5 ** np.arange(12.0)
_CLOSER_LOOKS = 3
_DAMPING = 1e-12


@dataclass(frozen=True, slots=True, eq=False)
class Equilibrium:
    """Equilibria of a batch (...): read-only arrays. Where not `converged`, do not use them."""

    displacement: FloatArray
    """(..., 5) [m, rad]: displacement of the part, from where it was brought."""
    offset: FloatArray
    """(..., 5) [m, rad]: what remains of it when the load goes; the state for the next call."""
    holder_force: FloatArray
    """(..., 5) [N, N m]: what the holder's axes bear; see `Holder.load`."""
    pose: FloatArray
    """(..., 5): pose of the shaft in M, which the contact sees."""
    wrench: FloatArray
    """(..., 6) [N, N m]: wrench on the part, in M, about its origin."""
    residual_N: FloatArray
    """(...): largest difference of holder and contact force on an axis, torques over `ARM_M`."""
    converged: BoolArray
    """(...): whether the residual is within `TOLERANCE_N`."""


def sliding_contact(
    part: Part, shaft: Shaft, sliding: npt.ArrayLike, law: ContactLaw
) -> ContactWrench:
    """Contact that slides in the direction `sliding`, (3,) or as the poses (..., 3): `solve`."""
    direction = np.asarray(sliding, dtype=np.float64)

    def wrench(poses: FloatArray) -> FloatArray:
        along = direction
        if direction.ndim > 1:
            along = np.broadcast_to(direction, (*poses.shape[:-1], 3))
        return solve(part, shaft, poses, along, law).wrench

    return wrench


def sticking_contact(part: Part, shaft: Shaft, state: StickState, law: StickLaw) -> ContactWrench:
    """Contact that sticks or slides on from `state`; `advance` it to the pose that is found."""
    return lambda poses: advance(part, shaft, poses, state, law).wrench


def settle(
    holder: Holder, offset: npt.ArrayLike, poses: npt.ArrayLike, contact: ContactWrench
) -> Equilibrium:
    """Where the part comes to rest under the shaft at `poses`, shape (..., 5) in M0.

    `offset`, (5,) or (..., 5), is the displacement that the part has without load. Every entry of
    the batch is solved on its own, and its result does not depend on the others. Raises
    `ValueError` for poses or an offset of a wrong shape or not finite.
    """
    start, nominal = checked_offset(offset, poses)
    system = _System(holder, start, nominal, contact)
    z = np.zeros(nominal.shape)
    wrench, residual = system.balance(z[np.newaxis])
    error = _largest(residual[0])
    for _ in range(ITERATIONS):
        active = ~(error <= TOLERANCE_N)
        if not active.any():
            break
        step = system.limited(z, system.newton_step(z, residual[0]))
        step = np.where(active[..., np.newaxis], step, 0.0)
        z, wrench, residual = system.search(z, step)
        error = _largest(residual[0])
    return system.result(z, wrench[0], error)


@dataclass(frozen=True, slots=True, eq=False)
class _System:
    """The equations clip(z) = load(w(z)) of a batch; see the top of this module."""

    holder: Holder
    offset: FloatArray
    poses: FloatArray
    contact: ContactWrench

    def force(self, z: FloatArray) -> FloatArray:
        limit = self.holder.holding_force
        return np.clip(z, -limit, limit)

    def slope(self, z: FloatArray) -> FloatArray:
        """Change of the displacement with z."""
        slipping = np.abs(z) > self.holder.holding_force
        slope: FloatArray = self.holder.compliance + np.where(slipping, _SLIP_SLOPE, 0.0)
        return slope

    def displacement(self, z: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Displacement of the part, and the offset that it leaves."""
        force = self.force(z)
        left = self.offset + (self.holder.compliance + _SLIP_SLOPE) * (z - force)
        return left + self.holder.compliance * force, left

    def load(self, displacement: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Wrench of the contact and the load of the axes, for trials (K, ..., 5)."""
        poses = np.broadcast_to(self.poses, displacement.shape)
        wrench = self.contact(self.holder.poses_in_part(poses, displacement))
        return wrench, self.holder.load(wrench, displacement)

    def balance(self, z: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Wrench and residual clip(z) - load(w) [N, N m], for trials (K, ..., 5)."""
        wrench, load = self.load(self.displacement(z)[0])
        return wrench, self.force(z) - load

    def search(self, z: FloatArray, step: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """The best point on the way from `z` to `z + step`, with wrench and residual of K = 1.

        Lengths are halved down; then those are looked at more closely between which the residual
        along the step changes its sign. Where a part slips out of contact, both ends may be far
        off, and the far end a plateau that no step leads away from.
        """
        fractions = np.broadcast_to(
            _FRACTIONS.reshape(-1, *[1] * (z.ndim - 1)), (len(_FRACTIONS), *z.shape[:-1])
        )
        found: list[tuple[FloatArray, FloatArray, FloatArray]] = []
        for _ in range(_CLOSER_LOOKS + 1):
            trials = z + fractions[..., np.newaxis] * step
            wrenches, residuals = self.balance(trials)
            found.append((trials, wrenches, residuals))
            along = (residuals * step / _ARMS**2).sum(axis=-1)
            turns = (along[:-1] > 0.0) != (along[1:] > 0.0)
            if not turns.any():
                break
            first = turns.argmax(axis=0)[np.newaxis]
            far, near = (np.take_along_axis(fractions, first + k, axis=0) for k in (0, 1))
            shares = np.linspace(0.0, 1.0, len(_FRACTIONS)).reshape(-1, *[1] * (z.ndim - 1))
            fractions = far + shares * (near - far)
        columns = [np.concatenate(arrays) for arrays in zip(*found, strict=True)]
        best = _squares(columns[2]).argmin(axis=0)[np.newaxis, ..., np.newaxis]
        point, wrench, residual = (np.take_along_axis(c, best, axis=0) for c in columns)
        return point[0], wrench, residual

    def newton_step(self, z: FloatArray, residual: FloatArray) -> FloatArray:
        """The change of z that takes the linearised residual to zero."""
        steps = np.concatenate([np.zeros((1, HOLDER_AXES)), np.diag(_STEP)])
        displacement, _ = self.displacement(z)
        _, load = self.load(displacement + steps.reshape(-1, *[1] * (z.ndim - 1), HOLDER_AXES))
        columns = (load[1:] - load[0]) / _STEP.reshape(-1, *[1] * z.ndim)
        inside = np.abs(z) <= self.holder.holding_force
        jacobian = -np.moveaxis(columns, 0, -1) * self.slope(z)[..., np.newaxis, :]
        jacobian = jacobian + inside[..., np.newaxis] * np.eye(HOLDER_AXES)
        scaled = jacobian * (_ARMS / _ARMS[:, np.newaxis])
        return -_ARMS * _least_squares(scaled, residual / _ARMS)

    def limited(self, z: FloatArray, step: FloatArray) -> FloatArray:
        """`step`, made shorter where it would move the part out of the contact's neighbourhood."""
        slope = np.maximum(self.slope(z), self.slope(z + step))
        ratio = (np.abs(step * slope) / _FARTHEST).max(axis=-1, keepdims=True)
        shorter: FloatArray = step / np.maximum(ratio, 1.0)
        return shorter

    def result(self, z: FloatArray, wrench: FloatArray, error: FloatArray) -> Equilibrium:
        displacement, left = self.displacement(z)
        return Equilibrium(
            displacement=read_only(displacement),
            offset=read_only(left),
            holder_force=read_only(self.force(z)),
            pose=read_only(self.holder.poses_in_part(self.poses, displacement)),
            wrench=read_only(wrench),
            residual_N=read_only(error),
            converged=error <= TOLERANCE_N,
        )


def _least_squares(matrix: FloatArray, right: FloatArray) -> FloatArray:
    """Solution x of matrix x = right, (..., 5, 5) and (..., 5); damped, so a singular one has one.

    By normal equations and elimination without pivots (they are positive definite), entry by entry:
    each entry's bits are the same in any batch.
    """
    n = matrix.shape[-1]
    table = np.zeros((n, n + 1, *matrix.shape[:-2]))
    for i in range(n):
        for k in range(n):
            row = matrix[..., k, i]
            for j in range(n):
                table[i, j] += row * matrix[..., k, j]
            table[i, n] += row * right[..., k]
        table[i, i] += _DAMPING
    for i in range(n):
        table[i, i:] /= table[i, i].copy()
        for k in range(n):
            if k != i:
                table[k, i:] -= table[k, i].copy() * table[i, i:]
    return np.moveaxis(table[:, n], 0, -1)


def _squares(residual: FloatArray) -> FloatArray:
    scaled = residual / _ARMS
    total = np.zeros(scaled.shape[:-1])
    for axis in range(HOLDER_AXES):
        total += scaled[..., axis] ** 2
    return total


def _largest(residual: FloatArray) -> FloatArray:
    largest: FloatArray = np.abs(residual / _ARMS).max(axis=-1)
    return largest
