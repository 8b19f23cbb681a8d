"""What comes of a run, and what the process says of it when it ends."""

from dataclasses import dataclass, field
from enum import IntEnum

from controllers.messages import SkillPhase
from drivers.contract.errors import TenonError
from hil.cell import Outcome
from hil.interrupt import InterruptedRunError
from hil.terminal import OutputError


class ExitCode(IntEnum):
    """What the process says of the run; a signal's number is added to SIGNAL."""

    ALL_INSERTED = 0
    NOT_ALL_INSERTED = 1
    UNUSABLE_INPUT = 2
    FAULT = 3
    SIGNAL = 128


@dataclass
class Run:
    """What has come of a run so far."""

    asked: int
    outcomes: list[Outcome] = field(default_factory=list)
    error: TenonError | None = None

    def fail(self, error: TenonError) -> None:
        """Note why the run failed; what failed first counts, but no fault hides behind a signal."""
        is_fault = not isinstance(error, InterruptedRunError | OutputError)
        if self.error is None or (isinstance(self.error, InterruptedRunError) and is_fault):
            self.error = error

    @property
    def inserted(self) -> int:
        """Number of parts inserted."""
        return sum(outcome.phase is SkillPhase.DONE for outcome in self.outcomes)

    @property
    def exit_code(self) -> int:
        """What the process should return."""
        if isinstance(self.error, InterruptedRunError):
            return ExitCode.SIGNAL + self.error.signal_number
        if self.error is not None:
            return ExitCode.FAULT
        if self.inserted == self.asked and self.outcomes[-1].is_clear:
            return ExitCode.ALL_INSERTED
        return ExitCode.NOT_ALL_INSERTED

    @property
    def early_end(self) -> str:
        """In one sentence, why the run ended before its time; empty if it did not."""
        if isinstance(self.error, InterruptedRunError):
            return f"The run was {self.error}; the cell is held."
        if self.error is not None:
            return f"The run ended by a fault: {self.error}."
        if self.outcomes and not self.outcomes[-1].is_clear:
            last = self.outcomes[-1]
            return (
                f"The run ended with insertion {last.number}, which left the shaft in the part: "
                f"{last.reason}."
            )
        return ""
