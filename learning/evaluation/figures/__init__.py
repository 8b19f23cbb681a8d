"""Figures of a comparison, each an SVG element."""

from learning.evaluation.figures.by_depth import by_depth_figure
from learning.evaluation.figures.distribution import distribution_figure
from learning.evaluation.figures.insertion import insertion_figure
from learning.evaluation.figures.learning_curve import learning_curve_figure

__all__ = [
    "by_depth_figure",
    "distribution_figure",
    "insertion_figure",
    "learning_curve_figure",
]
