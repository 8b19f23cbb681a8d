"""Side view of a shaft and walls in the plane y = 0, with clearance, tilt and overlap enlarged.

Along z the drawing is true to scale (mm). Across, only the distance from the bore's wall is
enlarged: on either side, x is drawn at half the bore's width plus `gain` times its distance from
the wall. Straight lines stay straight, and the shaft keeps its width.
"""

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from matplotlib.axes import Axes

from figures_of.paint import (
    EDGE_COLOUR,
    OVERLAP_COLOUR,
    RIM_COLOUR,
    SHAFT_COLOUR,
    SHAFT_LINE,
    WALL_FILL,
    WALL_LINE,
    arrow,
)
from simulator.candidates import Kind
from simulator.contact import Contacts
from simulator.geometry import Part, Shaft, shaft_axis

FloatArray = npt.NDArray[np.float64]

HALF_WIDTH = 0.5
"""Half the bore's width as drawn [mm]."""
WALL_END = 1.05
"""Distance from the axis at which a drawn wall ends [mm]."""


@dataclass(frozen=True, slots=True)
class Section:
    """A part with bores of one diameter, a shaft, and a pose (5,) with y = 0 and rx = 0."""

    part: Part
    shaft: Shaft
    pose: FloatArray
    gain: float
    top_mm: float
    """Where the drawn shaft is cut off."""

    def across(self, x_m: FloatArray, side: float) -> FloatArray:
        """Drawn place [mm] of x [m] on the side of +x (1) or -x (-1)."""
        bore_m = float(self.part.wall_radii_m[0])
        return side * (HALF_WIDTH + (side * x_m - bore_m) * 1e3 * self.gain)

    def flank(self, z_mm: FloatArray, side: float) -> FloatArray:
        """Drawn place [mm] of the shaft's flank at the depths z [mm]."""
        ux, _, uz = shaft_axis(self.pose)
        axis_m = self.pose[0] + ux / uz * (z_mm * 1e-3 - self.pose[2])
        return self.across(axis_m + side * self.shaft.radius_m / uz, side)

    def tip_mm(self, side: float) -> float:
        """Depth of the leading edge on one side [mm]."""
        return float(self.pose[2] - side * self.shaft.radius_m * shaft_axis(self.pose)[0]) * 1e3

    def draw_solids(self, axes: Axes) -> None:
        """Draw walls, shaft and where the two overlap."""
        left = np.array([self.top_mm, self.tip_mm(-1.0)])
        right = np.array([self.top_mm, self.tip_mm(1.0)])
        axes.fill(
            np.concatenate([self.flank(left, -1.0), self.flank(right, 1.0)[::-1]]),
            np.concatenate([left, right[::-1]]),
            facecolor=SHAFT_COLOUR,
            edgecolor="none",
            zorder=2,
        )
        for low_m, high_m in zip(self.part.wall_entries_m, self.part.wall_exits_m, strict=True):
            low, high = low_m * 1e3, high_m * 1e3
            for side in (-1.0, 1.0):
                x = [side * HALF_WIDTH, side * WALL_END, side * WALL_END, side * HALF_WIDTH]
                axes.fill(
                    x, [low, low, high, high], facecolor=WALL_FILL, edgecolor="none", zorder=1
                )
                axes.plot(
                    [x[1], x[0], x[0], x[1]],
                    [low, low, high, high],
                    color=WALL_LINE,
                    linewidth=1.0,
                    zorder=3,
                )
                self._draw_overlap(axes, side, low, min(high, self.tip_mm(side)))
        for side, z in ((-1.0, left), (1.0, right)):
            axes.plot(self.flank(z, side), z, color=SHAFT_LINE, linewidth=1.2, zorder=4)
        end = [
            (float(self.flank(z[-1:], s)[0]), float(z[-1])) for s, z in ((-1.0, left), (1, right))
        ]
        axes.plot(*zip(*end, strict=True), color=SHAFT_LINE, linewidth=1.2, zorder=4)

    def _draw_overlap(self, axes: Axes, side: float, low_mm: float, high_mm: float) -> None:
        """Shade what of the shaft lies in a wall that it passes from `low_mm` to `high_mm`."""
        if high_mm <= low_mm:
            return
        z = np.array([low_mm, high_mm])
        depth = side * self.flank(z, side) - HALF_WIDTH
        if depth.max() <= 0.0:
            return
        if depth.min() < 0.0:
            z[depth.argmin()] -= np.diff(z)[0] / np.diff(depth)[0] * depth.min()
        x = side * (HALF_WIDTH + np.maximum(depth, 0.0))
        axes.fill_betweenx(z, side * HALF_WIDTH, x, color=OVERLAP_COLOUR, linewidth=0, zorder=3)

    def draw_contacts(self, axes: Axes, contacts: Contacts, mm_per_N: float) -> None:
        """Mark where the shaft touches, with an arrow that grows with the force on the part."""
        for index in np.flatnonzero(contacts.penetration > 0.0):
            x_m, _, z_m = contacts.point[index]
            side = float(np.sign(x_m))
            rim = contacts.candidates.kind[index] == Kind.RIM
            colour = RIM_COLOUR if rim else EDGE_COLOUR
            at = (float(self.across(x_m, side)), float(z_m) * 1e3)
            length = 0.14 + float(np.linalg.norm(contacts.force[index])) * mm_per_N
            arrow(axes, at, (at[0] + side * length, at[1]), colour, 1.6)
            axes.plot(*at, marker="o" if rim else "s", color=colour, markersize=5.5, zorder=8)
