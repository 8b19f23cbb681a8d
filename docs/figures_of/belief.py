"""The belief along one insertion: what the contact-pose filter holds of pose and part."""

from pathlib import Path

import numpy as np
import numpy.typing as npt

from controllers.belief_controller import BeliefController
from controllers.contact_pose import Parameter
from hil.figures.style import legend, shade_walls, sheet
from learning.drawing import AXIS_COLOURS, RADIAL_COLOUR, drawing, svg
from learning.evaluation.contenders import LookAhead
from learning.evaluation.load import load_evaluation
from learning.evaluation.plant import Plant
from learning.evaluation.trial import Trial
from learning.evaluation.trials import cases_of

FloatArray = npt.NDArray[np.float64]

COMPARISON = Path(__file__).parents[2] / "config" / "evaluation" / "extended.yaml"
NUMBER = 18
"""Of the plant; a tight fit, badly aligned."""
SHOWN = (
    (Parameter.OFFSET_X, "offset x [µm]", 1e6),
    (Parameter.TILT_Y, "tilt about y [mrad]", 1e3),
    (Parameter.CLEARANCE, "clearance [µm]", 1e6),
    (Parameter.STIFFNESS, "stiffness [mN/µm]", 1e-3),
)


def truth_of(plant: Plant) -> FloatArray:
    """What the belief should come to, (7,) by `Parameter`."""
    clearance = plant.part.holes[0].diameter_m - plant.shaft.diameter_m
    x, y, _, rx, ry = plant.misalignment
    law = plant.law
    return np.array([x, y, rx, ry, law.stiffness_N_m, clearance, law.friction])


def insertion(plant: Plant, seed: tuple[int, int]) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Depth (T,) [m], radial force (T,) [N], and mean and deviation of the belief (T, 2, 7)."""
    contender = load_evaluation(COMPARISON).entries["look_ahead"].contender
    if not isinstance(contender, LookAhead):
        raise TypeError(f"look_ahead in {COMPARISON} is a {type(contender).__name__}")
    rules = load_evaluation(COMPARISON).settings.trial.rules()
    trial = Trial(plant, rules, np.random.default_rng((*seed, 0)))
    controller = contender.controller(plant, trial, np.random.default_rng((*seed, 1)))
    if not isinstance(controller, BeliefController):
        raise TypeError(f"look_ahead made a {type(controller).__name__}")
    beliefs = []
    while not trial.is_inserted:
        observation = trial.observe()
        for _ in controller.think(observation):
            pass
        belief = controller.belief
        beliefs.append((belief.mean, belief.std))
        trial.step(controller.step(observation))
    record = trial.record()
    radial = np.hypot(record.wrenches[:, 0], record.wrenches[:, 1])
    return record.poses[:, 2], radial, np.array(beliefs)


def draw() -> str:
    """Draw belief, truth and force over depth."""
    evaluation = load_evaluation(COMPARISON)
    plant, seed = cases_of(evaluation.plants(), evaluation.settings.plants.seed)[NUMBER]
    depth, radial, beliefs = insertion(plant, seed)
    # A belief is held before the step, at the depth that the step before led to.
    held = np.concatenate([[evaluation.settings.trial.start_depth_m], depth[:-1]]) * 1e3
    truth = truth_of(plant)
    walls = list(zip(plant.part.wall_entries_m, plant.part.wall_exits_m, strict=True))
    with drawing():
        figure, panels = sheet(7.6, 0.5, [1.0] * (len(SHOWN) + 1))
        for (axes,), (parameter, label, scale) in zip(panels, SHOWN, strict=False):
            mean, std = scale * beliefs[:, 0, parameter], scale * beliefs[:, 1, parameter]
            band = axes.fill_between(
                held, mean - 2 * std, mean + 2 * std, color=AXIS_COLOURS[0], alpha=0.2, linewidth=0
            )
            (line,) = axes.plot(held, mean, color=AXIS_COLOURS[0])
            true = axes.axhline(scale * truth[parameter], color=AXIS_COLOURS[1], linewidth=1.2)
            axes.set_ylabel(label)
        (axes,) = panels[-1]
        axes.vlines(depth * 1e3, 0.0, radial * 1e3, color=RADIAL_COLOUR, linewidth=1.6)
        axes.set_ylim(bottom=0.0)
        axes.set_ylabel("radial force [mN]")
        axes.set_xlabel("depth of the leading end [mm]")
        axes.set_xlim(held[0] - 0.05, depth[-1] * 1e3 + 0.05)
        for row in panels:
            shade_walls(row[0], walls, named=row is panels[0])
        legend(panels[0][0], [line, band, true], ["mean", "two deviations", "truth"])
        return svg(figure, "belief", "Belief over offset, tilt, clearance and stiffness over depth")
