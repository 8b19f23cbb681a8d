"""Random poses of the shaft after alignment (paper section 3.2, eq. 3 with R_z = 1)."""

import numpy as np

from simulator.checks import FloatArray, non_negative


def initial_poses(
    n: int,
    position_error_m: float,
    tilt_error_rad: float,
    depth_m: float,
    generator: np.random.Generator,
) -> FloatArray:
    """`n` poses, shape (n, 5), with B2's centre at z = `depth_m` in M (negative: above the part).

    The lateral offset is uniform in the disc of radius `position_error_m`, the tilt (rx, ry)
    uniform in the disc of radius `tilt_error_rad`; the two are independent. Raises `ValueError` for
    a negative `n` or error, a tilt error of a quarter turn or more, and anything that is not
    finite.
    """
    if n < 0:
        raise ValueError(f"n is {n}; it must be at least 0")
    non_negative("position_error_m", position_error_m)
    if non_negative("tilt_error_rad", tilt_error_rad) >= 0.5 * np.pi:
        raise ValueError(f"tilt_error_rad is {tilt_error_rad!r}; it must be below pi/2")
    if not np.isfinite(depth_m):
        raise ValueError(f"depth_m is {depth_m!r}; it must be finite")
    poses = np.empty((n, 5))
    poses[:, :2] = position_error_m * _unit_disc(n, generator)
    poses[:, 2] = depth_m
    poses[:, 3:] = tilt_error_rad * _unit_disc(n, generator)
    return poses


def _unit_disc(n: int, generator: np.random.Generator) -> FloatArray:
    """`n` points uniform in the unit disc, shape (n, 2)."""
    radius = np.sqrt(generator.random(n))
    angle = 2.0 * np.pi * generator.random(n)
    return np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=-1)
