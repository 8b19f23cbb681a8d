"""The extremum on a circle: the equation for t = e2/e1, and how fast Newton's method finds it."""

import numpy as np
import numpy.typing as npt
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from figures_of.paint import FAINT_COLOUR, SHAFT_LINE, note
from learning.drawing import drawing, svg
from simulator.extremum import NEWTON_STEPS

FloatArray = npt.NDArray[np.float64]

TWO_PEAKS = (0.10, 0.45, 1.0)
"""a, c and b, of a problem with a second peak."""
SLOW = (0.02, 0.98, 1.0)
"""The same of one whose peaks have nearly merged, where Newton's method has most to do."""
DECADES = np.linspace(-12.0, 12.0, 193)
"""Powers of ten of a/b and c/b over which the error is taken."""
MORE_STEPS = 12
BEST_COLOUR = "#A00000"
NEWTON_COLOUR = "#B36B00"


def start(a: FloatArray, c: FloatArray, b: FloatArray) -> FloatArray:
    """The vector e, shape (2, ...), from which the code starts."""
    e2 = c / (np.maximum(b, c) + a + np.cbrt(a * a * b))
    return np.stack([np.sqrt(1.0 - e2 * e2), e2])


def step(e: FloatArray, a: FloatArray, c: FloatArray, b: FloatArray) -> FloatArray:
    """One step of Newton's method for t = e2/e1, written for e."""
    longer = np.stack([a + b * e[0] ** 3, c - b * e[1] ** 3])
    length: FloatArray = np.hypot(*longer)
    return longer / length


def worst_misses() -> tuple[FloatArray, FloatArray]:
    """Largest angle [rad] and largest loss of G, relative to |G|, after 0, 1, 2, ... steps.

    Over all ratios of DECADES, in extended precision; the reference is MORE_STEPS further.
    """
    grid = np.power(np.longdouble(10.0), DECADES.astype(np.longdouble))
    a, c = (values.ravel() for values in np.meshgrid(grid, grid))
    b = np.ones_like(a)
    path = [start(a, c, b)]
    for _ in range(NEWTON_STEPS + MORE_STEPS):
        path.append(step(path[-1], a, c, b))
    best = path[-1]
    angles, losses = [], []
    for e in path[: NEWTON_STEPS + 2]:
        off = np.abs(e[0] * best[1] - e[1] * best[0])
        value, highest = (2.0 * (a * v[0] + c * v[1]) + b * v[0] ** 2 for v in (e, best))
        angles.append(float(off.max()))
        losses.append(float((np.abs(highest - value) / highest).max()))
    return np.array(angles), np.array(losses)


def draw() -> str:
    """Draw G around the circle, the equation with Newton's steps, and the errors by step."""
    with drawing():
        figure = Figure(figsize=(11.0, 3.9))
        circle, equation, errors = figure.subplots(
            1,
            3,
            gridspec_kw={
                "left": 0.06,
                "right": 0.985,
                "bottom": 0.135,
                "top": 0.90,
                "wspace": 0.32,
            },
        )
        _draw_circle(circle)
        _draw_equation(equation)
        _draw_errors(errors)
        return svg(figure, "extremum", "Newton's method for the extremum on a circle")


def _newton_path(example: tuple[float, float, float]) -> FloatArray:
    """Values of t in an example: the start, then after each Newton step."""
    problem = tuple(np.array(value) for value in example)
    path = [start(*problem)]
    for _ in range(NEWTON_STEPS):
        path.append(step(path[-1], *problem))
    return np.array([e[1] / e[0] for e in path])


def _draw_circle(axes: Axes) -> None:
    a, c, b = TWO_PEAKS
    best_deg = float(np.degrees(np.arctan(_newton_path(TWO_PEAKS)[-1])))
    angle = np.linspace(-90.0, 270.0, 361)
    e1, e2 = np.cos(np.radians(angle)), np.sin(np.radians(angle))
    axes.axvspan(0.0, 90.0, color="#F0F0F0", linewidth=0)
    value = 2.0 * (a * e1 + c * e2) + b * e1**2
    axes.plot(angle, value, color=SHAFT_LINE)
    axes.plot(best_deg, value.max(), "o", color=BEST_COLOUR, zorder=5)
    note(axes, (best_deg, value.max() + 0.17), "e*", BEST_COLOUR, weight="bold")
    note(axes, (45.0, -1.55), "quadrant\nof m", FAINT_COLOUR)
    axes.set_title("G = 2 m·e + b e₁²: one or two peaks")
    axes.set_xlabel("direction of e [deg]")
    axes.set_ylabel("G, in units of b")
    axes.set_xticks(np.arange(-90.0, 271.0, 90.0))
    axes.set_xlim(-90.0, 270.0)
    axes.set_ylim(-1.9, 2.4)


def _draw_equation(axes: Axes) -> None:
    a, c, b = SLOW
    path = _newton_path(SLOW)

    def balance(t: FloatArray) -> FloatArray:
        return a * t + b * t / np.sqrt(1.0 + t * t) - c

    t = np.linspace(1.6, 3.0, 100)
    axes.axhline(0.0, color="#BBBBBB", linewidth=0.7)
    axes.plot(t, balance(t), color=SHAFT_LINE)
    heights = balance(path)
    for index in range(2):
        now, then = path[index], path[index + 1]
        axes.plot([now, then], [heights[index], 0.0], color=NEWTON_COLOUR, linewidth=1.1)
        axes.plot([then, then], [0.0, heights[index + 1]], color=NEWTON_COLOUR, dashes=(2, 2))
    axes.plot(path[:3], heights[:3], "o", color=NEWTON_COLOUR, markersize=4.5, zorder=5)
    axes.plot([path[0]] * 2, [0.0, heights[0]], color=NEWTON_COLOUR, dashes=(2, 2))
    note(axes, (path[0], 0.007), "start", NEWTON_COLOUR)
    axes.plot(path[-1], 0.0, "o", color=BEST_COLOUR, zorder=6)
    note(axes, (path[-1] + 0.03, 0.007), "root", BEST_COLOUR)
    axes.set_title("Φ(t) rises and is concave")
    axes.set_xlabel("t = e₂/e₁")
    axes.set_ylabel("Φ = a t + b t/√(1 + t²) - c")
    axes.set_xlim(1.8, 2.8)
    axes.set_ylim(-0.080, 0.035)


def _draw_errors(axes: Axes) -> None:
    angles, losses = worst_misses()
    steps = np.arange(len(angles))
    axes.axvline(NEWTON_STEPS, color=FAINT_COLOUR, linewidth=0.8, dashes=(4, 3))
    axes.plot(steps, angles, "o-", color=NEWTON_COLOUR, markersize=4.5)
    axes.plot(steps, losses, "s-", color=SHAFT_LINE, markersize=4.5)
    note(axes, (2.15, 0.6), "angle to e* [rad]", NEWTON_COLOUR, "left")
    note(axes, (0.15, 1e-8), "G lost,\nrelative", SHAFT_LINE, "left")
    note(axes, (5.1, 1e-4), "code", FAINT_COLOUR, "left")
    axes.axhspan(1e-20, 2.2e-16, color="#F0F0F0", linewidth=0, zorder=0)
    note(axes, (0.15, 5e-18), "below rounding\nof a double", FAINT_COLOUR, "left")
    axes.set_yscale("log")
    axes.set_yticks(10.0 ** np.arange(-18, 1, 3), [f"1e{power}" for power in range(-18, 1, 3)])
    axes.minorticks_off()
    axes.set_title("Largest error of all a : b : c")
    axes.set_xlabel("Newton steps")
    axes.set_xlim(-0.2, 6.2)
    axes.set_ylim(3e-20, 5.0)
