"""A run in plain words: what the rules mean, how it came out, why it ended."""

from collections.abc import Iterator, Mapping
from types import MappingProxyType

from controllers.messages import Rule, Severity
from hil.summary.values import InsertionSummary, Outcome, RunSummary, Stop

MEANINGS: Mapping[Rule, str] = MappingProxyType(
    {
        Rule.MISSING_DATA: "a device had not been heard yet",
        Rule.NON_FINITE: "a value was not a finite number",
        Rule.CLOCK: "the clock ran backwards",
        Rule.HEARTBEAT: "the control loop came too late",
        Rule.STALE_SAMPLE: "the newest force sample was too old, or ahead of the clock",
        Rule.STALE_DEVICE: "a device's newest state was too old, or ahead of the clock",
        Rule.STALE_PROPOSAL: "a proposed step was too old, or ahead of the clock",
        Rule.SENSOR_STATUS: "the force sensor reported a fault or saturation",
        Rule.FILTER_HEALTH: "the force sensor was silent or stuck",
        Rule.UNTARED: "the force zero was not known",
        Rule.FORCE: "a force on the part exceeded its limit",
        Rule.FORCE_RATE: "a force grew faster than allowed",
        Rule.IMPULSE: "a force above the gentle band lasted too long",
        Rule.GOVERNOR: "the speed was lowered so that the stage can brake before a force limit",
        Rule.SPEED: "the stage was faster than allowed",
        Rule.STEP_BOX: "a step was larger than allowed and was cut",
        Rule.WORKSPACE: "the stage left its workspace or would have left it",
        Rule.KEEP_OUT: "the arm moved or was away while the shaft was in the part",
        Rule.VACUUM: "the gripper did not hold the part",
        Rule.BUSY: "a step was proposed while the stage was still moving",
        Rule.RETREATING: "only steps out of the part were allowed",
    }
)
"""What is the case when a rule fires."""

SEVERITIES: Mapping[Severity, str] = MappingProxyType(
    {
        Severity.PASS: "passed",
        Severity.REDUCE: "reduced",
        Severity.HOLD: "held",
        Severity.RETREAT: "retreat",
        Severity.STOP: "stop",
    }
)


def tally(summary: RunSummary) -> str:
    """Return how many insertions succeeded, with the interval of the rate."""
    tried = len(summary.insertions)
    if not tried:
        return "No insertion was begun"
    low, high = summary.success_interval
    done = summary.count(Outcome.DONE)
    return (
        f"{done} of {tried} inserted ({done / tried:.1%}; "
        f"95 % interval {low * 100:.1f} to {high * 100:.1f} %)"
    ).replace("%;", " %;")


def insertion_note(insertion: InsertionSummary) -> str:
    """Return why an insertion failed or that it is not finished; empty for a success."""
    if insertion.outcome is Outcome.DONE:
        return ""
    return f"Insertion {insertion.number}: {insertion.outcome}" + (
        f", {insertion.reason}" if insertion.reason else ""
    )


def early_end(summary: RunSummary) -> tuple[str, ...]:
    """Return in sentences why the run ended before all that was asked; empty if it did not."""
    return tuple(_early_end(summary))


def _early_end(summary: RunSummary) -> Iterator[str]:
    for stop in summary.stops:
        yield _stopped(summary, stop)
    if not summary.complete:
        yield f"The log is not whole: {summary.ending}. What came after is not known."
    if summary.facts.early_end:
        yield summary.facts.early_end
    is_explained = bool(summary.stops or summary.facts.early_end) or not summary.complete
    last = summary.insertions[-1] if summary.insertions else None
    if last is not None and not is_explained and last.outcome is Outcome.NOT_FINISHED:
        yield f"The run ended in the middle of insertion {last.number}."
    asked, begun = summary.facts.asked, len(summary.insertions)
    if asked is None or begun >= asked:
        return
    if last is not None and not is_explained and last.outcome is Outcome.FAILED:
        yield f"The run ended with insertion {last.number}, which failed: {last.reason}."
    elif not is_explained and (last is None or last.outcome is Outcome.DONE):
        yield "The log does not say why the run ended."
    yield f"{begun} of the {asked} insertions asked for were begun."


def _stopped(summary: RunSummary, stop: Stop) -> str:
    where = next(
        (
            f"{(stop.stamp_ns - i.start_ns) * 1e-9:.2f} s into insertion {i.number}"
            for i in summary.insertions
            if i.start_ns <= stop.stamp_ns <= i.end_ns
        ),
        "outside of an insertion",
    )
    meaning = MEANINGS[stop.reason.rule]
    return f"The safety supervisor stopped the cell {where}: {meaning} ({stop.reason.detail})."
