"""Best points against several faces, and greatest penetrations: where no closed form serves.

Most circles need neither: the radially deepest point has met a bore or a cylinder and all of the
overlap is effective. The others are searched, one by one; see `simulator.circle`.
"""

import numpy as np

from simulator.candidates import Candidates
from simulator.checks import FloatArray
from simulator.circle import Circles
from simulator.deepest import Deepest
from simulator.extremum import Search
from simulator.geometry import Part, Shaft
from simulator.heading import Heading


def meet_faces(
    part: Part, shaft: Shaft, heading: Heading, table: Candidates, found: Deepest, search: Search
) -> None:
    """Move the points in `found` to the best ones against all faces of the other solid, in place.

    A radially deepest point that lies against a bore or a cylinder already is the best one. Circles
    that cannot be in contact keep theirs, and their radial clearance.
    """
    near = _bound(part, shaft, heading, found) > 0.0
    if not np.logical_or.reduce(near, axis=None):
        return
    candidate, pose = np.nonzero(near)
    circles = Circles.of(part, shaft, heading, table, candidate, pose)
    slanted = circles.spot(found.e[:, candidate, pose]).normal[1] != 0.0
    if not np.logical_or.reduce(slanted):
        return
    candidate, pose = candidate[slanted], pose[slanted]
    circles = Circles.of(part, shaft, heading, table, candidate, pose)
    e, spot = circles.best(search)
    entered = circles.entered(spot.axial)
    left = circles.length - entered
    found.e[:, candidate, pose] = e
    found.overlap[candidate, pose] = spot.depth
    found.entered[candidate, pose] = np.where(circles.is_rim, np.minimum(entered, left), entered)
    found.passed[candidate, pose] = np.where(circles.is_rim, 0.0, np.maximum(-left, 0.0))
    share = np.hypot(*spot.normal)
    found.share[candidate, pose] = share
    place = np.stack(circles.place(e, spot), axis=1)
    place[:, 1] /= share
    heading.at(pose).to_part(place)
    found.point[:, candidate, pose], found.normal[:, candidate, pose] = place[:, 0], place[:, 1]


def effective_penetration(
    part: Part, shaft: Shaft, heading: Heading, table: Candidates, found: Deepest, search: Search
) -> FloatArray:
    """Greatest effective penetration [m] on each circle, at least 0: shape (C, P).

    Without a tilt, or where all of the overlap is effective, the point in `found` has it. A circle
    is searched only where the change of the entered distance from one side to the other could lift
    another point above it.
    """
    penetration = np.minimum(found.overlap, found.entered)
    penetration -= found.passed
    np.maximum(penetration, 0.0, out=penetration)
    cut = _bound(part, shaft, heading, found) > penetration
    if np.logical_or.reduce(cut, axis=None):
        circles = Circles.of(part, shaft, heading, table, *np.nonzero(cut))
        best = circles.greatest_penetration(search)
        penetration[cut] = np.maximum(penetration[cut], best)
    return penetration


def _bound(part: Part, shaft: Shaft, heading: Heading, found: Deepest) -> FloatArray:
    """Upper bound (C, P) [m] of the effective penetration on each circle."""
    bound = np.minimum(found.overlap, found.entered)
    bound -= found.passed
    widest_m = 2.0 * max(shaft.radius_m, float(np.maximum.reduce(part.rim_radii_m)))
    bound += widest_m * heading.sin
    return np.minimum(bound, found.overlap, out=bound)
