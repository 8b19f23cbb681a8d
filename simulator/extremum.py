"""Extremum on a circle: exact, and by cutting the circle into points.

Both contact searches (shaft-based and hole-based) are one problem: over unit vectors e of the
plane, maximise

    g(e) = 2 m.e + b e1^2,   b >= 0,

a trust-region problem in two dimensions. With a = |m1|, c = |m2| the maximum lies in the first
quadrant, and there t = e2/e1 is the only root of a t + b t/sqrt(1 + t^2) - c, which is increasing
and concave. Newton's method from the left of the root therefore rises to it monotonically. Written
for the vector e, one step is

    e <- normalised (a + b e1^3, c - b e2^3).

The start e2 = c/y with y = max(b, c) + a + (a^2 b)^(1/3) lies left of the root and within a
constant factor of it for every ratio a : b : c, so a fixed number of steps reaches machine
precision.

The effective penetration of a circle has kinks. Its maximum is found by narrowing down arcs on
which it has one peak, which needs neither derivatives nor the kind of the peak.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from simulator.checks import FloatArray

Height = Callable[[FloatArray, FloatArray], FloatArray]
"""Values (..., n) on n circles, at the points given by the two components of unit vectors."""


@dataclass(frozen=True, slots=True)
class Search:
    """A way to find the best point of a circle."""

    direction: Callable[[FloatArray, FloatArray], FloatArray]
    """Maps m, shape (2, ...), and b, shape (...), to the best unit vector e, shape (2, ...)."""
    highest: Callable[[Height, FloatArray, FloatArray], FloatArray]
    """Maps a height on n circles to its greatest values (n,), which lie on half circles.

    These are the unit vectors (cos t, side sin t) with `side`, shape (n,), of -1 or 1, and t from 0
    to pi. The angles in `ends`, shape (A + 1, n), divide each into A arcs, on every one of which
    the height rises to one peak and falls again.
    """


NEWTON_STEPS = 5
CUTS = 16
ROUNDS = 14
_TINY = 1e-300
_FLOOR = 1e-20
_CHUNK_POINTS = 1 << 20


def _newton_direction(m: FloatArray, b: FloatArray) -> FloatArray:
    """Unit vector e that maximises g(e); m and e have shape (2, ...), b >= 0 has shape (...).

    The maximum is global, and g(e) is exact to rounding. If m1 = 0 and |m2| < b, (e1, e2) and (-e1,
    e2) are equal and the one with e1 > 0 is returned; m = 0 and b = 0 gives (1, 0). m1 is lifted to
    1e-20 of the problem's size, which keeps every step well defined and moves e by more than
    rounding only where m1 = 0 and |m2| = b (there e1 = 3e-7 in place of 0, g unchanged).
    """
    size = np.abs(m)
    largest = np.maximum(b, size[1])
    largest += size[0]
    largest += _TINY
    size[0] += _FLOOR * largest
    scale = largest + np.cbrt(size[0] * size[0] * b)
    size /= scale
    curvature = np.empty_like(size)
    np.divide(b, scale, out=curvature[0])
    np.negative(curvature[0], out=curvature[1])
    e = size.copy()
    power = e * e
    np.sqrt(1.0 - power[1], out=e[0])
    for _ in range(NEWTON_STEPS):
        np.multiply(e, e, out=power)
        power *= e
        power *= curvature
        np.add(size, power, out=e)
        np.multiply(e, e, out=power)
        e /= np.sqrt(power[0] + power[1])
    return np.copysign(e, m)


def _highest_peak(height: Height, side: FloatArray, ends: FloatArray) -> FloatArray:
    """Greatest values (n,) of a height on half circles; see `Search.highest`.

    Of evenly spaced points on an arc the best one has the peak between its neighbours. So each
    round shortens an arc by half the number of cuts; the last arcs are below 1e-12 rad.
    """
    low, width = ends[:-1], np.diff(ends, axis=0) / CUTS
    steps = np.arange(CUTS + 1.0)[:, np.newaxis, np.newaxis]
    for _ in range(ROUNDS):
        angle = low + width * steps
        values = height(np.cos(angle), side * np.sin(angle))
        best = values.argmax(axis=0)
        first, last = np.maximum(best - 1, 0), np.minimum(best + 1, CUTS)
        low, width = low + width * first, width * ((last - first) / CUTS)
    highest: FloatArray = values.max(axis=(0, 1))
    return highest


exact_search = Search(_newton_direction, _highest_peak)


def discretised_search(points: int) -> Search:
    """The paper's search: the best of `points` equally spaced points, the first at e = (1, 0)."""
    if points < 3:
        raise ValueError(f"points is {points}; a circle is cut into at least 3")
    angle = np.arange(points) * (2.0 * np.pi / points)
    circle = np.stack([np.cos(angle), np.sin(angle)])
    terms = np.concatenate([2.0 * circle, circle[:1] ** 2])

    def direction(m: FloatArray, b: FloatArray) -> FloatArray:
        weights = np.concatenate([m, b[np.newaxis]]).reshape(3, -1).T
        best = np.empty(len(weights), dtype=np.intp)
        rows = max(1, _CHUNK_POINTS // points)
        for start in range(0, len(weights), rows):
            best[start : start + rows] = (weights[start : start + rows] @ terms).argmax(axis=1)
        return circle[:, best].reshape(m.shape)

    def highest(height: Height, _side: FloatArray, _ends: FloatArray) -> FloatArray:
        best: FloatArray = height(*circle[..., np.newaxis]).max(axis=0)
        return best

    return Search(direction, highest)
