"""Axial blocking: an end that stands on the face of a wall beside its hole.

A pose alone cannot tell a shaft that stands on a mouth's edge from one that has entered and pushes
against the wall. So each wall has a state, whether the shaft has entered it, which the caller
keeps: `update_entered` carries it on from pose to pose.

What stands is the first edge circle of the shaft, its end's rim. Of a rounded end this is where the
end is flat no more, and its lowest point lies the rounding's radius below the circle of centres.
"""

import numpy as np
import numpy.typing as npt

from simulator.checks import FloatArray
from simulator.deepest import Deepest
from simulator.extremum import exact_search
from simulator.geometry import POSE_SIZE, Part, Shaft, checked_poses
from simulator.heading import Heading

BoolArray = npt.NDArray[np.bool_]


def update_entered(
    part: Part, shaft: Shaft, poses: npt.ArrayLike, entered: npt.ArrayLike
) -> BoolArray:
    """Which walls the shaft has entered at `poses`, shape (..., N), if it had `entered` before.

    A wall is entered once the end is, anywhere, below the mouth's plane without reaching out over
    the mouth, and left once the end is wholly above that plane. Raises `ValueError` as `solve`.
    """
    poses = checked_poses(poses)
    before = checked_entered(part, poses, entered)
    heading = Heading.of(np.ascontiguousarray(poses.reshape(-1, POSE_SIZE).T))
    farthest = _farthest_point(shaft, heading)
    radius, behind = float(shaft.edge_radii_m[0]), float(shaft.edge_stations_m[0])
    lowest = heading.centre[2] - behind * heading.cos + radius * heading.sin
    below = lowest + shaft.rounding_m > part.wall_entries_m[:, np.newaxis]
    clears = np.hypot(farthest[0], farthest[1]) <= part.wall_mouths_m[:, np.newaxis]
    now = below.T.reshape(before.shape)
    entering = (below & clears).T.reshape(before.shape)
    return np.asarray((before & now) | entering)


def checked_entered(part: Part, poses: FloatArray, entered: npt.ArrayLike) -> BoolArray:
    """Return `entered` if it is boolean and of shape (..., N), one row for each pose (..., 5)."""
    array, shape = np.asarray(entered), (*poses.shape[:-1], len(part.holes))
    if array.dtype != np.bool_ or array.shape != shape:
        raise ValueError(
            f"entered is {array.dtype} of shape {array.shape}; it must be bool of shape {shape}"
        )
    return array


def standing(part: Part, shaft: Shaft, heading: Heading, entered: BoolArray) -> FloatArray:
    """How far below the mouth's plane the end stands on each wall's face (N, P) [m], or 0.

    `entered`, shape (N, P), holds the walls on which it cannot stand.
    """
    farthest = _farthest_point(shaft, heading)
    below = farthest[2] - part.wall_entries_m[:, np.newaxis]
    out = np.hypot(farthest[0], farthest[1]) > part.wall_mouths_m[:, np.newaxis]
    return np.where(out & ~entered, np.maximum(below, 0.0), 0.0)


def stand_on_faces(
    part: Part, shaft: Shaft, heading: Heading, depth: FloatArray, found: Deepest
) -> None:
    """Turn the contact of the first edge into that with the face, where depth (N, P) > 0."""
    rims = len(part.rim_holes)
    wall, pose = np.nonzero(depth > 0.0)
    point = _farthest_point(shaft, heading)[:, pose]
    heading.at(pose).to_part(point)
    found.point[:, rims + wall, pose] = point
    found.normal[:, rims + wall, pose] = np.array([[0.0], [0.0], [1.0]])
    found.overlap[rims + wall, pose] = depth[wall, pose]
    found.share[rims + wall, pose] = 1.0


def _farthest_point(shaft: Shaft, heading: Heading) -> FloatArray:
    """Point of the end's rim farthest from the holes' axis, (3, P), in the heading frame."""
    radius, behind = float(shaft.edge_radii_m[0]), float(shaft.edge_stations_m[0])
    x = heading.centre[0] - behind * heading.sin
    m = np.stack([heading.centre[1], heading.cos * x])
    across, along = radius * exact_search.direction(m, radius * heading.sin * heading.sin)
    lowered = behind * heading.cos + along * heading.sin - shaft.rounding_m
    return np.stack(
        [x + heading.cos * along, heading.centre[1] + across, heading.centre[2] - lowered]
    )
