"""What the supervisor did: speed and verdict of every step, and the timing of its loop."""

import math

import numpy as np

from hil.figures.style import SEVERITY_MARKS, draw_level, legend, shade_walls, sheet
from hil.log_reader import Log
from hil.summary import RunSummary, step_records
from hil.summary.words import SEVERITIES
from learning.drawing import LIMIT_COLOUR, drawing, svg


def governor_figure(log: Log, summary: RunSummary) -> str:
    """Draw over depth the speed of every step sent, marked by the hardest verdict on it.

    Refused proposals stand at zero speed. Empty where no insertion proposed anything.
    """
    steps = [
        (step, step.hardest(until_ns=insertion.end_ns))
        for step in step_records(log)
        for insertion in summary.insertions
        if insertion.start_ns <= step.sent.stamp_ns <= insertion.end_ns
        and math.isfinite(step.depth_m)
    ]
    if not steps:
        return ""
    slowed = [s for s, _ in steps if s.lowest_cap_m_s < s.sent.speed_m_s]
    with drawing():
        figure, [[axes]] = sheet(3.6, 0.5, (1,))
        axes.vlines(
            [step.depth_m * 1e3 for step in slowed],
            [step.lowest_cap_m_s * 1e3 for step in slowed],
            [step.sent.speed_m_s * 1e3 for step in slowed],
            color="#777777",
            linewidth=0.9,
            label="slowed on the way",
            zorder=2,
        )
        for severity, (marker, colour) in SEVERITY_MARKS.items():
            chosen = [step for step, hardest in steps if hardest is severity]
            if not chosen:
                continue
            axes.plot(
                [step.depth_m * 1e3 for step in chosen],
                [step.sent.speed_m_s * 1e3 for step in chosen],
                linestyle="none",
                marker=marker,
                markersize=4.5,
                markerfacecolor=colour,
                markeredgecolor="white",
                markeredgewidth=0.4,
                label=f"{SEVERITIES[severity]} ({len(chosen)})",
                clip_on=False,
                zorder=3,
            )
        depths_mm = [step.depth_m * 1e3 for step, _ in steps]
        axes.set_xlim(min(depths_mm) - 0.05, max(depths_mm) + 0.05)
        top_mm_s = max(step.sent.speed_m_s for step, _ in steps) * 1e3
        limits = summary.facts.limits
        if limits is not None:
            top_mm_s = max(top_mm_s, limits.speed_m_s * 1e3)
            axes.set_ylim(0.0, top_mm_s * 1.12)
            draw_level(axes, limits.speed_m_s * 1e3, f"limit {limits.speed_m_s * 1e3:g} mm/s")
        axes.set_ylim(0.0, max(top_mm_s * 1.12, 0.1))
        shade_walls(axes, summary.facts.walls_m, named=True)
        axes.set_xlabel("depth at which the step was proposed (mm)")
        axes.set_ylabel("speed sent (mm/s)")
        legend(axes, *axes.get_legend_handles_labels())
        return svg(figure, "governor", "Speed and verdict of every step over depth")


def timing_figure(log: Log) -> str:
    """Draw the loop's time from sample to verdict over the run; empty in simulated time."""
    timings = log.timings
    if not any(timing.max_s > 0.0 for timing in timings):
        return ""
    time_s = (np.array([t.stamp_ns for t in timings]) - timings[0].stamp_ns) * 1e-9
    with drawing():
        figure, [[axes]] = sheet(2.8, 0.35, (1,))
        axes.plot(time_s, [t.max_s * 1e3 for t in timings], color="#D55E00", label="longest")
        axes.plot(time_s, [t.median_s * 1e3 for t in timings], color="#0072B2", label="median")
        axes.axhline(
            timings[0].deadline_s * 1e3,
            color=LIMIT_COLOUR,
            linestyle="--",
            linewidth=1.0,
            label="deadline",
        )
        axes.set_yscale("log")
        axes.yaxis.set_major_formatter("{x:g}")
        axes.set_xlabel("time (s)")
        axes.set_ylabel("sample to verdict (ms)")
        legend(axes, *axes.get_legend_handles_labels())
        return svg(figure, "timing", "Time from sample to verdict over the run")
