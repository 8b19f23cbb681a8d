"""The results as tables: CSV for programs, a short one for the terminal."""

import csv
import io
from collections.abc import Iterator
from math import isfinite

from rich.box import SIMPLE_HEAD
from rich.table import Table

from drivers.contract.configuration.describe import unit_of
from learning.evaluation.comparison import Comparison, Result
from learning.evaluation.metrics import QUANTITIES, Interval

_UNIT_ENDS = {"": "", "mN": "_mN", "mN s": "_mN_s", "uN m": "_uNm", "s": "_s", "%": "_percent"}


def results_csv(comparison: Comparison) -> str:
    """Return a row for each controller, a column for each number; empty where there is none."""
    return _csv([dict(_row(result)) for result in comparison.results])


def insertions_csv(comparison: Comparison) -> str:
    """Return a row for each insertion: controller, plant, and what it was measured by."""
    rows = []
    for result in comparison.results:
        for plant in range(len(comparison.plants)):
            row = {
                "controller": result.name,
                "plant": str(plant),
                "is_inserted": str(int(result.records[plant].is_inserted)),
                "is_success": str(int(result.measured.is_success[plant])),
            }
            for name, quantity in QUANTITIES.items():
                value = float(result.measured.values[name][plant]) * quantity.per_si
                row[_column(name)] = number(value, 6)
            rows.append(row)
    return _csv(rows)


def _row(result: Result) -> Iterator[tuple[str, str]]:
    yield "controller", result.name
    yield "kind", result.kind
    yield "parameters", parameters_text(result)
    yield "insertions", str(len(result.records))
    yield "successes", str(result.successes)
    yield from _interval("success_percent", result.success, 1e2)
    for name, quantity in QUANTITIES.items():
        spread, column = result.spreads[name], _column(name)
        yield from _interval(column, spread.mean, quantity.per_si)
        for end in ("p50", "p95", "largest"):
            yield f"{column}_{end}", number(getattr(spread, end) * quantity.per_si, 6)
    for name in ("radial_mean", "last_hole_p95"):
        share = None if result.gap is None else getattr(result.gap, name)
        column = f"gap_closed_{name}_percent"
        yield from _interval(column, share or Interval(*[float("nan")] * 3), 1e2)


def _column(name: str) -> str:
    return f"{name}{_UNIT_ENDS[QUANTITIES[name].unit]}"


def _interval(column: str, interval: Interval, per_si: float) -> Iterator[tuple[str, str]]:
    for end, value in zip(("", "_low", "_high"), interval, strict=True):
        yield f"{column}{end}", number(value * per_si, 6)


def _csv(rows: list[dict[str, str]]) -> str:
    stream = io.StringIO()
    writer = csv.DictWriter(stream, list(rows[0]), lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    return stream.getvalue()


def number(value: float, digits: int) -> str:
    """Return a value with so many significant digits; nothing where it is not known."""
    return f"{value:.{digits}g}" if isfinite(value) else ""


def parameters_text(result: Result) -> str:
    """Return what a controller is set to, in words."""
    return ", ".join(_in_words(name, value) for name, value in result.parameters.items())


def _in_words(name: str, value: float) -> str:
    end, unit = unit_of(name)
    stem = name.removesuffix(f"_{end}") if end else name
    return f"{stem.replace('_', ' ')} {value:.4g} {unit}".rstrip()


def terminal_table(comparison: Comparison) -> Table:
    """Return the numbers that matter most, for 80 columns."""
    table = Table(box=SIMPLE_HEAD, padding=0, pad_edge=False)
    gentle_mN = comparison.evaluation.settings.trial.gentle_N * 1e3
    longest = max(len(result.name) for result in comparison.results)
    table.add_column("controller", overflow="fold", min_width=min(longest, 16))
    for title in (
        "success",
        "Wilson\n95 %",
        "steps\nmean",
        "radial\nmean\nmN",
        "peak\np95\nmN",
        "last\nhole\np95",
        f"over\n{gentle_mN:g} mN\n%",
    ):
        table.add_column(title, justify="right", no_wrap=True)
    has_gap = any(result.gap for result in comparison.results)
    if has_gap:
        for title in ("gap\nmean\n%", "gap\nhole\n%"):
            table.add_column(title, justify="right", no_wrap=True)
    for result in comparison.results:
        spreads, success = result.spreads, result.success
        row = [
            result.name,
            f"{result.successes}/{len(result.records)}",
            f"{success.low * 1e2:.3g}-{success.high * 1e2:.3g}",
            f"{spreads['steps'].mean.value:.1f}",
            f"{spreads['radial_mean'].mean.value * 1e3:.2f}",
            f"{spreads['radial_peak'].p95 * 1e3:.1f}",
            f"{spreads['last_hole_peak'].p95 * 1e3:.1f}",
            f"{spreads['hard_share'].mean.value * 1e2:.1f}",
        ]
        if has_gap:
            row += _gap_texts(result)
        table.add_row(*row)
    return table


def _gap_texts(result: Result) -> tuple[str, str]:
    gap = result.gap
    if gap is None:
        return "", ""
    return f"{gap.radial_mean.value * 1e2:.0f}", f"{gap.last_hole_p95.value * 1e2:.0f}"
