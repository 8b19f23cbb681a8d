"""A bad pose marks itself alone; a bad argument is refused by name."""

from typing import Any

import numpy as np
import pytest

from simulator.contact import solve as reference
from simulator.engine.batch import Batch
from simulator.engine.solve import solve
from simulator.engine.table import tabulate
from simulator.geometry import Hole, Part, Shaft
from tests.simulator.engine.test_agreement import PLAIN, directions, insertion_poses

TABLE = tabulate([(PLAIN, Shaft(1e-3, 4e-3))])
QUARTER_TURN = 1.5707963267948966


@pytest.mark.parametrize(
    "value", [np.nan, np.inf, -np.inf, QUARTER_TURN, -QUARTER_TURN, 2.0, 1e300]
)
def test_a_bad_pose_marks_itself_alone(value: float) -> None:
    poses, sliding = insertion_poses(300, 1), directions(300, 2)
    clean = solve(TABLE, poses, sliding)
    rows = [3, 4, 130, 299]
    poses[rows, [3, 4, 3, 4]] = value
    marked = solve(TABLE, poses, sliding)
    assert np.isnan(marked.wrench[rows]).all()
    assert np.isnan(marked.penetration[rows]).all()
    assert (marked.state[rows] == -1).all()
    assert (marked.points[rows] == 0).all()
    others = np.delete(np.arange(300), rows)
    for expected, found in zip(clean.arrays(), marked.arrays(), strict=True):
        assert expected[others].tobytes() == found[others].tobytes()


@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_a_bad_place_or_direction_marks_its_pose(value: float) -> None:
    poses, sliding = insertion_poses(10, 3), directions(10, 4)
    poses[2, 0] = poses[3, 2] = sliding[5, 1] = value
    state = solve(TABLE, poses, sliding).state
    assert np.flatnonzero(state == -1).tolist() == [2, 3, 5]


def test_far_away_is_solved_as_near_by() -> None:
    far = 1e3
    poses = np.array(
        [[far, 0.0, 0.0, 0.1, 0.0], [0.0, 0.0, far, 0.0, 0.1], [0.0, far, 1e-4, 0.0, 0.0]]
    )
    found = solve(TABLE, poses, (0.0, 0.0, 1.0))
    expected = reference(PLAIN, Shaft(1e-3, 4e-3), poses, (0.0, 0.0, 1.0)).wrench
    np.testing.assert_allclose(found.wrench, expected, rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize("far", [1e101, 1e200, -1e308])
def test_a_place_whose_square_is_no_number_is_invalid(far: float) -> None:
    poses = np.zeros((3, 5))
    poses[1, :2] = far
    assert solve(TABLE, poses, (0.0, 0.0, 1.0)).state.tolist() == [0, -1, 0]


POSES = np.zeros((4, 5))
BAD: list[tuple[str, dict[str, Any]]] = [
    ("poses", {"poses": np.zeros((4, 6))}),
    ("poses", {"poses": np.zeros(5)}),
    ("sliding", {"sliding": np.zeros((3, 3))}),
    ("sliding", {"sliding": (0.0, np.nan, 1.0)}),
    ("stiffness_N_m", {"stiffness_N_m": 0.0}),
    ("stiffness_N_m", {"stiffness_N_m": np.ones(3)}),
    ("stiffness_N_m", {"stiffness_N_m": [1.0, 1.0, 1.0, np.nan]}),
    ("friction", {"friction": -0.1}),
    ("friction", {"friction": np.ones((4, 1))}),
    ("geometry", {"geometry": 1}),
    ("geometry", {"geometry": -1}),
    ("geometry", {"geometry": 0.0}),
    ("geometry", {"geometry": np.zeros(3, dtype=np.int64)}),
    ("entered", {"entered": np.zeros((4, 1), dtype=np.bool_)}),
    ("entered", {"entered": np.zeros((4, 2))}),
    ("threads", {"threads": 0}),
    ("out.wrench", {"out": Batch.empty(3)}),
]


@pytest.mark.parametrize(("name", "change"), BAD)
def test_bad_arguments_are_named(name: str, change: dict[str, Any]) -> None:
    arguments: dict[str, Any] = {"poses": POSES, "sliding": (0.0, 0.0, 1.0), **change}
    with pytest.raises(ValueError, match=f"^{name} "):
        solve(TABLE, **arguments)


def test_bad_geometries_are_refused() -> None:
    with pytest.raises(ValueError, match="geometries"):
        tabulate([])
    part = Part((Hole(1.01e-3, 1e-5), *[Hole(1.01e-3, 1e-5, 1e-5)] * 64))
    with pytest.raises(ValueError, match="65 holes"):
        tabulate([(part, Shaft(1e-3, 4e-3))])
