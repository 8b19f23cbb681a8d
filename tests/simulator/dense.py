"""An optimiser that knows nothing of the model: a dense grid of angles, refined at its summits."""

from collections.abc import Callable

import numpy as np
from scipy.optimize import minimize_scalar

from simulator.checks import FloatArray

Height = Callable[[FloatArray], FloatArray]


def greatest(height: Height, points: int) -> float:
    """Greatest value over all angles: a grid of `points`, then a search at its three best ones."""
    grid = np.linspace(0.0, 2.0 * np.pi, points)
    values = height(grid)
    summits = np.flatnonzero((values >= np.roll(values, 1)) & (values >= np.roll(values, -1)))
    best = float(values.max())
    for summit in summits[np.argsort(-values[summits])[:3]]:
        found = minimize_scalar(
            lambda away, start=grid[summit]: -float(height(start + np.array(away))),
            bounds=(-grid[1], grid[1]),
            method="bounded",
            options={"xatol": 1e-12},
        )
        best = max(best, -float(found.fun))
    return best
