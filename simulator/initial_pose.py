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
    for columns, radius in ((slice(0, 2), position_error_m), (slice(3, 5), tilt_error_rad)):
        poses[:, columns] = radius * unit_disc(generator.random((2, n)).T)
    poses[:, 2] = depth_m
    return poses


def unit_disc(shares: FloatArray) -> FloatArray:
    """Points in the unit disc, shape (..., 2), uniform if both `shares` (..., 2) are in [0, 1)."""
    radius, angle = np.sqrt(shares[..., 0]), 2.0 * np.pi * shares[..., 1]
    return np.stack([radius * np.cos(angle), radius * np.sin(angle)], axis=-1)
