"""Moves by what is believed: centred, upright, and as deep as stays gentle."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from controllers.contact_pose.look_ahead import LookAheadSettings, look_ahead
from controllers.messages import Move
from simulator.checks import FloatArray
from tests.controllers.contact_pose.cases import PRIOR, contact_model

UM = 1e-6
PIVOT_M = 2.5e-4
SETTINGS = LookAheadSettings(
    step_box_m=(20e-6, 20e-6, 60e-6),
    turn_rad=math.radians(0.05),
    axial_steps_m=(60e-6, 25e-6, 9e-6, 2.5e-6),
    force_budget_N=8e-3,
    quantile=0.9,
    samples=128,
)
FREE_TURNS = replace(SETTINGS, turn_rad=1.0, step_box_m=(1.0, 1.0, 60e-6))
MODEL = contact_model()


def hypothesis(
    x: float = 0.0, y: float = 0.0, rx: float = 0.0, ry: float = 0.0, clearance: float = 8 * UM
) -> FloatArray:
    return np.array([[x, y, rx, ry, 6e3, clearance, 0.2]])


def looked(hypotheses: FloatArray, pose: FloatArray, chosen: LookAheadSettings = SETTINGS) -> Move:
    mean: FloatArray = hypotheses.mean(axis=0)
    return look_ahead(MODEL, hypotheses, mean, pose, PIVOT_M, chosen)


def axis_of(tilt: FloatArray) -> FloatArray:
    """Turned about x, then about y, by matrices."""
    (cx, sx), (cy, sy) = ((math.cos(a), math.sin(a)) for a in tilt)
    about_x = np.array([[1.0, 0.0, 0.0], [0.0, cx, -sx], [0.0, sx, cx]])
    about_y = np.array([[cy, 0.0, sy], [0.0, 1.0, 0.0], [-sy, 0.0, cy]])
    axis: FloatArray = about_y @ about_x @ np.array([0.0, 0.0, 1.0])
    return axis


def crossing(place: FloatArray, tilt: FloatArray, depth_m: float) -> FloatArray:
    """Where the shaft's axis passes a depth."""
    axis = axis_of(tilt)
    at: FloatArray = (place + axis * (depth_m - place[2]) / axis[2])[:2]
    return at


TILTS = st.floats(-5e-3, 5e-3)


@settings(max_examples=30)
@given(rx=TILTS, ry=TILTS, turn=st.floats(0.0, 2e-3), depth=st.floats(3e-4, 3e-3))
def test_a_turn_leaves_the_pivot_in_place(rx: float, ry: float, turn: float, depth: float) -> None:
    """The axis passes the middle of the first wall on the hole's axis, before and after."""
    tilt = np.array([rx, ry])
    upright = axis_of(tilt)
    start = upright[:2] / upright[2] * (depth - PIVOT_M)
    before = np.array([*start, depth])
    np.testing.assert_allclose(crossing(before, tilt, PIVOT_M), 0.0, atol=1e-12)
    chosen = replace(SETTINGS, turn_rad=turn, step_box_m=(1.0, 1.0, 60e-6))
    move = looked(hypothesis(0.0, 0.0, rx, ry), np.array([*start, depth, 0.0, 0.0]), chosen)
    after = np.add(before, [*move.translation[:2], 0.0])
    turned = tilt + move.rotation[:2]
    # Third order in the tilt: 3 mm times (5 mrad)^3.
    np.testing.assert_allclose(crossing(after, turned, PIVOT_M), 0.0, atol=4e-10)


def test_it_centres_what_is_off_centre_and_turns_upright() -> None:
    found = looked(
        hypothesis(3 * UM, -2 * UM, 1e-3, -2e-3),
        np.array([1 * UM, 5 * UM, 1e-3, 5e-4, 1e-3]),
        FREE_TURNS,
    )
    assert found.rotation == pytest.approx((-1.5e-3, 1e-3, 0.0), abs=1e-15)
    assert found.translation[:2] == pytest.approx((-4 * UM, -3 * UM), abs=1e-15)


def test_above_the_pivot_the_end_itself_is_centred() -> None:
    pose = np.array([0.0, 0.0, 1e-4, 0.0, 0.0])
    found = looked(hypothesis(3 * UM, 0.0, 0.0, 4e-3), pose)
    assert found.translation[:2] == pytest.approx((-3 * UM, 0.0), abs=1e-15)


def test_no_turn_is_left_out_where_the_stage_cannot_turn() -> None:
    """The tilt stays, and the end is put beside the pivot by its lever."""
    pose = np.array([0.0, 0.0, 1.25e-3, 0.0, 0.0])
    found = looked(hypothesis(0.0, 0.0, 2e-3, 1e-3), pose, replace(SETTINGS, turn_rad=0.0))
    assert found.rotation == (0.0, 0.0, 0.0)
    assert found.translation[:2] == pytest.approx((1 * UM, -2 * UM), abs=1e-12)


@settings(max_examples=30)
@given(
    seed=st.integers(0, 10_000),
    x=st.floats(-1e-3, 1e-3),
    y=st.floats(-1e-3, 1e-3),
    depth=st.floats(-1e-4, 3.5e-3),
    rx=st.floats(-0.1, 0.1),
    ry=st.floats(-0.1, 0.1),
)
def test_never_outside_of_the_step_box(
    seed: int, x: float, y: float, depth: float, rx: float, ry: float
) -> None:
    drawn = PRIOR.drawn(16, np.random.default_rng(seed))
    (dx, dy, dz), turn, _ = looked(drawn, np.array([x, y, depth, rx, ry]))
    assert max(abs(dx), abs(dy)) <= 20e-6
    assert dz in (60e-6, 25e-6, 9e-6, 2.5e-6)
    assert max(abs(turn[0]), abs(turn[1])) <= math.radians(0.05) + 1e-18
    assert turn[2] == 0.0


def test_the_longest_step_in_free_air() -> None:
    for depth in (-5e-4, 8e-4):
        pose = np.array([0.0, 0.0, depth, 0.0, 0.0])
        assert looked(hypothesis(), pose).translation[2] == 60e-6


AT_THE_EDGE = np.array([0.0, 0.0, -2e-6, 0.0, 0.0])
SHORT_STEPS_M = (9e-6, 6e-6, 4e-6, 2.5e-6)


def forces_at_the_edge() -> tuple[FloatArray, list[float]]:
    """A hypothesis 8 um deep in the first rim, and its radial force after each short step."""
    off = hypothesis(9 * UM, clearance=2 * UM)
    forces = []
    for axial in SHORT_STEPS_M:
        step = np.array([[0.0, 0.0, axial]])
        pose = AT_THE_EDGE[np.newaxis] + [0.0, 0.0, axial, 0.0, 0.0]
        wrench = MODEL.contacts(off, pose, step).wrench[0]
        forces.append(float(np.hypot(wrench[0], wrench[1])))
    assert forces == sorted(forces, reverse=True)
    assert forces[-1] > 1e-3
    return off, forces


def stepped(budget_N: float) -> float:
    """How deep it goes with this budget where the mean is in the middle, the hypothesis not."""
    off, _ = forces_at_the_edge()
    chosen = replace(SETTINGS, force_budget_N=budget_N, axial_steps_m=SHORT_STEPS_M)
    return look_ahead(MODEL, off, hypothesis()[0], AT_THE_EDGE, PIVOT_M, chosen).translation[2]


def test_the_shortest_step_where_all_exceed_the_budget() -> None:
    assert stepped(0.0) == 2.5e-6
    assert stepped(forces_at_the_edge()[1][-1] * 0.999) == 2.5e-6


@pytest.mark.parametrize("number", range(4))
def test_a_step_as_long_as_the_budget_allows(number: int) -> None:
    force = forces_at_the_edge()[1][number]
    assert stepped(force * (1.0 + 1e-9)) == SHORT_STEPS_M[number]
    assert stepped(force * (1.0 - 1e-9)) == SHORT_STEPS_M[min(number + 1, 3)]


def test_a_longer_step_where_a_shorter_one_is_worse() -> None:
    """Tilted in both holes, the force falls with the depth: nothing is won by going slowly."""
    tilted = hypothesis(0.0, 0.0, 0.0, 6e-3, 4 * UM)
    pose = np.array([0.0, 0.0, 2.7e-3, 0.0, 0.0])
    chosen = replace(SETTINGS, turn_rad=0.0, force_budget_N=0.0)
    assert looked(tilted, pose, chosen).translation[2] == 60e-6


@pytest.mark.parametrize(("bad", "goes"), [(10, 60e-6), (30, 2.5e-6)])
def test_a_share_of_the_hypotheses_must_agree(bad: int, goes: float) -> None:
    """Of 200 hypotheses, 5 % or 15 % meet a wall at once; a tenth may."""
    drawn = np.repeat(hypothesis(clearance=12 * UM), 200, axis=0)
    drawn[:bad, 0] = 8 * UM
    mean = hypothesis(clearance=12 * UM)[0]
    pose = np.array([0.0, 0.0, 2e-4, 0.0, 0.0])
    chosen = replace(SETTINGS, force_budget_N=1e-6, axial_steps_m=(60e-6, 2.5e-6))
    near = look_ahead(MODEL, drawn, mean, pose - [0, 0, 2.3e-4, 0, 0], PIVOT_M, chosen)
    assert near.translation[2] == goes


@pytest.mark.parametrize("depth", [-1e-5, 4e-4, 2.45e-3, 2.7e-3])
def test_a_quarter_turn_of_all_turns_the_move(depth: float) -> None:
    """Small tilts turn as vectors to first order; exactly so for a quarter turn of one axis."""
    pose = np.array([2 * UM, 1 * UM, depth, 0.0, 0.0])
    drawn = PRIOR.drawn(32, np.random.default_rng(6))
    drawn[:, 3] = 0.0

    def quarter(pairs: FloatArray) -> FloatArray:
        turned: FloatArray = np.stack([-pairs[..., 1], pairs[..., 0]], axis=-1)
        return turned

    turned, turned_pose = drawn.copy(), pose.copy()
    turned[:, :2], turned[:, 2:4] = quarter(drawn[:, :2]), quarter(drawn[:, 2:4])
    turned_pose[:2] = quarter(pose[:2])
    one, other = looked(drawn, pose), looked(turned, turned_pose)
    assert other.translation[:2] == pytest.approx(quarter(np.array(one.translation[:2])), abs=1e-15)
    assert other.rotation[:2] == pytest.approx(quarter(np.array(one.rotation[:2])), abs=1e-15)
    assert other.translation[2] == one.translation[2]


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"step_box_m": (-1e-6, 0.0, 6e-5)}, r"LookAheadSettings.step_box_m is -1e-06"),
        ({"turn_rad": math.nan}, r"LookAheadSettings.turn_rad is nan"),
        ({"force_budget_N": -1.0}, r"LookAheadSettings.force_budget_N is -1.0"),
        ({"axial_steps_m": ()}, r"axial_steps_m is \(\); .* the longest first"),
        ({"axial_steps_m": (1e-6, 2e-6)}, r"axial_steps_m is .* the longest first"),
        ({"axial_steps_m": (2e-6, 2e-6)}, r"axial_steps_m is .* the longest first"),
        ({"axial_steps_m": (2e-6, -61e-6)}, r"axial_steps_m is .* in the step box, 6e-05"),
        ({"axial_steps_m": (61e-6, 2e-6)}, r"axial_steps_m is .* in the step box, 6e-05"),
        ({"axial_steps_m": (math.nan,)}, r"axial_steps_m is .* in the step box"),
        ({"quantile": -0.1}, r"LookAheadSettings.quantile is -0.1; it must be from 0 to 1"),
        ({"quantile": 1.1}, r"LookAheadSettings.quantile is 1.1; it must be from 0 to 1"),
        ({"samples": 0}, r"LookAheadSettings.samples is 0; it must be at least 1"),
    ],
)
def test_settings_that_cannot_be_are_refused(change: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        replace(SETTINGS, **change)
