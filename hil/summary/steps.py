"""Every proposal with its answer and with what the supervisor said until the next one."""

import math
from bisect import bisect_right
from dataclasses import dataclass

from controllers.messages import Sent, Severity, Verdict
from hil.log_reader import Log


@dataclass(frozen=True, slots=True)
class StepRecord:
    """A proposal and what became of it."""

    sent: Sent
    """The gate's answer."""
    depth_m: float
    """Where the stage was when it was proposed; NaN where the log does not say."""
    watched: tuple[Verdict, ...]
    """What the supervisor said from tick to tick until the next answer, at each change."""

    def hardest(self, until_ns: int) -> Severity:
        """Return the severity of the hardest verdict on the step up to a time."""
        watched = (v.severity for v in self.watched if v.stamp_ns <= until_ns)
        return max(self.sent.verdict.severity, *watched, Severity.PASS)

    @property
    def lowest_cap_m_s(self) -> float:
        """Return the lowest speed that the step was slowed to, as far as it is on record."""
        caps_m_s = (verdict.speed_cap_m_s for verdict in self.watched)
        return min(self.sent.verdict.speed_cap_m_s, *caps_m_s, math.inf)


def step_records(log: Log) -> tuple[StepRecord, ...]:
    """Return the answered proposals of a run in order."""
    depths_m = {
        proposal.number: observation.depth_m
        for proposal, observation in zip(log.proposals, log.observations, strict=False)
    }
    stamps_ns = [sent.stamp_ns for sent in log.sent]
    watched: list[list[Verdict]] = [[] for _ in log.sent]
    for verdict in log.verdicts:
        index = bisect_right(stamps_ns, verdict.stamp_ns) - 1
        if index >= 0:
            watched[index].append(verdict)
    return tuple(
        StepRecord(sent, depths_m.get(sent.number, math.nan), tuple(verdicts))
        for sent, verdicts in zip(log.sent, watched, strict=True)
    )
