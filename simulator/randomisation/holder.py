"""Distributions of how the part is held, and batches of holders drawn from them."""

from dataclasses import dataclass

import numpy as np

from simulator.checks import FloatArray
from simulator.holder import HOLDER_AXES, Holder
from simulator.randomisation.distributions import NONE, Distribution, Generators, drawn


@dataclass(frozen=True, slots=True)
class HolderDistribution:
    """See `Holder`; each axis x, y, z, rx, ry has its own. The default is rigid and never slips.

    Raises `ValueError` for another number of axes.
    """

    compliance: tuple[Distribution, ...] = (NONE,) * HOLDER_AXES
    """[m/N, rad/(N m)]"""
    holding_force: tuple[Distribution | None, ...] = (None,) * HOLDER_AXES
    """[N, N m]; None for an axis that never slips."""
    pivot_m: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """The same for all environments."""

    def __post_init__(self) -> None:
        for name in ("compliance", "holding_force"):
            if (count := len(getattr(self, name))) != HOLDER_AXES:
                raise ValueError(
                    f"HolderDistribution.{name} has {count} entries; it must have {HOLDER_AXES}"
                )

    def drawn(self, generators: Generators) -> Holder:
        """A batch of holders, one per environment."""
        compliance = [drawn(axis, 1, generators) for axis in self.compliance]
        force = [_holding_force(axis, generators) for axis in self.holding_force]
        return Holder(np.hstack(compliance), np.hstack(force), np.array(self.pivot_m))


def _holding_force(axis: Distribution | None, generators: Generators) -> FloatArray:
    """One draw per environment, shape (n, 1); it takes the same numbers where the axis holds."""
    if axis is None:
        return drawn(NONE, 1, generators) + np.inf
    return drawn(axis, 1, generators)
