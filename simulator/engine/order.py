"""Order of a block's lanes: poses that touch the same circles are neighbours."""

import numpy as np

from simulator.compiled import Record, scalar
from simulator.engine.batch import Given
from simulator.engine.table import RIM_COLUMNS, SHAFT_COLUMNS, Table

_NONE, _ONE = np.uint64(0), np.uint64(1)


@scalar
def order_lanes(lane: Record, given: Given, table: Table, start: int, count: int) -> None:
    """Set `lane.at`, by counting, so that poses that have passed as many rims stand side by side.

    The rims are those of the first pose's part: others fill the vectors less well.
    """
    poses = given.poses[start : start + count]
    planes = table.columns[given.geometry[start if len(given.geometry) > 1 else 0], SHAFT_COLUMNS:]
    for i in range(count):
        lane.z[i] = poses[i, 2]
    for i in range(count):
        lane.rims_passed[i] = _NONE
    rims = len(table.rim_walls)
    for rim in range(rims):
        plane = planes[RIM_COLUMNS * rim]
        for i in range(count):
            lane.rims_passed[i] += np.uint64(lane.z[i] > plane)
    for passed in range(rims + 1):
        lane.place[passed] = _NONE
    for i in range(count):
        lane.place[lane.rims_passed[i]] += _ONE
    end = np.uint64(count)
    for passed in range(rims, -1, -1):
        end -= lane.place[passed]
        lane.place[passed] = end
    for i in range(count):
        passed = lane.rims_passed[i]
        lane.at[i] = lane.place[passed]
        lane.place[passed] += _ONE
