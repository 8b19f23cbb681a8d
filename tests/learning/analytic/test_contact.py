"""Wrenches after steps and their slopes, against the plain contact model, pose by pose."""

from dataclasses import replace
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
import torch

from learning.analytic.contact import cut, wrench_after
from learning.analytic.plant_batch import PlantBatch, drawn_batch
from learning.randomisation import load_randomisation
from simulator.checks import FloatArray
from simulator.contact import ContactLaw, solve
from simulator.geometry import Hole, Part, Shaft
from tests.hil.config.cell_files import ROOT

UM, DEG = 1e-6, np.pi / 180
PART, SHAFT = Part((Hole(1.01e-3, 5e-4), Hole(1.01e-3, 5e-4, 1.5e-3))), Shaft(1e-3, 4e-3)
LAW = ContactLaw(4e3, 0.2)
STEP = (1.0 * UM, -2.0 * UM, 40.0 * UM, 0.02 * DEG, -0.01 * DEG)
CONTACTS = {
    "one rim": (6.0 * UM, 0.5 * UM, 250 * UM, 0.0, 0.3 * DEG),
    "rim and end": (6.0 * UM, 3.0 * UM, 210 * UM, 0.0, 0.0),
    "two rims and tilt": (-2.0 * UM, 1.0 * UM, 960 * UM, 0.001, 0.8 * DEG),
    "both walls": (7.0 * UM, -3.0 * UM, 2160 * UM, 0.001, -0.2 * DEG),
}
"""Poses before the step."""
FREE = (0.0, 0.0, 960 * UM, 0.0, 0.0)
SHAPES = pytest.mark.parametrize("axes", [3, 5])


def paper_plants(n: int) -> PlantBatch:
    """n times the paper's plant: 5 um of clearance to a side."""
    nominal = load_randomisation(ROOT / "config" / "randomisation" / "nominal.yaml")
    return drawn_batch(nominal, n, 1)


def tensor(values: npt.ArrayLike, asks: bool = False) -> torch.Tensor:
    made = torch.tensor(np.atleast_2d(values), dtype=torch.float64)
    return made.requires_grad_() if asks else made


def plain(pose: FloatArray, step: FloatArray) -> FloatArray:
    """The contact model's own answer (6,) after a step."""
    return solve(PART, SHAFT, pose + np.pad(step, (0, 5 - len(step))), step[:3], LAW).wrench


def slopes(pose: FloatArray, step: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Central differences (6, 5) by the pose and (6, axes) by the step."""
    shift = np.array([1e-9, 1e-9, 1e-9, 1e-7, 1e-7])
    by_pose, by_step = np.empty((6, 5)), np.empty((6, len(step)))
    for axis, far in enumerate(shift):
        more = far * np.eye(5)[axis]
        by_pose[:, axis] = (plain(pose + more, step) - plain(pose - more, step)) / (2 * far)
        if axis < len(step):
            more = more[: len(step)]
            by_step[:, axis] = (plain(pose, step + more) - plain(pose, step - more)) / (2 * far)
    return by_pose, by_step


def gradients(pose: FloatArray, step: FloatArray) -> tuple[FloatArray, FloatArray]:
    """What autograd says of the same."""
    start, made = tensor(pose, asks=True), tensor(step, asks=True)
    wrench = wrench_after(start, made, paper_plants(1))[0]
    rows = [torch.autograd.grad(part, (start, made), retain_graph=True) for part in wrench]
    by_pose, by_step = (np.array([row[which][0].numpy() for row in rows]) for which in (0, 1))
    return by_pose, by_step


@SHAPES
@pytest.mark.parametrize("where", CONTACTS)
@pytest.mark.parametrize("asks", [False, True])
def test_the_wrench_is_that_of_the_pose_after_the_step(where: str, axes: int, asks: bool) -> None:
    pose, step = np.array(CONTACTS[where]), np.array(STEP[:axes])
    found = wrench_after(tensor(pose, asks), tensor(step, asks), paper_plants(1))
    assert found.requires_grad is asks
    assert found.detach().numpy()[0] == pytest.approx(plain(pose, step), rel=1e-6, abs=1e-9)
    assert np.abs(plain(pose, step)[:2]).max() > 3e-3


def test_one_micrometre_of_overlap_by_hand() -> None:
    """Rim and end, each 1 um deep: 8 mN, and 0.2 of it along the step."""
    pose, ahead = (6 * UM, 0.0, 210 * UM, 0.0, 0.0), (0.0, 0.0, 40 * UM)
    force = wrench_after(tensor(pose), tensor(ahead), paper_plants(1))[0, :3]
    assert force.tolist() == pytest.approx([8e-3, 0.0, 1.6e-3], abs=1e-7)
    aside = (0.0, 0.3 * UM, 0.4 * UM)
    pose = (6 * UM, -0.3 * UM, 250 * UM, 0.0, 0.0)
    force = wrench_after(tensor(pose), tensor(aside), paper_plants(1))[0, :3]
    assert force.tolist() == pytest.approx([8e-3, 1.6e-3 * 0.6, 1.6e-3 * 0.8], abs=1e-7)


@SHAPES
@pytest.mark.parametrize("where", CONTACTS)
def test_slopes_are_those_of_the_contact_model(where: str, axes: int) -> None:
    pose, step = np.array(CONTACTS[where]), np.array(STEP[:axes])
    by_pose, by_step = gradients(pose, step)
    expected_by_pose, expected_by_step = slopes(pose, step)
    expected_by_pose[:, axes:] = 0.0  # the tilt of a stage that does not turn is no variable
    for found, expected in ((by_pose, expected_by_pose), (by_step, expected_by_step)):
        # Of each column the largest entry counts: the steps of a pose differ by their units.
        for rows in (slice(0, 3), slice(3, 6)):
            scale = np.abs(expected[rows]).max(0)
            assert (np.abs(found[rows] - expected[rows]) <= 0.01 * scale + 1e-9).all()
    assert np.abs(by_pose[:2, :2]).max() > 2e3


def test_a_longer_step_also_turns_the_friction() -> None:
    """By a step along y friction of 1.6 mN turns within the wall: 1.6 mN over a step of 40 um."""
    pose, step = np.array([6 * UM, 0.0, 210 * UM, 0.0, 0.0]), np.array([0.0, 0.0, 40 * UM])
    by_pose, by_step = gradients(pose, step)
    assert by_step[1, 1] - by_pose[1, 1] == pytest.approx(1.6e-3 / (40 * UM), rel=0.01)
    assert by_step[0, 0] - by_pose[0, 0] == pytest.approx(0.0, abs=1.0)


@SHAPES
def test_free_air_has_no_slope(axes: int) -> None:
    by_pose, by_step = gradients(np.array(FREE), np.array(STEP[:axes]))
    assert not by_pose.any()
    assert not by_step.any()


def test_each_plant_has_its_own_contact() -> None:
    """Rows do not mix: also with gradients, each is as it is alone."""
    extended = load_randomisation(ROOT / "config" / "randomisation" / "extended.yaml")
    plants = drawn_batch(extended, 4, 3)
    poses = np.array([*CONTACTS.values()]) + np.array([4 * UM, 0, 0, 0, 0])
    steps = np.array(STEP) * np.array([[1.0], [0.5], [2.0], [1.5]])

    def answer(rows: list[int]) -> tuple[FloatArray, FloatArray, FloatArray]:
        pose, step = tensor(poses[rows], asks=True), tensor(steps[rows], asks=True)
        wrench = wrench_after(pose, step, plants.taken(np.array(rows)))
        weights = torch.arange(1.0, 7.0, dtype=torch.float64)
        by_pose, by_step = torch.autograd.grad((wrench @ weights).sum(), (pose, step))
        return wrench.detach().numpy(), by_pose.numpy(), by_step.numpy()

    together = answer([0, 1, 2, 3])
    assert (np.abs(together[0][:, :2]).max(1) > 1e-3).all()
    for row in range(4):
        for found, alone in zip(together, answer([row]), strict=True):
            assert found[row] == pytest.approx(alone[0], rel=1e-9, abs=1e-15)


@pytest.mark.parametrize(
    ("axes", "asks", "solved"), [(3, False, 1), (5, False, 1), (3, True, 7), (5, True, 11)]
)
def test_no_more_is_solved_than_is_asked_for(
    axes: int, asks: bool, solved: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Where no gradient is asked for, one pose of each plant."""
    rows: list[tuple[int, ...]] = []
    wrenches = PlantBatch.wrenches

    def counted(self: PlantBatch, poses: FloatArray, travel: FloatArray) -> Any:
        rows.append(poses.shape)
        return wrenches(self, poses, travel)

    monkeypatch.setattr(PlantBatch, "wrenches", counted)
    poses, steps = np.tile(CONTACTS["one rim"], (2, 1)), np.tile(STEP[:axes], (2, 1))
    wrench_after(tensor(poses), tensor(steps, asks), paper_plants(2))
    assert rows == [(solved, 2, 5)]


def test_plants_that_are_taken_stay_whole() -> None:
    plants = replace(paper_plants(3), friction=np.array([0.1, 0.2, 0.3]))
    taken = plants.taken(np.array([2, 0, 2]))
    assert len(taken) == 3
    assert taken.friction.tolist() == [0.3, 0.1, 0.3]
    for name in ("geometry", "stiffness_N_m", "misalignment", "last_mouth_m", "force_noise"):
        assert (getattr(taken, name) == getattr(plants, name)[[2, 0, 2]]).all(), name
    assert (taken.position_noise_m == plants.position_noise_m[[2, 0, 2]]).all()


@pytest.mark.parametrize(
    ("value", "within", "down", "up"),
    [
        # Gradient of a loss that falls with the value, and of one that rises with it.
        (0.5, 0.5, -3.0, 3.0),
        (1.0, 1.0, -3.0, 3.0),
        (-1.0, -1.0, -3.0, 3.0),
        (1.5, 1.0, 0.0, 3.0),
        (-1.5, -1.0, -3.0, 0.0),
    ],
)
def test_cut(value: float, within: float, down: float, up: float) -> None:
    """What is out of bounds is led back inside by descent, but not further out."""
    for slope, expected in ((-3.0, down), (3.0, up)):
        given = torch.tensor([value], dtype=torch.float64, requires_grad=True)
        answer = cut(given)
        assert answer.item() == within
        (gradient,) = torch.autograd.grad(slope * answer.sum(), given)
        assert gradient.item() == expected


def test_cut_without_gradients() -> None:
    assert cut(torch.tensor([-7.0, 0.25, 7.0])).tolist() == [-1.0, 0.25, 1.0]
