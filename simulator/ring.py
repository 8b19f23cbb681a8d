"""Ring of contact: a circle in an interference fit, or one wedged by the tilt, touches all around.

Four points a quarter turn apart, the best one and three more, stand for it. With the penetration
delta + e cos(phi) around the circle, their forces are those of an even elastic foundation with the
energy 2 k delta^2 + k e^2, whatever the direction of the first one.
"""

import numpy as np

from simulator.candidates import Candidates
from simulator.checks import FloatArray
from simulator.circle import Circles
from simulator.deepest import Deepest
from simulator.geometry import Part, Shaft
from simulator.heading import Heading

Ring = tuple[FloatArray, FloatArray, FloatArray]
"""Penetration (3, C, P), points and normals (3, 3, C, P), zero where a point does not touch;
the three points are on axis -3."""

_QUARTERS = np.array(
    [[[0.0, -1.0], [1.0, 0.0]], [[-1.0, 0.0], [0.0, -1.0]], [[0.0, 1.0], [-1.0, 0.0]]]
)


def ring_points(
    part: Part,
    shaft: Shaft,
    heading: Heading,
    table: Candidates,
    found: Deepest,
    penetration: FloatArray,
) -> Ring | None:
    """The three other points of every circle; None if no circle can touch with any of them."""
    if not _may_touch(part, shaft, heading, found.overlap):
        return None
    candidate, pose = np.nonzero(penetration > 0.0)
    circles = Circles.of(part, shaft, heading, table, candidate, pose)
    e = np.einsum("qij,jn->iqn", _QUARTERS, found.e[:, candidate, pose])
    effective = np.maximum(circles.penetration(*e)[0], 0.0)
    place = np.stack(circles.place(e, circles.spot(e)), axis=1)
    heading.at(pose).to_part(place)
    depth, vectors = np.zeros((3, *penetration.shape)), np.zeros((3, 2, 3, *penetration.shape))
    depth[:, candidate, pose] = effective
    vectors[..., candidate, pose] = np.where(effective > 0.0, place, 0.0)
    return depth, vectors[:, 0], vectors[:, 1]


def _may_touch(part: Part, shaft: Shaft, heading: Heading, overlap: FloatArray) -> bool:
    """Whether any of the three points might: a bound, for plain solids, from the overlap [m].

    With b e1^2 the part of the squared distance that a tilt adds, b = r^2 sin^2, a point a quarter
    turn from the extremum differs from the circle's centre by at most 1.62 b in favour of contact,
    the opposite one by at most b. A rim's centre adds to the distance of its points. That of an
    edge is within overlap + R - r cos of the hole's axis.
    """
    if overlap.size == 0 or (deepest := float(np.maximum.reduce(overlap, axis=None))) <= 0.0:
        return False
    if not (part.is_plain and shaft.is_plain):
        return True
    r, bore = shaft.radius_m, float(np.minimum.reduce(part.wall_radii_m))
    square = float(np.maximum.reduce(heading.sin)) ** 2
    away = deepest + bore - r * (1.0 - square)
    return r * r > bore * bore * (1.0 - 2.0 * square) or away * away + 2.0 * r * r * square > (
        bore * bore - r * r
    )
