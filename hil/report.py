"""The report of a run: one HTML page that needs nothing but a browser, made from the log alone."""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import numpy as np
import typer
from jinja2 import Template

from controllers.messages import ResetRecord, Severity
from drivers.contract.errors import LogError, TenonError
from hil import figures
from hil.log_reader import Log, read_log
from hil.summary import (
    GENTLE_BAND_N,
    InsertionSummary,
    Outcome,
    RunSummary,
    log_extent,
    summarise,
)
from hil.summary.words import MEANINGS, SEVERITIES, early_end, tally
from hil.terminal import print_error, standard_output
from learning.atomic_file import write_atomically
from learning.templates import templates

_UNUSABLE_INPUT = 2


@dataclass(frozen=True, slots=True)
class _Run:
    """A run as the page shows it."""

    name: str
    log: Log
    summary: RunSummary


@dataclass(frozen=True, slots=True)
class _RuleRow:
    rule: str
    severity: str
    answers: int
    onsets: int
    meaning: str


def write_report(log: Log, path: Path, compared_with: Log | None = None) -> None:
    """Write the report of `log` to `path`; the same log gives the same bytes.

    The forces of `compared_with` are shown beside those of `log`. Raises LogError where the file
    cannot be written, or is one of the logs.
    """
    for source in (log, compared_with):
        if source is not None and path.resolve() == source.path.resolve():
            raise LogError(f"the report {path} would overwrite the log that it is made from")
    runs = _runs(log, compared_with)
    summary = runs[0].summary
    page = _template().render(
        file=log.path.name,
        summary=summary,
        tally=tally(summary),
        early_end=early_end(summary),
        is_success=summary.count(Outcome.DONE) == len(summary.insertions) > 0,
        runs=runs,
        done=summary.count(Outcome.DONE),
        nan=math.nan,
        rules=list(_rules(summary)),
        resets=[_reset(record, log) for record in log.resets],
        band_mN=f"{GENTLE_BAND_N * 1e3:g}",
        state_colours=figures.STATE_COLOURS if log.contact_states else {},
        failure=_failure(log, summary),
        insertion=_insertion(log, summary),
        belief=_belief(log, summary),
        calibration=_calibration(log),
        histogram=figures.histogram_figure(log, summary.forces) if summary.forces else "",
        envelope=_envelope(runs),
        governor=figures.governor_figure(log, summary),
        timing=figures.timing_figure(log),
    )
    try:
        write_atomically(path.resolve(), page.encode())
    except OSError as error:
        raise LogError(f"cannot write the report {path}: {error.strerror}") from error


def _template() -> Template:
    environment = templates(Path(__file__).parent)
    environment.filters["number"] = _number
    environment.filters["word"] = SEVERITIES.__getitem__
    environment.globals["severities"] = list(Severity)
    return environment.get_template("report.html.j2")


def _number(value: float, factor: float = 1.0, digits: int = 1) -> str:
    """Return `value` in a unit `factor` times smaller; a dash where it is not known."""
    return f"{value * factor:z.{digits}f}" if math.isfinite(value) else "-"


def _runs(log: Log, compared_with: Log | None) -> list[_Run]:
    logs = [log] if compared_with is None else [log, compared_with]
    summaries = [summarise(each) for each in logs]
    names = [summary.facts.controller for summary in summaries]
    if len(set(names)) < len(names):
        names = ["this run", "the other"]
    return [_Run(*run) for run in zip(names, logs, summaries, strict=True)]


def _rules(summary: RunSummary) -> Iterator[_RuleRow]:
    verdicts = summary.verdicts
    fired = sorted(
        verdicts.rules.keys() | verdicts.onsets.keys(), key=lambda k: (-k[1], k[0].value)
    )
    for rule, severity in fired:
        yield _RuleRow(
            rule=rule.value,
            severity=SEVERITIES[severity],
            answers=verdicts.rules[rule, severity],
            onsets=verdicts.onsets[rule, severity],
            meaning=MEANINGS[rule],
        )


def _reset(record: ResetRecord, log: Log) -> str:
    time_s = (record.stamp_ns - log_extent(log)[0]) * 1e-9
    cleared = ", ".join(str(reason) for reason in record.cleared) or "nothing"
    return f"{record.operator} reset the supervisor at {time_s:.2f} s; it cleared: {cleared}."


def _failure(log: Log, summary: RunSummary) -> str:
    """Return the figure of the last insertion that was not done, if it left any samples."""
    bad = [i for i in summary.insertions if i.outcome is not Outcome.DONE]
    return figures.failure_figure(log, summary, bad[-1]) if bad else ""


def _insertion(log: Log, summary: RunSummary) -> str:
    """Return the figure of the insertions of median and of largest radial peak."""
    ranked = sorted(
        (i for i in summary.insertions if i.forces is not None and math.isfinite(i.deepest_m)),
        key=_radial_peak,
    )
    if not ranked:
        return ""
    chosen = {"median peak": ranked[(len(ranked) - 1) // 2], "largest peak": ranked[-1]}
    if len(ranked) == 1:
        del chosen["median peak"]
    titles = [
        f"Insertion {i.number}: {what}, {_radial_peak(i) * 1e3:.1f} mN"
        for what, i in chosen.items()
    ]
    return figures.insertion_figure(log, summary.facts, [i.number for i in chosen.values()], titles)


def _belief(log: Log, summary: RunSummary) -> str:
    """Return the figure of the insertion with the largest radial peak, if there were beliefs."""
    known = [i for i in summary.insertions if figures.beliefs_of(log, i.number)]
    if not known:
        return ""
    return figures.belief_figure(log, summary.facts, max(known, key=_radial_peak).number)


def _calibration(log: Log) -> str:
    """Say how often the truth was within two standard deviations; empty where it is not known."""
    errors = figures.true_pose_errors(log, list(log.beliefs))
    if not log.beliefs or np.isnan(errors).all():
        return ""
    mean, std = (np.array([getattr(b, name)[:4] for b in log.beliefs]) for name in ("mean", "std"))
    known = np.isfinite(errors)
    inside = np.abs(errors - mean)[known] <= figures.SIGMAS * std[known]
    return f"{100.0 * float(np.mean(inside)):.0f} %"


def _radial_peak(insertion: InsertionSummary) -> float:
    return insertion.forces.radial.peak_N if insertion.forces is not None else -math.inf


def _envelope(runs: list[_Run]) -> str:
    named = [(run.name if len(runs) > 1 else "", run.log) for run in runs if run.summary.forces]
    return figures.envelope_figure(named, runs[0].summary.facts) if named else ""


def report(
    log: Annotated[Path, typer.Argument(help="The log (MCAP) of a run; it may be cut off.")],
    output: Annotated[
        Path | None, typer.Option(help="The page to write. Beside the log if not given.")
    ] = None,
    compare: Annotated[
        Path | None, typer.Option(help="Another run's log, to show its forces beside these.")
    ] = None,
) -> None:
    """Write the report of a run as one HTML page.

    Exit code: 0 written, 2 unusable input.
    """
    page = output or log.with_suffix(".html")
    try:
        write_report(read_log(log), page, read_log(compare) if compare else None)
        with standard_output() as console:
            console.print(f"Report: {page}", soft_wrap=True, markup=False, highlight=False)
    except TenonError as error:
        print_error(error)
        raise typer.Exit(_UNUSABLE_INPUT) from error


if __name__ == "__main__":
    typer.run(report)
