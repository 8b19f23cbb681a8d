"""The report's figures, each a function from a log to an SVG element as text."""

from hil.figures.belief import SIGMAS, belief_figure, beliefs_of, true_pose_errors
from hil.figures.failure import failure_figure
from hil.figures.forces import envelope_figure, histogram_figure
from hil.figures.insertion import STATE_COLOURS, insertion_figure
from hil.figures.supervision import governor_figure, timing_figure

__all__ = [
    "SIGMAS",
    "STATE_COLOURS",
    "belief_figure",
    "beliefs_of",
    "envelope_figure",
    "failure_figure",
    "governor_figure",
    "histogram_figure",
    "insertion_figure",
    "timing_figure",
    "true_pose_errors",
]
