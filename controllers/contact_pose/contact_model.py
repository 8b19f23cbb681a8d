"""What a force sensor should read under a hypothesis, and how well that fits what it reads."""

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from controllers.contact_pose.hypotheses import OFFSET, TILT, Parameter
from simulator.checks import FloatArray, non_negative, positive
from simulator.compiled import kernel
from simulator.engine.batch import Batch
from simulator.engine.solve import solve
from simulator.engine.table import tabulate
from simulator.engine.widening import widened
from simulator.geometry import POSE_SIZE, Part, Shaft

StateArray = npt.NDArray[np.int8]


@dataclass(frozen=True, slots=True)
class Noise:
    """Standard deviations of what is between the contact model and a reading.

    Raises `ValueError`, naming the setting, for one out of range; the sensor's must be above 0.
    """

    force_N: float
    torque_Nm: float
    place_m: float
    """Of where the stage is taken to be; a stiffer contact turns it into more force."""
    model: float
    """Of the contact model itself, as a share of the force."""

    def __post_init__(self) -> None:
        positive("Noise.force_N", self.force_N)
        positive("Noise.torque_Nm", self.torque_Nm)
        non_negative("Noise.place_m", self.place_m)
        non_negative("Noise.model", self.model)


@dataclass(frozen=True, slots=True, eq=False)
class Trace:
    """T observations of an insertion; rows are observations."""

    poses: FloatArray
    """(T, 5): as the stage reports them, in M."""
    travels: FloatArray
    """(T, 3): translation since the observation before [m]."""
    wrenches: FloatArray
    """(T, 6): as the sensor reads them [N, N m], frame F."""

    def __len__(self) -> int:
        return len(self.poses)


class ContactModel:
    """The contact model of a part as drawn, under hypotheses of where and what it really is."""

    def __init__(self, part: Part, shaft: Shaft, sensor_m: tuple[float, float, float]) -> None:
        """`sensor_m` is the origin of frame F in M."""
        self._table = tabulate([(part, shaft)])
        self._drawn_clearance_m = 2.0 * (part.wall_radii_m[0] - shaft.radius_m)
        self._sensor_m = np.array(sensor_m)
        self.pivot_depth_m = 0.5 * float(part.wall_entries_m[0] + part.wall_exits_m[0])
        """Depth of the middle of the first wall."""

    def contacts(self, hypotheses: FloatArray, poses: FloatArray, travels: FloatArray) -> Batch:
        """Contacts under n `hypotheses` (n, 7) at T `poses` (T, 5), n T rows of T for each.

        Torques are about the sensor's origin. Raises `ValueError` for a hypothesis without a bore.
        """
        n, count = len(hypotheses), len(poses)
        shaft_poses = np.empty((n, count, POSE_SIZE))
        shaft_poses[:] = poses
        shaft_poses[..., :2] += hypotheses[:, np.newaxis, OFFSET]
        shaft_poses[..., 3:] += hypotheses[:, np.newaxis, TILT]
        widening = hypotheses[:, Parameter.CLEARANCE] - self._drawn_clearance_m
        found = solve(
            widened(self._table, widening),
            shaft_poses.reshape(-1, POSE_SIZE),
            np.tile(travels, (n, 1)),
            stiffness_N_m=np.repeat(hypotheses[:, Parameter.STIFFNESS], count),
            friction=np.repeat(hypotheses[:, Parameter.FRICTION], count),
            geometry=np.repeat(np.arange(n), count),
        )
        move_torques(found.wrench, self._sensor_m)
        return found

    def fit(
        self, hypotheses: FloatArray, trace: Trace, noise: Noise
    ) -> tuple[FloatArray, FloatArray]:
        """Log-likelihood and squared misfit of each observation under each hypothesis, both (n, T).

        Constants that no hypothesis changes are left out of the likelihood. The misfit is by its
        standard deviations and adds up six axes.
        """
        n, count = len(hypotheses), len(trace)
        found = self.contacts(hypotheses, trace.poses, trace.travels)
        log_likelihood, misfit = np.empty((n, count)), np.empty((n, count))
        levers = 0.5 * np.maximum(trace.poses[:, 2], 0.0) - self._sensor_m[2]
        weigh(
            found.wrench.reshape(n, count, 6),
            trace.wrenches,
            hypotheses[:, Parameter.STIFFNESS] * noise.place_m,
            levers,
            (noise.force_N, noise.torque_Nm, noise.model),
            log_likelihood,
            misfit,
        )
        return log_likelihood, misfit


@kernel
def move_torques(wrenches: FloatArray, origin: FloatArray) -> None:
    """Refer the torques of `wrenches` (n, 6) to `origin` (3,) in place: torque - origin x force."""
    x, y, z = origin
    for i in range(len(wrenches)):
        fx, fy, fz = wrenches[i, 0], wrenches[i, 1], wrenches[i, 2]
        wrenches[i, 3] -= y * fz - z * fy
        wrenches[i, 4] -= z * fx - x * fz
        wrenches[i, 5] -= x * fy - y * fx


@kernel
def weigh(
    expected: FloatArray,
    observed: FloatArray,
    place_N: FloatArray,
    levers_m: FloatArray,
    noise: tuple[float, float, float],
    log_likelihood: FloatArray,
    misfit: FloatArray,
) -> None:
    """Write log-likelihoods and misfits (n, T) of `observed` (T, 6) where `expected` (n, T, 6) was.

    The sensor's own noise is independent on each axis. What the model lacks is, on each axis of the
    force alike, a share of the radial force that there is, and up to `place_N` (n,) of it: in free
    air an error of place makes no force. Of the radial axes it acts at the lever (T,) from the
    sensor, so that it shows in force and torque alike. Determinant and squares are sums of positive
    terms: of the full covariance they would be differences.
    """
    force_N, torque_Nm, share = noise
    of_force, of_torque = force_N * force_N, torque_Nm * torque_Nm
    for i in range(len(expected)):
        for t in range(len(observed)):
            wrench, lever = expected[i, t], levers_m[t]
            radial = math.hypot(wrench[0], wrench[1])
            of_place = min(place_N[i], radial)
            lack = share * share * radial * radial + of_place * of_place
            along, across = of_force + lack, of_torque + lever * lever * of_force
            determinant = of_force * of_torque + lack * across
            total = 0.0
            for axis in range(2):
                force = observed[t, axis] - wrench[axis]
                torque = observed[t, 4 - axis] - wrench[4 - axis]
                if axis == 1:
                    torque = -torque
                apart = lever * force - torque
                total += (
                    of_torque * force * force + of_force * torque * torque + lack * apart * apart
                ) / determinant
            axial = observed[t, 2] - wrench[2]
            twist = observed[t, 5] - wrench[5]
            total += axial * axial / along + twist * twist / of_torque
            misfit[i, t] = total
            spread = 2.0 * math.log(determinant / (of_force * of_torque)) + math.log(
                along / of_force
            )
            log_likelihood[i, t] = -0.5 * (total + spread)
