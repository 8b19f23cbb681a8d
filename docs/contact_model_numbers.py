"""Measures what docs/explanation/contact-model.md says: python docs/contact_model_numbers.py.

The code is compared with sums over many points of a circle, with central differences, with an
elastic foundation, and its assumptions with formulas of the strength of materials.
"""

import sys
from collections.abc import Callable

import numpy as np
import numpy.typing as npt
from figures_of import chamfer_map, cut_circle, extremum, ring
from figures_of.paper_part import PART, SHAFT

from simulator.contact import ContactLaw, solve
from simulator.extremum import NEWTON_STEPS, discretised_search
from simulator.geometry import Part, Shaft, shaft_axis
from simulator.initial_pose import initial_poses

FloatArray = npt.NDArray[np.float64]

SEED = 1
LAW, SMOOTH = ContactLaw(), ContactLaw(friction=0.0)
STEEL_PA, STEEL_KG_M3, POISSON = 210e9, 7850.0, 0.3
TILT_DEG = 0.3
SPEED_M_S = 5e-3
AT_REST = (0.0, 0.0, 0.0)
DOWN = (0.0, 0.0, 1.0)
FINE_DEG = np.linspace(-180.0, 180.0, 72_001)
TURN = np.linspace(0.0, 2.0 * np.pi, 3601)


def below(value: float, bound: float) -> str:
    """`value` as it is worth telling: as its bound, since rounding differs between machines."""
    return f"below {bound:.0e}" if value < bound else f"{value:.1e}"


def poses(count: int) -> FloatArray:
    """Poses like those of an insertion: shape (count, 5), at all depths, of any direction."""
    generator = np.random.default_rng(SEED)
    drawn = initial_poses(count, 15e-6, np.radians(2.0 * TILT_DEG), 0.0, generator)
    drawn[:, 2] = generator.uniform(0.0, float(PART.wall_exits_m[-1]), count)
    return drawn


def squared_distances() -> str:
    """Largest error of the two trigonometric polynomials, relative to the squared radius."""
    ring_ = np.stack([np.cos(TURN), np.sin(TURN)])
    worst = 0.0
    for pose in poses(200):
        u = shaft_axis(pose)
        sin, cos = np.hypot(u[0], u[1]), u[2]
        turn = np.array([[u[0], u[1]], [-u[1], u[0]]]) / sin
        p1, p2 = turn @ pose[:2]
        height = PART.rim_depths_m[1] - pose[2]
        for radius, m, sign, direct in (
            (PART.rim_radii_m[1], (cos * (cos * p1 + sin * height), p2), -1.0, _rim_square(pose)),
            (SHAFT.radius_m, (p2, cos * p1), 1.0, _edge_square(pose)),
        ):
            g = 2.0 * (m[0] * ring_[0] + m[1] * ring_[1]) + radius * sin**2 * ring_[0] ** 2
            difference = direct - sign * radius * g
            worst = max(worst, float(np.ptp(difference)) / radius**2)
    return below(worst, 1e-14)


def _turned(pose: FloatArray) -> FloatArray:
    """Columns: the tilt's direction, across it, and z."""
    u = shaft_axis(pose)
    tilt = np.array([u[0], u[1], 0.0]) / np.hypot(u[0], u[1])
    return np.stack([tilt, np.cross((0.0, 0.0, 1.0), tilt), (0.0, 0.0, 1.0)], axis=-1)


def _rim_square(pose: FloatArray) -> FloatArray:
    """Squared distances of points around A2 from the shaft's axis."""
    frame, radius = _turned(pose), PART.rim_radii_m[1]
    circle = radius * (np.outer(np.cos(TURN), frame[:, 0]) + np.outer(np.sin(TURN), frame[:, 1]))
    circle[:, 2] += PART.rim_depths_m[1]
    square: FloatArray = (np.cross(circle - pose[:3], shaft_axis(pose)) ** 2).sum(axis=-1)
    return square


def _edge_square(pose: FloatArray) -> FloatArray:
    """Squared distances of points around B2 from the hole's axis."""
    frame, u = _turned(pose), shaft_axis(pose)
    across, along = frame[:, 1], np.cross(frame[:, 1], u)
    ring_ = np.outer(np.cos(TURN), across) + np.outer(np.sin(TURN), along)
    square: FloatArray = ((pose[:3] + SHAFT.radius_m * ring_)[:, :2] ** 2).sum(axis=-1)
    return square


def newton_misses() -> tuple[str, str]:
    """Largest angle to e* [rad] before the first step, and after the last."""
    angles, _ = extremum.worst_misses()
    return f"{angles[0]:.2f} rad", below(float(angles[NEWTON_STEPS]), 1e-14)


def start_factor() -> str:
    """Largest ratio of the start's y to the multiplier lambda, over all ratios."""
    grid = 10.0**extremum.DECADES
    a, c = (values.ravel() for values in np.meshgrid(grid, grid))
    b = np.ones_like(a)
    e = extremum.start(a, c, b)
    y = c / e[1]
    for _ in range(12):
        e = extremum.step(e, a, c, b)
    return f"{(y / np.hypot(a + b * e[0], c)).max():.2f}"


def discretised_overlap() -> str:
    """Largest overlap that the best of 360 points misses where there is contact."""
    exact, coarse = (
        solve(PART, SHAFT, poses(4000), AT_REST, LAW, *search)
        for search in ((), (discretised_search(360),))
    )
    touching = exact.penetration > 0.0
    return f"{(exact.overlap - coarse.overlap)[touching].max() * 1e9:.1f} nm"


def cut_penetration() -> str:
    """Largest difference of a cut circle's penetration to the best of the points around it."""
    worst = 0.0
    for pose, index, terms in (
        (cut_circle.RIM_POSE, cut_circle.RIM_A1, cut_circle.rim_terms),
        (cut_circle.EDGE_POSE, cut_circle.EDGE_AT_UPPER_WALL, cut_circle.edge_terms),
    ):
        overlap, entered, other = terms(pose, FINE_DEG)
        effective = np.minimum(overlap, entered)
        if index == cut_circle.RIM_A1:
            effective = np.minimum(effective, other)
        else:
            effective -= np.maximum(other, 0.0)
        found = solve(PART, SHAFT, pose, AT_REST).penetration[index]
        worst = max(worst, float(found - effective.max()))
    return f"{worst * 1e9:.1f} nm"


def gradient() -> str:
    """Largest difference of force and energy gradient away from edges, relative to the force."""
    return below(float(_gradient_misses(PART, SHAFT, poses(2000)).max()), 1e-7)


def _gradient_misses(part: Part, shaft: Shaft, at: FloatArray) -> FloatArray:
    """Difference of force and central difference of the energy, relative to the force.

    For those poses, of `at`, that touch and in which no circle is cut by an end.
    """
    step_m = 1e-10
    solid = solve(part, shaft, at, AT_REST, SMOOTH)
    depth = solid.penetration
    whole = ((depth == 0.0) | ((depth == solid.overlap) & (depth > 1e-8))).all(axis=-1)
    shifts = step_m * np.eye(5)[:3]
    energies = [solve(part, shaft, at + s, AT_REST, SMOOTH).energy for s in (*shifts, *-shifts)]
    slope = np.stack([energies[i] - energies[i + 3] for i in range(3)], axis=-1) / (2.0 * step_m)
    force = solid.wrench[:, :3]
    size = np.linalg.norm(force, axis=-1)
    use = whole & (size > 1e-3)
    misses: FloatArray = np.linalg.norm(slope - force, axis=-1)[use] / size[use]
    return misses


def gradient_of_worked_surfaces() -> str:
    """The same of a rounded shaft in chamfered holes, about their mouths."""
    generator = np.random.default_rng(SEED)
    at = np.zeros((6000, 5))
    at[:, :2] = generator.uniform(-20e-6, 20e-6, (len(at), 2))
    at[:, 2] = generator.uniform(0.0, 120e-6, len(at))
    at[:, 3:] = np.radians(generator.uniform(-2.0, 2.0, (len(at), 2)) * TILT_DEG)
    part, shaft = chamfer_map.WORKED_PART, chamfer_map.WORKED_SHAFT
    return below(float(_gradient_misses(part, shaft, at).max()), 1e-7)


def force_at_throat() -> tuple[str, str]:
    """Axial force before and after the leading edge passes the throat of a chamfered mouth."""
    _, force = chamfer_map.path(chamfer_map.WORKED_PART, SHAFT, blocking=False)
    jump = int(np.diff(force[:, 2]).argmin())
    before, after = force[jump : jump + 2, 2] * 1e3
    return f"{before:.0f} mN", f"{after:.0f} mN"


def energy_gained() -> str:
    """Energy of one station at an overlap of 5 um, gained by going in and pulling out aside."""
    return f"{0.5 * LAW.stiffness_N_m * 5e-6**2 * 1e9:.0f} nJ"


def four_points_exact() -> str:
    """Largest error of energy and force of four points at any turn while all of them touch."""
    e = np.linspace(0.01, 0.7, 70)
    delta = np.ones_like(e)
    worst = 0.0
    for turn in np.linspace(0.0, 0.5 * np.pi, 46):
        force, energy = ring.four_points(delta, e, turn)
        worst = max(worst, float(np.abs(energy - (2.0 + e * e)).max()))
        worst = max(worst, float(np.abs(force - 2.0 * e).max()))
    return below(worst, 1e-14)


def four_points_partly() -> str:
    """Largest shortfall of their lateral force against the foundation, for any offset."""
    e = np.linspace(1.0, 20.0, 400)
    delta = np.ones_like(e)
    ratio = ring.four_points(delta, e)[0] / ring.foundation(delta, e)[0]
    return f"{(1.0 - ratio.min()) * 100.0:.0f} %"


def one_point_with_clearance() -> str:
    """Force of a foundation in place of one point's 10 mN, at the clearance of the paper's fit."""
    clearance = PART.wall_radii_m[0] - SHAFT.radius_m
    offset = clearance + 10e-3 / LAW.stiffness_N_m
    force = ring.foundation(np.array([-clearance]), np.array([offset]))[0] * LAW.stiffness_N_m
    return f"{force[0] * 1e3:.1f} mN"


def bending() -> str:
    """Share of the shaft's bending in the deflection under a force at its end, clamped at B1."""
    area_moment = np.pi * SHAFT.diameter_m**4 / 64.0
    stiffness = 3.0 * STEEL_PA * area_moment / SHAFT.length_m**3
    return f"{100.0 * LAW.stiffness_N_m / (LAW.stiffness_N_m + stiffness):.1f} %"


def local_stiffness() -> str:
    """How much stiffer a line contact of steel as long as a wall is thick is than k."""
    modulus = STEEL_PA / (2.0 * (1.0 - POISSON**2))
    return f"{0.25 * np.pi * modulus * PART.holes[0].thickness_m / LAW.stiffness_N_m:.0f} times"


def wedge_tilt() -> str:
    """Tilt at which the projected shaft is as wide as the hole."""
    return f"{np.degrees(np.arccos(SHAFT.diameter_m / PART.holes[0].diameter_m)):.1f}°"


def slope_of_the_end() -> str:
    """Height difference across the end face."""
    return f"{SHAFT.diameter_m * np.sin(np.radians(TILT_DEG)) * 1e6:.1f} µm"


def landing() -> tuple[str, str]:
    """Axial force 50 um below the face, 10 um aside: elastic, and blocked."""
    pose = np.array([10e-6, 0.0, 50e-6, 0.0, 0.0])
    elastic = solve(PART, SHAFT, pose, DOWN, LAW)
    blocked = solve(PART, SHAFT, pose, DOWN, LAW, entered=np.zeros(len(PART.holes), dtype=bool))
    low, high = (contacts.wrench[2] * 1e3 for contacts in (elastic, blocked))
    return f"{low:.0f} mN", f"{high:.0f} mN"


def before_standing() -> str:
    """Largest radial force on the way down with blocking, before the end stands."""
    _, force = chamfer_map.path(PART, SHAFT, blocking=True)
    return f"{np.hypot(force[:, 0], force[:, 1]).max() * 1e3:.1f} mN"


def impact() -> str:
    """Peak force of the free shaft's mass at the speed limit against one contact."""
    mass = STEEL_KG_M3 * np.pi * SHAFT.radius_m**2 * SHAFT.length_m
    return f"{SPEED_M_S * np.sqrt(LAW.stiffness_N_m * mass) * 1e3:.1f} mN"


def order_of_tilts() -> str:
    """Largest angle between the axes of the two orders of rotation at the paper's tilt."""
    ways = np.linspace(0.0, 2.0 * np.pi, 73)
    rx, ry = np.radians(TILT_DEG) * np.stack([np.cos(ways), np.sin(ways)])
    zero = np.zeros((3, ways.size))
    first = shaft_axis(np.stack([*zero, rx, ry], axis=-1))
    other = np.stack([np.sin(ry), -np.sin(rx) * np.cos(ry), np.cos(rx) * np.cos(ry)], axis=-1)
    return f"{np.linalg.norm(first - other, axis=-1).max() * 1e6:.2f} µrad"


def per_micrometre() -> str:
    """Force that a micrometre of form or position error makes at one circle."""
    return f"{LAW.stiffness_N_m * 1e-6 * 1e3:.0f} mN"


def friction_band() -> str:
    """Width of the band in which friction of a normal force of 40 mN can lie at rest."""
    return f"{2.0 * LAW.friction * 40.0:.0f} mN"


MEASURES: tuple[Callable[[], str | tuple[str, ...]], ...] = (
    squared_distances,
    newton_misses,
    start_factor,
    discretised_overlap,
    cut_penetration,
    gradient,
    gradient_of_worked_surfaces,
    force_at_throat,
    energy_gained,
    four_points_exact,
    four_points_partly,
    one_point_with_clearance,
    bending,
    local_stiffness,
    wedge_tilt,
    slope_of_the_end,
    landing,
    before_standing,
    impact,
    order_of_tilts,
    per_micrometre,
    friction_band,
)


def main() -> None:
    """Print every number with what it measures."""
    for measure in MEASURES:
        result = measure()
        text = result if isinstance(result, str) else ", ".join(result)
        first_line = str(measure.__doc__).splitlines()[0]
        sys.stdout.write(f"{measure.__name__:28} {text:24} {first_line}\n")


if __name__ == "__main__":
    main()
