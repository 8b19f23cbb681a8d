import numpy as np
import pytest

from learning.environments import PAPER, Outcome
from learning.policy.expert import Approach, Expert
from learning.task import InsertionTask, Start

UM = 1e-6
BOX = (20 * UM, 20 * UM, 60 * UM)
KEY = np.uint64(1)


def task() -> InsertionTask:
    """Residuals of 2, 4 and 30 um; gain 160 um/N, axial step 50 um."""
    return InsertionTask(PAPER, Expert(160 * UM, 50 * UM, BOX), (2 * UM, 4 * UM, 30 * UM))


def at(x_um: float, depth_um: float) -> Start:
    return Start(np.array([x_um * UM, 0.0, depth_um * UM, 0.0, 0.0]), KEY)


def test_expert_moves_against_the_force_and_forward() -> None:
    # 7 um off is 16 mN (2 um of overlap, two springs of 4 mN/um): 2.56 um back, of 2 um.
    insertion = task()
    action = insertion.expert(insertion.reset(at(7.0, 250.0)))
    assert action == pytest.approx([-1.28, 0.0, 50 / 30], rel=1e-5)


def test_an_action_is_cut_to_the_step_box() -> None:
    assert task().cut(np.array([99.0, -99.0, 99.0])) == pytest.approx([10.0, -5.0, 2.0])
    assert task().cut(np.array([9.0, -4.0, -1.0])) == pytest.approx([9.0, -4.0, -1.0])


def test_a_step_moves_by_the_action_in_its_unit() -> None:
    insertion = task()
    insertion.reset(at(0.0, 250.0))
    step = insertion.step(np.array([0.5, 0.25, 1.0], dtype=np.float32))
    assert step.state[3] * 2300 == pytest.approx(280.0, rel=1e-5)
    # R_p = 1, 30 um are half of the longest step: 1 - (1 - 0.5)/2.
    assert step.reward == pytest.approx(0.75, rel=1e-6)
    assert step.radial_force_N == 0.0
    assert (step.outcome, step.terminal, step.number) == (Outcome.RUNNING, False, 1)


def test_success_and_force_are_terminal() -> None:
    insertion = task()
    insertion.reset(at(0.0, 2290.0))
    step = insertion.step(np.array([0.0, 0.0, 2.0], dtype=np.float32))
    assert (step.outcome, step.terminal) == (Outcome.INSERTED, True)
    insertion.reset(at(4.0, 250.0))
    step = insertion.step(np.array([8.0, 0.0, 0.0], dtype=np.float32))
    assert (step.outcome, step.terminal) == (Outcome.FORCE_X, True)
    assert step.radial_force_N > 0.07


def test_steps_that_run_out_are_not() -> None:
    insertion = task()
    insertion.reset(at(0.0, 250.0))
    for _ in range(1000):
        step = insertion.step(np.zeros(3, dtype=np.float32))
    assert (step.outcome, step.terminal) == (Outcome.OUT_OF_STEPS, False)


def test_an_expert_with_an_approach_is_refused() -> None:
    expert = Expert(1.6e-4, 5e-5, (2e-5, 2e-5, 6e-5), Approach(2e-6, 1e-5))
    with pytest.raises(ValueError, match="the expert has an approach; this task has none"):
        InsertionTask(PAPER, expert, (1e-6, 1e-6, 3e-5))
