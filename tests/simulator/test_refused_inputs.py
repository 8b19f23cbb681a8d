"""Invalid input is refused with the parameter's name, its value, and what is valid."""

from collections.abc import Callable

import numpy as np
import pytest

from simulator.blocking import update_entered
from simulator.contact import ContactLaw, solve
from simulator.geometry import Hole, Part, Shaft, shaft_axis, tilt_of
from simulator.initial_pose import initial_poses
from simulator.plant import Trapezoid, braking
from simulator.profile import Chamfer, Rounding
from simulator.wrench import move_torque

NAN, INF = float("nan"), float("inf")
HOLE, SHAFT = Hole(1.01e-3, 5e-4), Shaft(1e-3, 4e-3)
PART = Part((HOLE,))
POSE = [0.0, 0.0, 1e-4, 0.0, 0.0]
RNG = np.random.default_rng(0)

CASES: list[tuple[Callable[[], object], str]] = [
    (lambda: Shaft(0.0, 1e-3), r"Shaft.diameter_m is 0.0; it must be finite and greater than 0"),
    (lambda: Shaft(NAN, 1e-3), r"Shaft.diameter_m is nan"),
    (lambda: Shaft(1e-3, -1.0), r"Shaft.length_m is -1.0"),
    (lambda: Shaft(1e-3, INF), r"Shaft.length_m is inf"),
    (lambda: Hole(-1e-3, 1e-4), r"Hole.diameter_m is -0.001"),
    (lambda: Hole(1e-3, 0.0), r"Hole.thickness_m is 0.0"),
    (lambda: Hole(1e-3, 1e-4, -1e-6), r"Hole.gap_m is -1e-06; it must be finite and at least 0"),
    (lambda: Hole(1e-3, 1e-4, NAN), r"Hole.gap_m is nan"),
    (lambda: Chamfer(0.0, 1e-5), r"Chamfer.width_m is 0.0; it must be finite and greater than 0"),
    (lambda: Chamfer(1e-5, NAN), r"Chamfer.height_m is nan"),
    (lambda: Rounding(-1e-5), r"Rounding.radius_m is -1e-05"),
    (
        lambda: Hole(1e-3, 1e-4, entry=Chamfer(1e-5, 1e-4)),
        r"Hole.entry.height_m is 0.0001; it must be below thickness_m, 0.0001",
    ),
    (
        lambda: Shaft(1e-3, 4e-3, Chamfer(5e-4, 1e-4)),
        r"Shaft.leading.width_m is 0.0005; it must be below the radius, 0.0005",
    ),
    (lambda: Shaft(1e-3, 4e-3, trailing=Chamfer(6e-4, 1e-4)), r"Shaft.trailing.width_m is 0.0006"),
    (lambda: Shaft(1e-3, 4e-3, Rounding(5e-4)), r"Shaft.leading.radius_m is 0.0005"),
    (lambda: Shaft(1e-3, 1e-4, Chamfer(1e-5, 1e-4)), r"Shaft.leading makes .* 0.0001 long; .* sho"),
    (
        lambda: Shaft(1e-3, 1e-4, Rounding(6e-5), Chamfer(1e-5, 5e-5)),
        r"Shaft.trailing makes the worked ends .* must be shorter than length_m, 0.0001",
    ),
    (lambda: Shaft.of_profile(((0.0, 1e-3),)), r"Shaft.profile_m has shape \(1, 2\)"),
    (lambda: Shaft.of_profile(((0.0, 1e-3), (NAN, 1e-3))), r"Shaft.profile_m .* must be finite"),
    (lambda: Shaft.of_profile(((1e-6, 1e-3), (1e-3, 1e-3))), r"Shaft.profile_m .* s must begin"),
    (lambda: Shaft.of_profile(((0.0, 1e-3), (0.0, 2e-3))), r"Shaft.profile_m .* and increase"),
    (lambda: Shaft.of_profile(((0.0, 0.0), (1e-3, 1e-3))), r"Shaft.profile_m .* every radius must"),
    (
        lambda: Shaft.of_profile(((0.0, 1e-3), (1e-3, 5e-4), (2e-3, 1e-3))),
        r"Shaft.profile_m is .* it must be convex, with a corner at every point",
    ),
    (
        lambda: Shaft(1e-3, 2e-3, profile_m=((0.0, 5e-4), (1e-3, 5e-4))),
        r"Shaft.profile_m .* it must end at length_m = 0.002 and be at most, .* = 0.001 wide",
    ),
    (
        lambda: Shaft(1e-3, 1e-3, Rounding(1e-5), profile_m=((0.0, 5e-4), (1e-3, 5e-4))),
        r"Shaft.profile_m holds both ends; leading and trailing must be None",
    ),
    (
        lambda: solve(PART, SHAFT, POSE, np.zeros(3), entered=[0.0]),
        r"entered is float64 of shape \(1,\); it must be bool of shape \(1,\)",
    ),
    (
        lambda: update_entered(PART, SHAFT, [POSE, POSE], [True]),
        r"entered is bool of shape \(1,\); it must be bool of shape \(2, 1\)",
    ),
    (lambda: update_entered(PART, SHAFT, [NAN] * 5, [True]), r"poses is nan at index \(0,\)"),
    (lambda: Part(()), r"Part.holes is \(\); it must be a tuple of at least one Hole"),
    (lambda: Part((Hole(1e-3, 1e-4, 1e-3),)), r"Part.holes\[0\].gap_m is 0.001; it must be 0"),
    (lambda: ContactLaw(stiffness_N_m=0.0), r"ContactLaw.stiffness_N_m is 0.0"),
    (lambda: ContactLaw(friction=-0.1), r"ContactLaw.friction is -0.1"),
    (
        lambda: solve(PART, SHAFT, [0.0, 0.0, NAN, 0.0, 0.0], np.zeros(3)),
        r"poses is nan at index \(2,\); every entry must be finite",
    ),
    (lambda: solve(PART, SHAFT, [POSE, [INF, *POSE[1:]]], np.zeros(3)), r"poses is inf at .*1, 0"),
    (
        lambda: solve(PART, SHAFT, [0.0] * 6, np.zeros(3)),
        r"poses has shape \(6,\); it must be \(..., 5\)",
    ),
    (lambda: solve(PART, SHAFT, 1.0, np.zeros(3)), r"poses has shape \(\)"),
    (
        lambda: solve(PART, SHAFT, [0.0, 0.0, 0.0, 0.0, 1.6], np.zeros(3)),
        r"poses hold a tilt of 1.6 rad; tilts must lie inside \(-pi/2, pi/2\)",
    ),
    (lambda: solve(PART, SHAFT, POSE, [0.0, NAN, 0.0]), r"sliding is nan at index \(1,\)"),
    (lambda: solve(PART, SHAFT, POSE, [0.0, 1.0]), r"sliding has shape \(2,\)"),
    (
        lambda: solve(PART, SHAFT, [POSE, POSE], np.zeros((3, 3))),
        r"sliding has shape \(3, 3\); it must be \(3,\) or, as the poses, \(2, 3\)",
    ),
    (lambda: shaft_axis([0.0, 0.0, 0.0, NAN, 0.0]), r"poses is nan at index \(3,\)"),
    (lambda: tilt_of([0.0, 1.0, 0.0]), r"axis has a z of 0.0; it must point into the hole"),
    (lambda: tilt_of([0.0, 1.0]), r"axis has shape \(2,\)"),
    (lambda: move_torque(np.zeros(5), np.zeros(3)), r"wrench has shape \(5,\)"),
    (lambda: move_torque(np.zeros(6), [0.0, INF, 0.0]), r"origin is inf at index \(1,\)"),
    (lambda: initial_poses(-1, 0.0, 0.0, 0.0, RNG), r"n is -1; it must be at least 0"),
    (lambda: initial_poses(1, -1.0, 0.0, 0.0, RNG), r"position_error_m is -1.0"),
    (lambda: initial_poses(1, 0.0, NAN, 0.0, RNG), r"tilt_error_rad is nan"),
    (lambda: initial_poses(1, 0.0, 1.6, 0.0, RNG), r"tilt_error_rad is 1.6; it must be below pi/2"),
    (lambda: initial_poses(1, 0.0, 0.0, INF, RNG), r"depth_m is inf; it must be finite"),
    (lambda: Trapezoid(-1.0, 0.0, 1.0, 1.0), r"distance_m is -1.0"),
    (lambda: Trapezoid(1.0, -1.0, 1.0, 1.0), r"start_speed_m_s is -1.0"),
    (lambda: Trapezoid(1.0, 0.0, 0.0, 1.0), r"speed_limit_m_s is 0.0"),
    (lambda: Trapezoid(1.0, 0.0, 1.0, INF), r"acceleration_m_s2 is inf"),
    (lambda: Trapezoid(1.0, 2.0, 1.0, 1.0), r"start_speed_m_s is 2.0, which takes 2.0 m to stop"),
    (lambda: braking(NAN, 1.0), r"start_speed_m_s is nan"),
    (lambda: Trapezoid(1.0, 0.0, 1.0, 1.0).at(-0.1), r"time_s is -0.1; it must be at least 0"),
    (lambda: Trapezoid(1.0, 0.0, 1.0, 1.0).at(NAN), r"time_s is nan; it must be at least 0"),
]


@pytest.mark.parametrize(("call", "message"), CASES, ids=[message for _, message in CASES])
def test_refused(call: Callable[[], object], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        call()
