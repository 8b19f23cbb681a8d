"""What people see of a training by rounds while it runs."""

from collections.abc import Sequence
from pathlib import Path

from rich.console import Console

from learning.ddpg import Round
from learning.display import Display

RECENT = 20
"""Rounds that the share of successes is taken over."""


class RoundDisplay(Display):
    """Shows round by round how a training goes."""

    def __init__(
        self, console: Console, scalars: Path, total: int, played: Sequence[Round]
    ) -> None:
        super().__init__(console, scalars, "Round", total, len(played))
        self._rounds = [*played]
        self._steps = sum(r.steps for r in played)

    def show(self, played: Round) -> None:
        """Show a round that was played."""
        self._rounds.append(played)
        self._steps += played.steps
        recent = self._rounds[-RECENT:]
        share = sum(r.succeeded for r in recent) / len(recent)
        figures = {
            "round/success": float(played.succeeded),
            f"round/success_of_{RECENT}": share,
            "round/steps": played.steps,
            "round/reward_per_step": played.reward / played.steps,
            "round/peak_radial_force_mN": 1e3 * played.peak_radial_N,
            "round/sigma": played.sigma,
            "update/critic_loss": played.critic_loss,
            "update/value": played.value,
            "total/steps": self._steps,
        }
        line = (
            f"success {share:.0%} {played.steps} steps {1e3 * played.peak_radial_N:.0f} mN "
            f"reward {played.reward / played.steps:.2f} sigma {played.sigma:g}"
        )
        self.tell(figures, line)
