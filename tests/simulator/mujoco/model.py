"""A part and a shaft as a MuJoCo model: contact found by an engine that knows nothing of ours.

Each hole is a ring of boxes whose inner faces touch the hole's circle from outside, a regular
polygon; the shaft is MuJoCo's cylinder, exact and with sharp end circles. MuJoCo's convex collider
with several points to a pair (its default) finds a contact at either end of the stretch over which
a box and the shaft lie along each other: the two stations of a wall in the analytic model.

MuJoCo's lengths are millimetres here, its masses kg and its forces mN; 1 N/m is 1 mN/mm. Its frame
is frame M of the part.
"""

import math
from dataclasses import dataclass

import mujoco
import numpy as np
import numpy.typing as npt

from simulator.checks import FloatArray
from simulator.geometry import Part, Shaft

MM_PER_M = 1e3
CARRIAGE_KG = 1.0
"""Mass that moves with the shaft; no equilibrium depends on it."""


@dataclass(frozen=True, slots=True)
class ContactSpring:
    """MuJoCo's soft contact, set such that every contact at rest is a linear spring.

    At rest MuJoCo's force is mass * K * depth / (1 - impedance), -K the first entry of `solref`.
    """

    stiffness_N_m: float = 4e3
    friction: float = 0.0
    impedance: float = 0.5

    def attributes(self) -> str:
        """Attributes of a <geom> in MJCF."""
        slack = 1.0 - self.impedance
        per_kg = self.stiffness_N_m / CARRIAGE_KG
        return (
            f'solref="{-per_kg * slack} {-2.0 * math.sqrt(per_kg) * slack}" '
            f'solimp="{self.impedance} {self.impedance} 1" '
            f'condim="{3 if self.friction else 1}" friction="{self.friction} 0 0"'
        )


@dataclass(frozen=True, slots=True)
class Collider:
    """Settings of MuJoCo's collider; others than these are there to see what they do."""

    units_per_m: float = MM_PER_M
    tolerance: float = 1e-9
    """A length in the model's unit. MuJoCo's default, 1e-6, suits metres and parts of that size."""
    flags: str = ""
    """Attributes of <flag> in MJCF."""


@dataclass(frozen=True, slots=True)
class Scene:
    """The compiled model and what is needed to read its contacts."""

    model: mujoco.MjModel
    part: Part
    shaft: Shaft
    units_per_m: float
    wall: npt.NDArray[np.int64]
    """(geoms,): the wall that a box belongs to; -1 for the shaft."""


def build(
    part: Part,
    shaft: Shaft,
    sides: int,
    spring: ContactSpring = ContactSpring(),
    holder_N_m: float = 0.0,
    collider: Collider = Collider(),
) -> Scene:
    """Compile `shaft` in `part` with `sides` boxes to each hole.

    The shaft slides along x, y, z against springs of `holder_N_m` about 0, and turns about the
    centre of its leading end with an inertia too large for any contact to move: its tilt is given.
    """
    scale = collider.units_per_m
    damping = 2.0 * math.sqrt((holder_N_m + spring.stiffness_N_m) * CARRIAGE_KG)
    slides = "".join(
        f'<joint type="slide" axis="{axis}" stiffness="{holder_N_m}" damping="{damping}"/>'
        for axis in ("1 0 0", "0 1 0", "0 0 1")
    )
    radius, half = shaft.radius_m * scale, 0.5 * shaft.length_m * scale
    model = mujoco.MjModel.from_xml_string(
        f'<mujoco><option gravity="0 0 0" integrator="implicitfast" ccd_iterations="200"'
        f' ccd_tolerance="{collider.tolerance}"><flag diagexact="enable" {collider.flags}/>'
        f"</option><default><geom {spring.attributes()}/></default><worldbody>"
        f"{''.join(_ring(part, wall, sides, scale) for wall in range(len(part.holes)))}"
        f'<body><inertial pos="0 0 0" mass="{CARRIAGE_KG}" diaginertia="1 1 1"/>{slides}'
        f'<body><inertial pos="0 0 0" mass="1e-9" diaginertia="1e-9 1e-9 1e-9"/>'
        f'<joint type="ball" armature="1e12"/>'
        f'<geom name="shaft" type="cylinder" size="{radius} {half}" pos="0 0 {-half}"/>'
        f"</body></body></worldbody></mujoco>"
    )
    names = [model.geom(i).name.split("/") for i in range(model.ngeom)]
    wall = np.array([int(name[1]) if name[0] == "wall" else -1 for name in names])
    return Scene(model, part, shaft, scale, wall)


def _ring(part: Part, wall: int, sides: int, scale: float) -> str:
    """Boxes as wide as the polygon's side and, radially, as deep as the hole's radius."""
    r = float(part.wall_radii_m[wall]) * scale
    top, bottom = part.wall_entries_m[wall] * scale, part.wall_exits_m[wall] * scale
    size = f"{0.5 * r} {r * math.tan(math.pi / sides)} {0.5 * (bottom - top)}"
    boxes = []
    for k in range(sides):
        a = 2.0 * math.pi * k / sides
        at = f"{1.5 * r * math.cos(a)} {1.5 * r * math.sin(a)} {0.5 * (top + bottom)}"
        turn = f"{math.cos(0.5 * a)} 0 0 {math.sin(0.5 * a)}"
        boxes.append(
            f'<geom name="wall/{wall}/{k}" type="box" size="{size}" pos="{at}" quat="{turn}"/>'
        )
    return "".join(boxes)


def joints(pose: npt.ArrayLike, units_per_m: float = MM_PER_M) -> FloatArray:
    """Joint positions of a pose x, y, z [m], rx, ry [rad]: x, y, z, then a quaternion."""
    x, y, z, rx, ry = np.asarray(pose, dtype=np.float64)
    sx, cx, sy, cy = np.sin(0.5 * rx), np.cos(0.5 * rx), np.sin(0.5 * ry), np.cos(0.5 * ry)
    at = np.array([x, y, z]) * units_per_m
    return np.concatenate([at, [cy * cx, cy * sx, sy * cx, -sy * sx]])


def find_contacts(scene: Scene, data: mujoco.MjData, pose: npt.ArrayLike) -> None:
    """Put the shaft at `pose` and let MuJoCo list the contacts in `data`."""
    data.qpos[:] = joints(pose, scene.units_per_m)
    mujoco.mj_kinematics(scene.model, data)
    mujoco.mj_comPos(scene.model, data)
    mujoco.mj_collision(scene.model, data)
