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

Where several surfaces meet a circle, its height is the least of smooth functions, with kinks. On an
arc with one peak the sign of the slope tells on which side of a point the peak lies, kink or not,
so the arc is halved until the peak is known to rounding.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from simulator.checks import FloatArray

Height = Callable[[FloatArray, FloatArray], tuple[FloatArray, FloatArray]]
"""Values, and their slopes with the angle, on n circles, at the points (..., n) given by the two
components of unit vectors."""


@dataclass(frozen=True, slots=True)
class Search:
    """A way to find the best point of a circle."""

    direction: Callable[[FloatArray, FloatArray], FloatArray]
    """Maps m, shape (2, ...), and b, shape (...), to the best unit vector e, shape (2, ...)."""
    peak: Callable[[Height, FloatArray, FloatArray], FloatArray]
    """Maps a height on n circles to the unit vectors (2, 2, n) of the greatest, on half circles.

    The first one lies just before the peak, where the height still rises, the second just behind.
    Half circles are the unit vectors (cos t, side sin t) with `side`, shape (n,), of -1 or 1, and t
    from 0 to pi. The angles in `ends`, shape (A + 1, n), divide each into A arcs, on every one of
    which the height rises to one peak and falls again.
    """


NEWTON_STEPS = 5
HALVINGS = 51
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


def halved(
    is_before: Callable[[FloatArray], npt.NDArray[np.bool_]], low: FloatArray, high: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Between which angles, 1e-15 apart, `is_before` turns from true to false above `low`."""
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        before = is_before(middle)
        low, high = np.where(before, middle, low), np.where(before, high, middle)
    return low, high


def _peak_by_slope(height: Height, side: FloatArray, ends: FloatArray) -> FloatArray:
    """Unit vectors (2, 2, n) about the greatest height on half circles; see `Search.peak`."""

    def is_rising(angle: FloatArray) -> npt.NDArray[np.bool_]:
        rising: npt.NDArray[np.bool_] = height(np.cos(angle), side * np.sin(angle))[1] * side > 0.0
        return rising

    angle = np.stack(halved(is_rising, ends[:-1], ends[1:]))
    best = height(np.cos(angle[0]), side * np.sin(angle[0]))[0].argmax(axis=0)
    angle = np.take_along_axis(angle, best[np.newaxis, np.newaxis], axis=1)[:, 0]
    return np.stack([np.cos(angle), side * np.sin(angle)])  # (2 components, 2 sides, n)


exact_search = Search(_newton_direction, _peak_by_slope)


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

    def peak(height: Height, _side: FloatArray, _ends: FloatArray) -> FloatArray:
        best = circle[:, height(*circle[..., np.newaxis])[0].argmax(axis=0)]
        return np.stack([best, best], axis=1)

    return Search(direction, peak)
