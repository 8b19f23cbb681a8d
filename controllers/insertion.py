"""The insertion skill: approach, insert, retract; done or failed with the reason.

A state machine without devices: it is shown what happened and says which step it wants next.
"""

from abc import ABC, abstractmethod
from collections.abc import Iterator

from controllers.messages import (
    ContactBelief,
    Move,
    Observation,
    Reason,
    Severity,
    SkillPhase,
    Verdict,
)
from controllers.settings import InsertionSettings, SkillSettings
from drivers.contract.messages import Vector3

REACHED_M = 1e-8
"""A depth this close to a target counts as reached."""

HOVER_M = 20e-6
"""The approach ends so far above the rim: the end face of a tilted shaft dips below its centre."""


class Controller(ABC):
    """Answers observations with moves of the stage; one object leads one insertion."""

    def think(self, observation: Observation) -> Iterator[None]:
        """Work on an observation in pieces, so that the control loop can turn in between."""
        return iter(())

    def believed(self, observation: Observation) -> ContactBelief | None:
        """What is believed of pose and part as `observation` is answered, if anything is."""
        return None

    @abstractmethod
    def step(self, observation: Observation) -> Move:
        """Return the move to propose, once the observation has been thought over."""


class InsertionSkill:
    """Leads one insertion from the start depth to the end of the stroke.

    After a failure with the part still held it leads the shaft back out, as far as the supervisor
    lets it.
    """

    def __init__(
        self,
        skill: SkillSettings,
        insertion: InsertionSettings,
        controller: Controller,
        step_box_m: Vector3,
    ) -> None:
        self._skill = skill
        self._insertion = insertion
        self._controller = controller
        self._longest_m = step_box_m[2]
        self._held_since_ns: int | None = None
        self.phase = SkillPhase.APPROACH
        self.reason = ""
        self.steps = 0
        """Steps sent in the insert phase."""

    def think(self, observation: Observation) -> Iterator[None]:
        """Let the controller work on an observation, in pieces; only it has to think."""
        self._enter_next_phase(observation)
        if self.phase is SkillPhase.INSERT:
            yield from self._controller.think(observation)

    def believed(self, observation: Observation) -> ContactBelief | None:
        """What the controller believes as it answers `observation`."""
        if self.phase is SkillPhase.INSERT:
            return self._controller.believed(observation)
        return None

    def next_step(self, observation: Observation) -> Move | None:
        """Return the move to propose; None once the insertion is over.

        The controller's ends at the stroke; its rotation stays as it is.
        """
        self._enter_next_phase(observation)
        depth = observation.depth_m
        if self.phase is SkillPhase.APPROACH:
            return Move((0.0, 0.0, min(self._longest_m, -HOVER_M - depth)))
        if self.phase is SkillPhase.INSERT:
            wanted = self._controller.step(observation)
            dx, dy, dz = wanted.translation
            dz = min(dz, self._insertion.stroke_m - depth)
            return wanted._replace(translation=(dx, dy, dz))
        if self.phase is SkillPhase.RETRACT:
            return Move((0.0, 0.0, -min(self._longest_m, depth - self._skill.start_depth_m)))
        return None

    def heed(self, verdict: Verdict, was_sent: bool) -> None:
        """Take note of the hardest verdict since the last proposal, and whether that was sent."""
        if was_sent and self.phase is SkillPhase.INSERT:
            self.steps += 1
        severity = verdict.severity
        if severity is Severity.STOP:
            self._enter(SkillPhase.FAILED, _hardest(verdict.reasons))
            return
        if severity is Severity.RETREAT:
            self._give_up(_hardest(verdict.reasons))
        if severity >= Severity.HOLD and not was_sent:
            since_ns = self._held_since_ns
            if since_ns is None:
                self._held_since_ns = verdict.stamp_ns
            elif (verdict.stamp_ns - since_ns) * 1e-9 > self._skill.hold_timeout_s:
                reason = f"held too long: {_hardest(verdict.reasons)}"
                if self.phase is SkillPhase.RETRACT:
                    self._enter(SkillPhase.FAILED, reason)
                self._give_up(reason)
        if was_sent:
            self._held_since_ns = None

    def _enter_next_phase(self, observation: Observation) -> None:
        depth = observation.depth_m
        if self.phase is SkillPhase.APPROACH:
            force = max(abs(f) for f in observation.wrench[:3])
            if force > self._skill.contact_force_N:
                self._give_up(f"contact in the approach: {force * 1e3:.1f} mN")
            elif depth >= -HOVER_M - REACHED_M:
                self._enter(SkillPhase.INSERT, "")
        elif self.phase is SkillPhase.INSERT:
            if depth >= self._insertion.stroke_m - REACHED_M:
                self._enter(SkillPhase.DONE, "")
            elif observation.wrench[2] >= self._insertion.finish_force_N:
                self._give_up(
                    f"blocked at {depth * 1e6:.0f} um: axial force "
                    f"{observation.wrench[2] * 1e3:.0f} mN"
                )
            elif self.steps >= self._insertion.steps_max:
                self._give_up(f"not inserted after {self.steps} steps")
        if self.phase is SkillPhase.RETRACT and depth <= self._skill.start_depth_m + REACHED_M:
            self._enter(SkillPhase.FAILED, self.reason)

    def _give_up(self, reason: str) -> None:
        if self.phase in (SkillPhase.APPROACH, SkillPhase.INSERT):
            self._held_since_ns = None
            self._enter(SkillPhase.RETRACT, reason)

    def _enter(self, phase: SkillPhase, reason: str) -> None:
        self.phase = phase
        self.reason = reason


def _hardest(reasons: tuple[Reason, ...]) -> str:
    return str(max(reasons, key=lambda reason: reason.severity))
