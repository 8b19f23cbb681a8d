"""What people see of an analytic training while it runs."""

from pathlib import Path

from rich.console import Console

from learning.analytic.trainer import Update
from learning.display import Display


class UpdateDisplay(Display):
    """Shows update by update how a training goes."""

    def __init__(self, console: Console, scalars: Path, total: int) -> None:
        super().__init__(console, scalars, "Update", total)

    def show(self, made: Update) -> None:
        """Show an update that was made."""
        figures = {
            "insertion/reward_per_step": made.reward,
            "insertion/radial_force_mN": 1e3 * made.radial_N,
            "insertion/steps": made.steps,
            "update/gradient_norm": made.gradient_norm,
        }
        self.tell(
            figures,
            f"reward {made.reward:.3f} radial {1e3 * made.radial_N:.2f} mN {made.steps:.0f} steps",
        )
