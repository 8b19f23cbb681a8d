"""The summary as a table for the terminal, 80 columns wide at most."""

import math
from collections.abc import Iterator

from rich import box
from rich.console import Group
from rich.table import Table
from rich.text import Text

from controllers.messages import Severity
from hil.summary.values import GENTLE_BAND_N, Forces, InsertionSummary, Outcome, RunSummary
from hil.summary.words import SEVERITIES, early_end, insertion_note, tally

_STYLES = {Outcome.DONE: "green", Outcome.FAILED: "bold red", Outcome.NOT_FINISHED: "yellow"}
_BAND = f"{GENTLE_BAND_N * 1e3:.0f} mN"
_COLUMNS = (
    "#",
    "result",
    "steps",
    "depth\num",
    "time\ns",
    "peak\n|f_x|\nmN",
    "peak\n|f_y|\nmN",
    "peak\nf_z\nmN",
    "radial\nmean\nmN",
    f"within\n{_BAND}\n%",
    "lower\nhole\nmN",
    "min\ncap\nmm/s",
)


def render_table(summary: RunSummary) -> Group:
    """Return a table of the insertions and the run, and below it the verdict in a few lines."""
    table = Table(box=box.SIMPLE, show_edge=False, padding=0, header_style="bold")
    for title in _COLUMNS:
        table.add_column(title, justify="left" if title == "result" else "right", no_wrap=True)
    for insertion in summary.insertions:
        table.add_row(*_row(insertion))
    if summary.insertions:
        table.add_section()
        table.add_row(*_total(summary), style="bold")
    return Group(table, *_lines(summary))


def _row(insertion: InsertionSummary) -> Iterator[str | Text]:
    yield str(insertion.number)
    yield Text(insertion.outcome, _STYLES[insertion.outcome])
    yield str(insertion.steps)
    yield _number(insertion.deepest_m * 1e6, 0)
    yield _number(insertion.duration_s, 2)
    yield from _forces(insertion.forces)
    yield _number(insertion.lower_hole_peak_N * 1e3, 1)
    yield _number(insertion.verdicts.lowest_cap_m_s * 1e3, 2)


def _total(summary: RunSummary) -> Iterator[str | Text]:
    yield "all"
    yield f"{summary.count(Outcome.DONE)}/{len(summary.insertions)} done"
    yield str(summary.steps_max)
    yield ""
    yield _number(summary.duration_s, 1)
    yield from _forces(summary.forces)
    yield _number(summary.lower_hole_peak_N * 1e3, 1)
    yield _number(summary.verdicts.lowest_cap_m_s * 1e3, 2)


def _forces(forces: Forces | None) -> Iterator[str]:
    if forces is None:
        yield from ("-",) * 5
        return
    for load in (forces.x, forces.y, forces.z):
        yield _number(load.peak_N * 1e3, 1)
    yield _number(forces.radial.mean_N * 1e3, 1)
    yield _number(forces.gentle_share * 100, 1)


def _number(value: float, digits: int) -> str:
    return f"{value:z.{digits}f}" if math.isfinite(value) else "-"


def _lines(summary: RunSummary) -> Iterator[Text]:
    yield Text(f"\n{tally(summary)}.", "bold")
    forces = summary.forces
    if forces is not None:
        yield Text(
            f"Radial force: median {forces.radial.median_N * 1e3:.1f} mN, "
            f"95 % below {forces.radial.p95_N * 1e3:.1f} mN, "
            f"{forces.gentle_share * 100:.1f} % within {_BAND}. "
            f"Steps: mean {summary.steps_mean:.1f}, most {summary.steps_max}."
        )
    hardest = summary.verdicts.hardest
    shown = [f"{hardest[s]} {SEVERITIES[s]}" for s in Severity if hardest[s]]
    if shown:
        fired = [f"{rule} {count}" for (rule, _), count in summary.verdicts.rules.most_common()]
        yield Text(
            f"{summary.verdicts.proposals} steps proposed, hardest verdicts: {', '.join(shown)}"
            + (f" ({', '.join(fired)})." if fired else ".")
        )
    for insertion in summary.insertions:
        if note := insertion_note(insertion):
            yield Text(f"{note}.", _STYLES[insertion.outcome])
    for sentence in early_end(summary):
        yield Text(sentence, "bold red")
