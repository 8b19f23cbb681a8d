"""Every key of every configuration file, with what it accepts, stated once more by hand."""

from typing import NamedTuple

LIMITS = "config/limits.yaml"
PART = "config/parts/paper_online.yaml"
CELL = "config/mock_cell.yaml"

NUMBER = "a number"
WHOLE = "a whole number"
TWO = "a list of 2 numbers"
THREE = "a list of 3 numbers"
SIX = "a list of 6 numbers"
LISTS = (TWO, THREE, SIX)

KINDS = "proportional or skill or look_ahead"


class Key(NamedTuple):
    """A key with a value; `low` and `high` lie just outside of its range."""

    file: str
    path: str
    kind: str
    range: str = ""
    low: float | str | None = None
    high: float | str | None = None
    unit: str = ""

    @property
    def valid(self) -> str:
        separator = ", each " if self.kind in LISTS and self.range else " "
        return f"{self.kind}{separator}{self.range}".rstrip()


class Group(NamedTuple):
    """A key that holds other keys or a list of them."""

    file: str
    path: str
    valid: str


KEYS = (
    Key(LIMITS, "speed_limit_mm_s", NUMBER, "at least 0.01 and at most 5", 0, 5.001, "mm/s"),
    Key(LIMITS, "angular_speed_limit_deg_s", NUMBER, "at least 0.001 and at most 5", 0, 6, "deg/s"),
    Key(LIMITS, "arm_speed_limit_mm_s", NUMBER, "at least 0.1 and at most 250", 0, 251, "mm/s"),
    Key(LIMITS, "step_box_um", THREE, "greater than 0 and at most 1000", 0, 1001, "um"),
    Key(LIMITS, "rotation_step_limit_deg", NUMBER, "greater than 0 and at most 1", -1, 1.1, "deg"),
    Key(LIMITS, "workspace_min_um", THREE, "at least -100000 and at most 100000", -1e6, 1e6, "um"),
    Key(LIMITS, "workspace_max_um", THREE, "at least -100000 and at most 100000", -1e6, 1e6, "um"),
    Key(LIMITS, "tilt_limit_deg", NUMBER, "greater than 0 and at most 5", 0.0, 5.1, "deg"),
    Key(LIMITS, "clear_depth_um", NUMBER, "at least -100000 and at most -20", -1e6, -19.9, "um"),
    Key(LIMITS, "arm_tolerance_um", NUMBER, "greater than 0 and at most 1000", -5, 1001, "um"),
    Key(LIMITS, "force_limit_mN", THREE, "greater than 0 and at most 10000", 0, 10001, "mN"),
    Key(LIMITS, "force_rate_limit_N_s", NUMBER, "greater than 0 and at most 1000", 0, 1001, "N/s"),
    Key(LIMITS, "gentle_force_mN", NUMBER, "greater than 0 and at most 10000", 0, 10001, "mN"),
    Key(LIMITS, "impulse_limit_mN_s", NUMBER, "greater than 0 and at most 1000", 0, 1001, "mN s"),
    Key(LIMITS, "sample_age_limit_ms", NUMBER, "greater than 0 and at most 1000", 0, 1001, "ms"),
    Key(LIMITS, "device_age_limit_ms", NUMBER, "greater than 0 and at most 1000", 0, 1001, "ms"),
    Key(LIMITS, "proposal_age_limit_ms", NUMBER, "greater than 0 and at most 1000", 0, 1001, "ms"),
    Key(LIMITS, "heartbeat_limit_ms", NUMBER, "greater than 0 and at most 1000", 0, 1001, "ms"),
    Key(LIMITS, "reaction_time_ms", NUMBER, "at least 0.1 and at most 1000", 0.09, 1001, "ms"),
    Key(LIMITS, "deceleration_mm_s2", NUMBER, "at least 1 and at most 100000", 0.9, 1e6, "mm/s2"),
    Key(
        LIMITS,
        "radial_stiffness_mN_um",
        NUMBER,
        "at least 0.1 and at most 10000",
        0.09,
        1e5,
        "mN/um",
    ),
    Key(
        LIMITS,
        "axial_stiffness_mN_um",
        NUMBER,
        "at least 0.1 and at most 10000",
        0.09,
        1e5,
        "mN/um",
    ),
    Key(LIMITS, "lever_um", NUMBER, "at least 100 and at most 1000000", 99, 1e7, "um"),
    Key(LIMITS, "creep_speed_mm_s", NUMBER, "at least 0.001 and at most 0.5", 0, 0.51, "mm/s"),
    Key(LIMITS, "uncertainty_sigmas", NUMBER, "at least 0 and at most 10", -0.1, 10.1),
    Key(PART, "name", "text", "of 1 to 80 characters", "", "n" * 81),
    Key(PART, "shaft.diameter_um", NUMBER, "greater than 0 and at most 100000", 0, 1e6, "um"),
    Key(PART, "shaft.length_um", NUMBER, "greater than 0 and at most 100000", 0, 1e6, "um"),
    Key(PART, "holes[1].diameter_um", NUMBER, "greater than 0 and at most 100000", 0, 1e6, "um"),
    Key(PART, "holes[1].thickness_um", NUMBER, "greater than 0 and at most 100000", 0, 1e6, "um"),
    Key(PART, "holes[1].gap_um", NUMBER, "at least 0 and at most 100000", -1, 1e6, "um"),
    Key(
        PART, "contact.stiffness_mN_um", NUMBER, "greater than 0 and at most 1000", 0, 1e4, "mN/um"
    ),
    Key(PART, "contact.friction", NUMBER, "at least 0 and at most 2", -0.1, 2.1),
    Key(PART, "alignment.position_error_um", NUMBER, "at least 0 and at most 1000", -1, 1001, "um"),
    Key(PART, "alignment.tilt_error_deg", NUMBER, "at least 0 and at most 5", -0.1, 5.1, "deg"),
    Key(PART, "insertion.stroke_um", NUMBER, "greater than 0 and at most 100000", 0, 1e6, "um"),
    Key(PART, "insertion.steps_max", WHOLE, "at least 1 and at most 100000", 0, 100_001),
    Key(
        PART, "insertion.finish_force_mN", NUMBER, "greater than 0 and at most 10000", 0, 1e5, "mN"
    ),
    Key(PART, "insertion.axial_step_um", NUMBER, "greater than 0 and at most 1000", 0, 1001, "um"),
    Key(PART, "limits.speed_limit_mm_s", NUMBER, "at least 0.01", 0, None, "mm/s"),
    Key(PART, "limits.angular_speed_limit_deg_s", NUMBER, "at least 0.001", 0, None, "deg/s"),
    Key(PART, "limits.step_box_um", THREE, "greater than 0", 0, None, "um"),
    Key(PART, "limits.force_limit_mN", THREE, "greater than 0", 0, None, "mN"),
    Key(PART, "limits.force_rate_limit_N_s", NUMBER, "greater than 0", 0, None, "N/s"),
    Key(PART, "limits.gentle_force_mN", NUMBER, "greater than 0", 0, None, "mN"),
    Key(PART, "limits.impulse_limit_mN_s", NUMBER, "greater than 0", 0, None, "mN s"),
    Key(CELL, "limits", "text", "of 1 to 1000 characters", "", "n" * 1001),
    Key(CELL, "part", "text", "of 1 to 1000 characters", "", "n" * 1001),
    Key(CELL, "force_sensor.backend", "text"),
    Key(CELL, "force_sensor.rate_Hz", NUMBER, "at least 10 and at most 20000", 9, 20_001, "Hz"),
    Key(
        CELL,
        "force_sensor.force_noise_uN_rtHz",
        NUMBER,
        "greater than 0 and at most 100000",
        0,
        1e6,
        "uN/sqrt(Hz)",
    ),
    Key(
        CELL,
        "force_sensor.torque_noise_nNm_rtHz",
        NUMBER,
        "greater than 0 and at most 10000000",
        0,
        1e8,
        "nN m/sqrt(Hz)",
    ),
    Key(CELL, "force_sensor.bias_mN", THREE, "at least -10000 and at most 10000", -1e5, 1e5, "mN"),
    Key(
        CELL,
        "force_sensor.force_resolution_mN",
        NUMBER,
        "greater than 0 and at most 1000",
        0,
        1e4,
        "mN",
    ),
    Key(
        CELL,
        "force_sensor.torque_resolution_uNm",
        NUMBER,
        "greater than 0 and at most 100000",
        0,
        1e6,
        "uN m",
    ),
    Key(
        CELL,
        "force_sensor.force_range_mN",
        NUMBER,
        "greater than 0 and at most 1000000",
        0,
        1e7,
        "mN",
    ),
    Key(
        CELL,
        "force_sensor.torque_range_uNm",
        NUMBER,
        "greater than 0 and at most 100000000",
        0,
        1e9,
        "uN m",
    ),
    Key(
        CELL,
        "force_sensor.origin_um",
        THREE,
        "at least -1000000 and at most 1000000",
        -1e7,
        1e7,
        "um",
    ),
    Key(CELL, "force_sensor.latency_ms", NUMBER, "at least 0 and at most 100", -1, 101, "ms"),
    Key(
        CELL,
        "force_sensor.drift.force_uN_rtHz",
        NUMBER,
        "at least 0 and at most 100000",
        -1,
        1e6,
        "uN/sqrt(Hz)",
    ),
    Key(
        CELL,
        "force_sensor.drift.torque_nNm_rtHz",
        NUMBER,
        "at least 0 and at most 10000000",
        -1,
        1e8,
        "nN m/sqrt(Hz)",
    ),
    Key(
        CELL,
        "force_sensor.drift.lowest_frequency_Hz",
        NUMBER,
        "at least 1e-06 and at most 100",
        0,
        101,
        "Hz",
    ),
    Key(
        CELL,
        "force_sensor.drift.highest_frequency_Hz",
        NUMBER,
        "at least 1e-06 and at most 1000",
        0,
        1001,
        "Hz",
    ),
    *(
        Key(
            CELL,
            f"force_sensor.crosstalk.{axis}_percent",
            SIX,
            "at least -20 and at most 20",
            -21,
            21,
            "%",
        )
        for axis in ("fx", "fy", "fz", "tx", "ty", "tz")
    ),
    Key(CELL, "stage.backend", "text"),
    Key(CELL, "stage.speed_limit_mm_s", NUMBER, "at least 0.01 and at most 5", 0, 5.1, "mm/s"),
    Key(
        CELL,
        "stage.angular_speed_limit_deg_s",
        NUMBER,
        "at least 0.001 and at most 5",
        0,
        6,
        "deg/s",
    ),
    Key(
        CELL,
        "stage.acceleration_mm_s2",
        NUMBER,
        "greater than 0 and at most 100000",
        0,
        1e6,
        "mm/s2",
    ),
    Key(CELL, "stage.telemetry_rate_Hz", NUMBER, "at least 1 and at most 10000", 0.9, 1e5, "Hz"),
    Key(CELL, "stage.travel_um", THREE, "greater than 0 and at most 100000", 0, 1e6, "um"),
    *(
        Key(CELL, f"stage.{name}_{end}", NUMBER, valid, -1, high, end)
        for name in ("minimum_step", "backlash", "hysteresis_gap", "repeatability")
        for end, valid, high in (
            ("um", "at least 0 and at most 1000", 1001),
            ("deg", "at least 0 and at most 1", 1.1),
        )
    ),
    Key(CELL, "stage.hysteresis_weight", NUMBER, "at least 0 and at most 1", -0.1, 1.1),
    Key(
        CELL,
        "stage.settling_time_constant_ms",
        NUMBER,
        "at least 0 and at most 1000",
        -1,
        1001,
        "ms",
    ),
    Key(CELL, "arm.walk_um_rts", NUMBER, "at least 0 and at most 1000", -1, 1001, "um/sqrt(s)"),
    Key(CELL, "arm.walk_deg_rts", NUMBER, "at least 0 and at most 1", -1, 1.1, "deg/sqrt(s)"),
    *(
        Key(CELL, f"arm.{name}_{end}", THREE, valid, -high, high, end)
        for name in ("thermal[1].end", "vibration[1].rms")
        for end, valid, high in (
            ("um", "at least -1000 and at most 1000", 1001),
            ("deg", "at least -1 and at most 1", 1.1),
        )
    ),
    Key(
        CELL,
        "arm.thermal[1].time_constant_s",
        NUMBER,
        "greater than 0 and at most 100000",
        0,
        1e6,
        "s",
    ),
    Key(
        CELL,
        "arm.vibration[1].frequency_Hz",
        NUMBER,
        "greater than 0 and at most 100",
        0,
        101,
        "Hz",
    ),
    Key(CELL, "arm.vibration[1].damping_ratio", NUMBER, "greater than 0 and less than 1", 0, 1),
    Key(CELL, "arm.backend", "text"),
    Key(CELL, "arm.telemetry_rate_Hz", NUMBER, "at least 1 and at most 10000", 0.9, 1e5, "Hz"),
    Key(
        CELL, "arm.acceleration_mm_s2", NUMBER, "greater than 0 and at most 10000", 0, 1e5, "mm/s2"
    ),
    Key(CELL, "gripper.backend", "text"),
    Key(CELL, "gripper.telemetry_rate_Hz", NUMBER, "at least 1 and at most 10000", 0.9, 1e5, "Hz"),
    Key(CELL, "gripper.vacuum_rise_ms", NUMBER, "greater than 0 and at most 10000", 0, 1e5, "ms"),
    Key(
        CELL, "arm_poses.hold_um", THREE, "at least -10000000 and at most 10000000", -1e8, 1e8, "um"
    ),
    Key(
        CELL, "arm_poses.tray_um", THREE, "at least -10000000 and at most 10000000", -1e8, 1e8, "um"
    ),
    Key(
        CELL,
        "filter.force_acceleration_std_N_s2",
        NUMBER,
        "greater than 0 and at most 1000000",
        0,
        1e7,
        "N/s2",
    ),
    Key(
        CELL,
        "filter.torque_acceleration_std_Nm_s2",
        NUMBER,
        "greater than 0 and at most 1000000",
        0,
        1e7,
        "N m/s2",
    ),
    Key(CELL, "filter.gate_probability", NUMBER, "greater than 0.5 and less than 1", 0.5, 1),
    Key(CELL, "filter.rejections_max", WHOLE, "at least 0 and at most 20", -1, 21),
    Key(CELL, "filter.tare_samples", WHOLE, "at least 10 and at most 100000", 9, 100_001),
    Key(CELL, "filter.bias_change_max_mN", NUMBER, "greater than 0 and at most 1000", 0, 1e4, "mN"),
    Key(CELL, "skill.start_depth_um", NUMBER, "at least -100000 and less than 0", -1e6, 0, "um"),
    Key(CELL, "skill.settle_time_ms", NUMBER, "at least 0 and at most 10000", -1, 1e5, "ms"),
    Key(CELL, "skill.hold_timeout_ms", NUMBER, "greater than 0 and at most 60000", 0, 1e5, "ms"),
    Key(CELL, "skill.contact_force_mN", NUMBER, "greater than 0 and at most 1000", 0, 1e4, "mN"),
    Key(CELL, "controllers.expert.kind", KINDS),
    Key(
        CELL,
        "controllers.expert.force_jacobian_um_N",
        NUMBER,
        "greater than 0 and at most 100000",
        0,
        1e6,
        "um/N",
    ),
    Key(CELL, "controllers.expert.lambda", NUMBER, "greater than 0 and at most 1", 0, 1.1),
    Key(CELL, "controllers.look_ahead.kind", KINDS),
    Key(
        CELL,
        "controllers.look_ahead.stiffness_mN_um",
        TWO,
        "greater than 0 and at most 1000",
        0,
        1001,
        "mN/um",
    ),
    Key(
        CELL,
        "controllers.look_ahead.clearance_um",
        TWO,
        "at least -1000 and at most 1000",
        -1001,
        1001,
        "um",
    ),
    Key(CELL, "controllers.look_ahead.friction", TWO, "at least 0 and at most 2", -0.1, 2.1),
    Key(
        CELL,
        "controllers.look_ahead.place_std_um",
        NUMBER,
        "at least 0 and at most 1000",
        -1,
        1001,
        "um",
    ),
    Key(
        CELL,
        "controllers.look_ahead.report_std_um",
        NUMBER,
        "at least 0 and at most 1000",
        -1,
        1001,
        "um",
    ),
    Key(
        CELL,
        "controllers.look_ahead.step_std_um",
        NUMBER,
        "at least 0 and at most 1000",
        -1,
        1001,
        "um",
    ),
    Key(
        CELL,
        "controllers.look_ahead.model_error_percent",
        NUMBER,
        "at least 0 and at most 100",
        -1,
        101,
        "%",
    ),
    Key(
        CELL,
        "controllers.look_ahead.axial_step_um",
        TWO,
        "greater than 0 and at most 1000",
        0,
        1001,
        "um",
    ),
    Key(
        CELL,
        "controllers.look_ahead.force_budget_mN",
        NUMBER,
        "greater than 0 and at most 1000",
        0,
        1001,
        "mN",
    ),
    Key(
        CELL, "controllers.look_ahead.quantile", NUMBER, "greater than 0.5 and less than 1", 0.5, 1
    ),
    Key(CELL, "controllers.look_ahead.hypotheses", WHOLE, "at least 64 and at most 4096", 63, 4097),
    Key(CELL, "controllers.look_ahead.moves", WHOLE, "at least 1 and at most 20", 0, 21),
    Key(CELL, "controllers.look_ahead.samples", WHOLE, "at least 16 and at most 512", 15, 513),
    Key(CELL, "controllers.skill.kind", KINDS),
    Key(CELL, "controllers.skill.policy", "text", "of 1 to 1000 characters", "", "n" * 1001),
)

GROUPS = (
    Group(PART, "shaft", "a group of keys: diameter_um, length_um"),
    Group(PART, "holes", "a list with at least one entry"),
    Group(PART, "holes[1]", "a group of keys: diameter_um, thickness_um, gap_um"),
    Group(PART, "contact", "a group of keys: stiffness_mN_um, friction"),
    Group(PART, "alignment", "a group of keys: position_error_um, tilt_error_deg"),
    Group(
        PART,
        "insertion",
        "a group of keys: stroke_um, steps_max, finish_force_mN, axial_step_um",
    ),
    Group(
        PART,
        "limits",
        "a group of keys: speed_limit_mm_s, angular_speed_limit_deg_s, step_box_um, "
        "force_limit_mN, force_rate_limit_N_s, gentle_force_mN, impulse_limit_mN_s",
    ),
    Group(CELL, "force_sensor", "a group of keys: backend"),
    Group(
        CELL,
        "force_sensor.drift",
        "a group of keys: lowest_frequency_Hz, highest_frequency_Hz, force_uN_rtHz, "
        "torque_nNm_rtHz",
    ),
    Group(
        CELL,
        "force_sensor.crosstalk",
        "a group of keys: fx_percent, fy_percent, fz_percent, tx_percent, ty_percent, tz_percent",
    ),
    Group(CELL, "arm.thermal", "a list"),
    Group(CELL, "arm.thermal[1]", "a group of keys: end_um, end_deg, time_constant_s"),
    Group(CELL, "arm.vibration", "a list"),
    Group(
        CELL,
        "arm.vibration[1]",
        "a group of keys: frequency_Hz, damping_ratio, rms_um, rms_deg",
    ),
    Group(CELL, "stage", "a group of keys: backend"),
    Group(CELL, "arm", "a group of keys: backend"),
    Group(CELL, "gripper", "a group of keys: backend"),
    Group(CELL, "arm_poses", "a group of keys: hold_um, tray_um"),
    Group(
        CELL,
        "filter",
        "a group of keys: force_acceleration_std_N_s2, torque_acceleration_std_Nm_s2, "
        "gate_probability, rejections_max, tare_samples, bias_change_max_mN",
    ),
    Group(
        CELL,
        "skill",
        "a group of keys: start_depth_um, settle_time_ms, hold_timeout_ms, contact_force_mN",
    ),
    Group(CELL, "controllers", "a mapping of names to groups of keys"),
    Group(CELL, "controllers.expert", "a group of keys: kind"),
    Group(CELL, "controllers.look_ahead", "a group of keys: kind"),
    Group(CELL, "controllers.skill", "a group of keys: kind"),
)

OPTIONAL = {
    (PART, "limits"),
    *((key.file, key.path) for key in KEYS if key.path.startswith("limits.")),
    (CELL, "force_sensor.latency_ms"),
    (CELL, "force_sensor.drift"),
    (CELL, "force_sensor.crosstalk"),
    *((CELL, key.path) for key in KEYS if key.path.startswith("stage.") and key.low == -1),
    (CELL, "stage.hysteresis_weight"),
    (CELL, "arm.walk_um_rts"),
    (CELL, "arm.walk_deg_rts"),
    (CELL, "arm.thermal"),
    (CELL, "arm.vibration"),
    (CELL, "arm.thermal[1].end_deg"),
    (CELL, "arm.vibration[1].rms_deg"),
}
"""Keys that may be left out."""


CHOSEN = ("controllers.expert", "controllers.look_ahead", "controllers.skill")
"""One controller of each kind; their names are people's choice."""


def is_named(row: Key | Group) -> bool:
    """Whether the key's name is given, not a place in a list or a name that people choose."""
    return not row.path.endswith("]") and row.path not in CHOSEN
