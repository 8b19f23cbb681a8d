"""Side views of an insertion as images: walls in section, shaft, contact forces.

Diameters and depths are drawn to scale; clearance, lateral deviation and tilt are drawn
`EXAGGERATION` times larger, measured from the shaft's nominal surface. So surfaces touch in the
picture where they touch in the plane of the view.
"""

from collections.abc import Mapping
from types import MappingProxyType

import matplotlib as mpl
import numpy as np
import numpy.typing as npt
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.patches import Polygon, Rectangle

from learning.environments.config import DualPegConfig
from learning.environments.core import Batch
from learning.environments.kernels import Outcome
from simulator.candidates import Station
from simulator.checks import FloatArray
from simulator.contact import Contacts, solve
from simulator.geometry import shaft_axis
from simulator.states import ContactState, contact_states, phase_codes

FRAMES_PER_SECOND = 10
EXAGGERATION = 30.0
ARROW_MM_PER_N = 25.0
"""Length of a force arrow on the axis of depth, up to `_LONGEST_ARROW_MM`."""

_SIZE_IN, _DPI = (9.6, 6.4), 100
_MM = 1e3
_WALL, _WALL_EDGE = "#C9C2AE", "#6B6455"
_SHAFT, _SHAFT_EDGE = "#DCE9F5", "#35597A"
_FORCE = "#C0392B"
_AXES = ("#0072B2", "#D55E00", "#009E73")
_QUIET = "#666666"
_BEHIND_TEXT = {"boxstyle": "round,pad=0.15", "facecolor": "white", "edgecolor": "none"}
_SHORTEST_ARROW_MM, _LONGEST_ARROW_MM = 0.1, 1.25

STATES: Mapping[ContactState, str] = MappingProxyType(
    {
        ContactState.FREE: "no contact",
        ContactState.A: "a: upper hole, at its entry",
        ContactState.B: "b: upper hole, at the shaft's end",
        ContactState.C: "c: upper hole, at both ends",
        ContactState.D: "d: between the holes, one point",
        ContactState.E: "e: between the holes, two points",
        ContactState.F: "f: lower hole, one point",
        ContactState.G: "g: two points at one hole",
        ContactState.H: "h: two points at different holes",
        ContactState.I: "i: three points or more",
    }
)


def picture(config: DualPegConfig, batch: Batch, row: int) -> npt.NDArray[np.uint8]:
    """Image (height, width, 3) of environment `row` of a batch: views along y and x, and forces."""
    pose, travel = batch.pose[row], batch.travel_m[row]
    contacts = solve(config.part, config.shaft, pose, travel, config.law)
    state = ContactState(int(contact_states(contacts, phase_codes(config.part, pose[2]))))
    with mpl.rc_context():
        mpl.rcdefaults()
        mpl.rcParams.update({"font.size": 9.0, "text.parse_math": False})
        figure = Figure(figsize=_SIZE_IN, dpi=_DPI, facecolor="white")
        canvas = FigureCanvasAgg(figure)
        views = figure.subplots(
            1,
            3,
            gridspec_kw={
                "width_ratios": [1.0, 1.0, 0.62],
                "left": 0.065,
                "right": 0.975,
                "bottom": 0.13,
                "top": 0.84,
                "wspace": 0.3,
            },
        )
        for axis, axes in enumerate(views[:2]):
            _draw_view(axes, config, pose, contacts, axis)
        _draw_forces(views[2], config, batch.force_N[row])
        _write_heading(figure, config, batch, row, state)
        canvas.draw()  # type: ignore[no-untyped-call]  # in matplotlib
        return np.asarray(canvas.buffer_rgba())[..., :3].copy()  # type: ignore[no-untyped-call]  # in matplotlib


def _draw_view(
    axes: Axes, config: DualPegConfig, pose: FloatArray, contacts: Contacts, axis: int
) -> None:
    """The section through the plane of z and one lateral axis (0: x, 1: y); z points down."""
    nominal = config.shaft.radius_m * _MM
    outside = 2.6 * nominal
    rims = config.part.rim_depths_m * _MM
    for entry, exit_, radius in zip(
        rims[0::2], rims[1::2], config.part.wall_radii_m * _MM, strict=True
    ):
        face = nominal + EXAGGERATION * (radius - nominal)
        for left in (-outside, face):
            wall = Rectangle(
                (left, entry),
                outside - face,
                exit_ - entry,
                facecolor=_WALL,
                edgecolor=_WALL_EDGE,
                hatch="////",
                linewidth=0.8,
            )
            axes.add_patch(wall)
    _draw_shaft(axes, config, pose, axis)
    _draw_contacts(axes, config, contacts, axis)
    axes.set_xlim(-outside, outside)
    axes.set_ylim(rims[-1] + 0.45, -1.35)
    axes.set_xlabel(f"{'xy'[axis]}, diameter to scale [mm]")
    axes.set_ylabel("depth z [mm]")
    axes.set_title(f"seen along {'yx'[axis]}", loc="left", fontsize=9.0, fontweight="bold")
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)


def _draw_shaft(axes: Axes, config: DualPegConfig, pose: FloatArray, axis: int) -> None:
    nominal, length = config.shaft.radius_m * _MM, config.shaft.length_m * _MM
    u = shaft_axis(pose)
    lead = np.array([EXAGGERATION * pose[axis], pose[2]]) * [_MM, _MM]
    back = lead - length * np.array([EXAGGERATION * u[axis], u[2]])
    side = np.array([nominal, -nominal * EXAGGERATION * u[axis]])
    corners = np.array([lead - side, lead + side, back + side, back - side])
    axes.add_patch(Polygon(corners, facecolor=_SHAFT, edgecolor=_SHAFT_EDGE, linewidth=1.2))
    axes.plot(
        *np.array([lead, back]).T, color=_SHAFT_EDGE, linewidth=0.8, linestyle=(0, (8, 3, 2, 3))
    )
    axes.axvline(0.0, color=_WALL_EDGE, linewidth=0.6, linestyle=(0, (8, 3, 2, 3)), zorder=1)


def _draw_contacts(axes: Axes, config: DualPegConfig, contacts: Contacts, axis: int) -> None:
    """A mark at each contact, its force as an arrow, and its size where most of it is in view."""
    nominal = config.shaft.radius_m
    for index in np.flatnonzero(contacts.penetration > 0.0):
        point, force = contacts.point[index], contacts.force[index]
        distance = float(np.hypot(point[0], point[1]))
        shown = point[axis] / distance * (nominal + EXAGGERATION * (distance - nominal))
        at = np.array([shown, point[2]]) * _MM
        arrow = ARROW_MM_PER_N * force[[axis, 2]]
        in_view = abs(point[axis]) >= abs(point[1 - axis])
        length = float(np.linalg.norm(arrow))
        if length > _SHORTEST_ARROW_MM:
            arrow *= min(1.0, _LONGEST_ARROW_MM / length)
            axes.annotate(
                "",
                _pair(at + arrow),
                _pair(at),
                arrowprops={
                    "arrowstyle": "-|>,head_length=0.35,head_width=0.18",
                    "color": _FORCE,
                    "linewidth": 1.8,
                    "shrinkA": 0.0,
                    "shrinkB": 0.0,
                },
                zorder=5,
            )
        fill = _FORCE if in_view else "white"
        axes.plot(*at, "o", markersize=5.0, color=_FORCE, markerfacecolor=fill, zorder=6)
        if in_view:
            outwards = 1.0 if point[axis] >= 0.0 else -1.0
            above = contacts.candidates.station[index] == Station.UPPER
            axes.annotate(
                f"{np.linalg.norm(force) * 1e3:.1f} mN",
                _pair(at),
                xytext=(outwards * 10.0, 7.0 if above else -16.0),
                textcoords="offset points",
                ha="left" if outwards > 0.0 else "right",
                color=_FORCE,
                fontweight="bold",
                zorder=7,
                bbox=_BEHIND_TEXT,
            )


def _pair(point: FloatArray) -> tuple[float, float]:
    return float(point[0]), float(point[1])


def _draw_forces(axes: Axes, config: DualPegConfig, force_N: FloatArray) -> None:
    """Bars of the three forces, each by its limit."""
    limits = np.array(config.force_limit_N)
    axes.barh([0, 1, 2], [2.0] * 3, left=-1.0, color="#EEEEEE", height=0.3, zorder=0)
    axes.barh([0, 1, 2], force_N / limits, color=_AXES, height=0.3, zorder=2)
    for place, (force, limit) in enumerate(zip(force_N * 1e3, limits * 1e3, strict=True)):
        axes.text(
            0.0,
            place - 0.22,
            f"f_{'xyz'[place]}  {force:.1f} of {limit:g} mN",
            ha="center",
            va="bottom",
            color=_AXES[place],
            fontsize=8.0,
            fontweight="bold",
            bbox=_BEHIND_TEXT,
        )
    for edge in (-1.0, 1.0):
        axes.axvline(edge, color=_FORCE, linewidth=1.0, linestyle=(0, (6, 3)))
    axes.axvline(0.0, color=_QUIET, linewidth=0.8)
    axes.set_xlim(-1.15, 1.15)
    axes.set_ylim(2.5, -0.6)
    axes.set_yticks([])
    axes.set_xticks([-1.0, 0.0, 1.0], ["-limit", "0", "limit"])
    axes.set_title("force on the part", loc="left", fontsize=9.0, fontweight="bold")
    for side in ("top", "right", "left"):
        axes.spines[side].set_visible(False)


def _write_heading(
    figure: Figure, config: DualPegConfig, batch: Batch, row: int, state: ContactState
) -> None:
    depth, stroke = batch.pose[row, 2] * 1e6, config.stroke_m * 1e6
    figure.text(0.065, 0.945, STATES[state], fontsize=14.0, fontweight="bold")
    outcome = Outcome(int(batch.outcome[row])).name.lower().replace("_", " ")
    figure.text(
        0.065,
        0.9,
        f"depth {depth:.0f} of {stroke:.0f} um, step {batch.steps[row]}, {outcome}",
        fontsize=10.5,
    )
    offset, tilt = batch.pose[row, :2] * 1e6, np.degrees(batch.pose[row, 3:])
    figure.text(
        0.065,
        0.02,
        f"Clearance, deviation and tilt are drawn {EXAGGERATION:.0f} times larger. "
        f"Shaft's end at x {offset[0]:+.1f}, y {offset[1]:+.1f} um; "
        f"tilt about x {tilt[0]:+.2f}, about y {tilt[1]:+.2f} degrees.",
        color=_QUIET,
        fontsize=8.5,
    )
