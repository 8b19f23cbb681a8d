"""Forces of a whole run: how often each magnitude occurs, and how large they are at each depth."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes

from hil.figures.style import legend, shade_walls, sheet
from hil.log_reader import Log, Rows
from hil.summary import GENTLE_BAND_N, Forces, RunFacts
from learning.drawing import AXIS_COLOURS, BAND_COLOUR, RADIAL_COLOUR, drawing, svg

_BIN_MN = 2.0
_BINS_MOST = 200
_DEPTH_BINS = 90
_LEAST_MM = 0.05
"""No axis of depth is shorter than this."""
_RUN_COLOURS = ("#0072B2", "#D55E00")


def histogram_figure(log: Log, forces: Forces) -> str:
    """Draw how often each force occurs in the insert phases; `forces` are those of the run."""
    force_mN = np.abs(_samples(log)[1][:, :3]) * 1e3
    radial_mN = np.hypot(force_mN[:, 0], force_mN[:, 1])
    band_mN = GENTLE_BAND_N * 1e3
    top_mN = max(float(radial_mN.max()), float(force_mN.max()), band_mN + 2 * _BIN_MN)
    bin_mN = _BIN_MN * np.ceil(top_mN / (_BIN_MN * _BINS_MOST))
    edges = np.arange(0.0, top_mN + bin_mN, bin_mN)
    with drawing():
        figure, [[left, right]] = sheet(3.4, 0.3, (1,), columns=2)
        left.axvspan(0.0, band_mN, color=BAND_COLOUR, zorder=0, linewidth=0)
        _draw_shares(left, radial_mN, edges, RADIAL_COLOUR, "radial", filled=True)
        left.set_title("Radial force")
        left.text(
            0.98,
            0.95,
            f"{forces.gentle_share * 100:.2f} % within 0 to {band_mN:.0f} mN (shaded)\n"
            f"median {forces.radial.median_N * 1e3:.1f} mN\n"
            f"95 % below {forces.radial.p95_N * 1e3:.1f} mN\n"
            f"peak {forces.radial.peak_N * 1e3:.1f} mN",
            transform=left.transAxes,
            ha="right",
            va="top",
            linespacing=1.5,
            bbox={"facecolor": "white", "edgecolor": "none", "alpha": 0.85},
        )
        for axis, name in enumerate("xyz"):
            _draw_shares(right, force_mN[:, axis], edges, AXIS_COLOURS[axis], f"|f_{name}|")
        right.set_title("Each axis")
        right.legend(loc="upper right")
        left.set_ylim(50.0 / forces.samples, 150.0)
        left.set_yscale("log")
        for axes in (left, right):
            axes.set_xlim(0.0, float(edges[-1]))
            axes.set_xlabel("force (mN)")
        left.set_ylabel(f"share of samples per {bin_mN:g} mN (%)")
        left.yaxis.set_major_formatter("{x:g}")
        return svg(figure, "histogram", "How often each force occurs")


def envelope_figure(runs: Sequence[tuple[str, Log]], facts: RunFacts) -> str:
    """Draw radial and axial force over depth: median, 5 to 95 % and largest of the samples.

    One run, or two to compare. Empty where no sample has a depth.
    """
    samples = [_placed(*_samples(log)) for _, log in runs]
    if not all(depth_m.size for depth_m, _ in samples):
        return ""
    edges_mm = np.linspace(
        0.0, max(_LEAST_MM, *(float(d.max()) * 1e3 for d, _ in samples)), _DEPTH_BINS + 1
    )
    with drawing():
        figure, [[upper], [lower]] = sheet(4.6, 0.5, (1, 1))
        upper.set_xlim(edges_mm[0], edges_mm[-1])
        for (name, _), (depth_m, wrench), colour in zip(runs, samples, _RUN_COLOURS, strict=False):
            radial_mN = np.hypot(wrench[:, 0], wrench[:, 1]) * 1e3
            _draw_band(upper, depth_m * 1e3, radial_mN, edges_mm, colour, name)
            _draw_band(lower, depth_m * 1e3, wrench[:, 2] * 1e3, edges_mm, colour, name)
        shade_walls(upper, facts.walls_m, named=True)
        shade_walls(lower, facts.walls_m)
        upper.set_ylim(bottom=0.0)
        lower.axhline(0.0, color="#BBBBBB", linewidth=0.7, zorder=1)
        upper.set_ylabel("radial force (mN)")
        lower.set_ylabel("f_z (mN)")
        lower.set_xlabel("depth (mm)")
        handles, labels = upper.get_legend_handles_labels()
        legend(upper, handles, labels)
        return svg(figure, "envelope", "Range of the force over depth")


def _samples(log: Log) -> tuple[Rows, Rows]:
    """Return depth [m] and wrench [N, N*m] of the samples of all insert phases with a force."""
    traces = [log.trace(number) for number in log.insertions]
    depth_m = np.concatenate([trace.depth_m for trace in traces])
    wrench = np.concatenate([trace.wrench for trace in traces])
    usable = np.isfinite(wrench[:, :3]).all(axis=1)
    return depth_m[usable], wrench[usable]


def _placed(depth_m: Rows, wrench: Rows) -> tuple[Rows, Rows]:
    """Return the samples in the part."""
    inside = depth_m >= 0.0
    return depth_m[inside], wrench[inside]


def _draw_shares(
    axes: Axes, force_mN: Rows, edges: Rows, colour: str, label: str, filled: bool = False
) -> None:
    axes.hist(
        force_mN,
        bins=edges.tolist(),
        weights=np.full(force_mN.shape, 100.0 / force_mN.size),
        histtype="stepfilled" if filled else "step",
        color=colour,
        linewidth=1.4,
        label=label,
    )


def _draw_band(
    axes: Axes, depth_mm: Rows, force_mN: Rows, edges_mm: Rows, colour: str, name: str
) -> None:
    bin_of = np.clip(np.searchsorted(edges_mm, depth_mm, side="right") - 1, 0, _DEPTH_BINS - 1)
    quantiles = np.full((_DEPTH_BINS, 4), np.nan)
    for index in np.unique(bin_of):
        quantiles[index] = np.percentile(force_mN[bin_of == index], (5, 50, 95, 100))
    centres = 0.5 * (edges_mm[:-1] + edges_mm[1:])
    low, median, high, largest = quantiles.T
    prefix = f"{name}: " if name else ""
    axes.fill_between(
        centres, low, high, color=colour, alpha=0.28, linewidth=0, label=f"{prefix}5 to 95 %"
    )
    axes.plot(centres, median, color=colour, linewidth=1.6, label=f"{prefix}median")
    axes.plot(
        centres, largest, color=colour, linewidth=0.8, linestyle=":", label=f"{prefix}largest"
    )
