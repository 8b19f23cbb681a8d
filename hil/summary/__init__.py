"""A run in numbers, taken from its log, and as a table for the terminal."""

from hil.summary.analysis import log_extent, summarise
from hil.summary.facts import RunFacts
from hil.summary.steps import StepRecord, step_records
from hil.summary.table import render_table
from hil.summary.values import GENTLE_BAND_N, Forces, InsertionSummary, Load, Outcome, RunSummary

__all__ = [
    "GENTLE_BAND_N",
    "Forces",
    "InsertionSummary",
    "Load",
    "Outcome",
    "RunFacts",
    "RunSummary",
    "StepRecord",
    "log_extent",
    "render_table",
    "step_records",
    "summarise",
]
