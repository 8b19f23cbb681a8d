"""The page of a comparison: one table and the figures; it needs nothing but a browser."""

from collections.abc import Sequence
from math import isfinite
from pathlib import Path

from jinja2 import Environment

from learning.drawing import alone
from learning.evaluation.comparison import Comparison
from learning.evaluation.figures import (
    by_depth_figure,
    distribution_figure,
    insertion_figure,
    learning_curve_figure,
)
from learning.evaluation.figures.insertion import examples
from learning.evaluation.metrics import CONFIDENCE, QUANTITIES, Interval
from learning.evaluation.table import parameters_text
from learning.evaluation.training_log import TrainingLog
from learning.templates import templates

PAGE = "index.html"


def pages(comparison: Comparison, logs: Sequence[TrainingLog]) -> dict[str, str]:
    """Return the files of a comparison by name: the page, and each figure on its own."""
    settings = comparison.evaluation.settings
    shown = min(settings.figures.insertions, len(comparison.plants))
    figures = {
        "insertion": insertion_figure(comparison),
        "distribution": distribution_figure(comparison, shown),
        "by-depth": by_depth_figure(comparison, settings.figures.compared),
    }
    if logs:
        figures["learning-curve"] = learning_curve_figure(logs)
    page = (
        _environment()
        .get_template("page.html.j2")
        .render(
            file=comparison.evaluation.source.path.name,
            configuration=comparison.evaluation.source.text,
            settings=settings,
            plants=len(comparison.plants),
            results=comparison.results,
            parameters=[parameters_text(result) for result in comparison.results],
            quantities=QUANTITIES,
            confidence=f"{CONFIDENCE:.0%}",
            has_gap=any(result.gap for result in comparison.results),
            shown=shown,
            examples=examples(comparison),
            figures=figures,
            trainings=len(logs),
        )
    )
    return {PAGE: page, **{f"{name}.svg": alone(svg) for name, svg in figures.items()}}


def _environment() -> Environment:
    environment = templates(Path(__file__).parent)
    environment.filters["number"] = _number
    environment.filters["interval"] = _interval
    return environment


def _number(value: float, per_si: float = 1.0) -> str:
    """Return a value with three significant digits, no exponent; a dash where it is not known."""
    shown = value * per_si
    if not isfinite(shown):
        return "-"
    for least, digits in ((100.0, 0), (10.0, 1), (1.0, 2)):
        if abs(shown) >= least:
            return f"{shown:.{digits}f}"
    return f"{shown:z.3f}" if shown else "0"


def _interval(interval: Interval, per_si: float = 1.0) -> str:
    return f"{_number(interval.low, per_si)} to {_number(interval.high, per_si)}"
