"""The deepest contact at each station of each wall, as MuJoCo and as the analytic model find it."""

from collections.abc import Iterable
from dataclasses import dataclass

import mujoco
import numpy as np

from simulator.candidates import Station, candidates
from simulator.checks import FloatArray
from tests.simulator.mujoco.cases import Case
from tests.simulator.mujoco.model import Scene, find_contacts


@dataclass(frozen=True, slots=True)
class Touches:
    """Arrays (N, 2, ...) of one pose or (P, N, 2, ...) of P poses, in M."""

    depth: FloatArray
    """[m], 0 where there is no contact."""
    normal: FloatArray
    """Unit direction in which the shaft pushes the part; 0 where there is no contact."""
    point: FloatArray
    """[m]."""


def of_mujoco(scene: Scene, poses: Iterable[FloatArray]) -> Touches:
    """MuJoCo's contacts at each of `poses`."""
    data = mujoco.MjData(scene.model)
    rows = []
    for pose in poses:
        find_contacts(scene, data, pose)
        rows.append(_deepest(scene, data))
    return Touches(
        np.array([row.depth for row in rows]),
        np.array([row.normal for row in rows]),
        np.array([row.point for row in rows]),
    )


def _deepest(scene: Scene, data: mujoco.MjData) -> Touches:
    """Sort MuJoCo's list by wall and by the half of the engaged stretch that a contact lies in."""
    shape = (len(scene.part.holes), len(Station))
    depth, normal, point = np.zeros(shape), np.zeros((*shape, 3)), np.zeros((*shape, 3))
    found = data.contact
    order = np.argsort(-found.dist)  # the deepest comes last: it is the one that stays
    wall_first = scene.wall[found.geom[order, 0]] >= 0
    wall = scene.wall[found.geom[order]].max(axis=1)
    points = found.pos[order] / scene.units_per_m
    end = data.qpos[2] / scene.units_per_m
    top = np.maximum(scene.part.wall_entries_m, end - scene.shaft.length_m)
    bottom = np.minimum(scene.part.wall_exits_m, end)
    station = (points[:, 2] > 0.5 * (top + bottom)[wall]).astype(np.int64)
    depth[wall, station] = -found.dist[order] / scene.units_per_m
    normal[wall, station] = np.where(wall_first, -1.0, 1.0)[:, np.newaxis] * found.frame[order, :3]
    point[wall, station] = points
    return Touches(depth, normal, point)


def of_simulator(case: Case, poses: FloatArray) -> Touches:
    """The deeper one of the analytic candidates of each station."""
    ours = case.solve(poses)
    shape = (len(poses), len(case.part.holes), len(Station))
    depth, normal, point = np.zeros(shape), np.zeros((*shape, 3)), np.zeros((*shape, 3))
    table = candidates(case.part, case.shaft)
    for c, at in enumerate(zip(table.hole, table.station, strict=True)):
        deeper = ours.penetration[:, c] > depth[:, *at]
        depth[deeper, *at] = ours.penetration[deeper, c]
        normal[deeper, *at] = ours.normal[deeper, c]
        point[deeper, *at] = ours.point[deeper, c]
    return Touches(depth, normal, point)
