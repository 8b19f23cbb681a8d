"""Files of trainings and of their plants, spoiled, and the line that follows."""

import re
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, get_args

import pytest
from pydantic import BaseModel

from drivers.contract.errors import ConfigurationError
from learning.analytic.plan import load_analytic
from learning.analytic.settings import AnalyticSettings
from tests.hil.config.cell_files import flow
from tests.learning.analytic import plans
from tests.learning.analytic.plans import FILE, PLANTS, Values

Refuse = Callable[[Values, Values], str]


@pytest.fixture
def refuse(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Refuse:
    """Returns the text with which files are refused."""
    monkeypatch.chdir(tmp_path)

    def refuse_files(training: Values, plants: Values) -> str:
        Path(FILE).write_text(flow(training), encoding="utf-8")
        Path(PLANTS).write_text(flow(plants), encoding="utf-8")
        with pytest.raises(ConfigurationError) as caught:
            load_analytic(Path(FILE))
        return str(caught.value)

    return refuse_files


def changed(values: Values, path: str, value: Any) -> Values:
    """The same with another value, or without the key for None."""
    *groups, key = path.split(".")
    group = values
    for name in groups:
        group = group.setdefault(name, {})
    if value is None:
        del group[key]
    else:
        group[key] = value
    return values


BOX = "trial.step_box_um = [20, 20, 60]"


@pytest.mark.parametrize(
    ("path", "value", "line"),
    [
        *(
            ("residual.range_um", range_um, f"range_um = {range_um} is not valid: must not exceed")
            for range_um in ([21, 10, 2], [10, 20.5, 2], [10, 10, 61])
        ),
        (
            "residual.range_um",
            [10, 10, 61],
            f"residual.range_um = [10, 10, 61] is not valid: must not exceed {BOX}",
        ),
        (
            "expert.axial_step_um",
            60.5,
            f"expert.axial_step_um = 60.5 is not valid: must not exceed z of {BOX}",
        ),
        (
            "expert.approach.step_um",
            58,
            "expert.approach.step_um = 58 is not valid: must not exceed expert.axial_step_um = "
            "57.6",
        ),
        (
            "residual.turn_deg",
            0.06,
            "residual.turn_deg = 0.06 is not valid: must not exceed trial.turn_deg = 0.05",
        ),
        (
            "residual.turn_deg",
            None,
            "inputs.turn_deg is no key where residual.turn_deg is missing: nothing turns",
        ),
        ("steps", 1001, "steps = 1001 is not valid: must not exceed trial.steps_max = 1000"),
        ("history", 0, "history = 0 is not valid: must be at least 1 and at most 64"),
        ("history", 65, "history = 65 is not valid: must be at least 1 and at most 64"),
        ("inputs.force_mN", [10, 10], "inputs.force_mN = [10, 10] is not valid: must be"),
        ("inputs.depth_um", None, "inputs.depth_um is missing: must be"),
        ("inputs.torque_mNm", [1, 1, 1], "inputs.torque_mNm is not a key: did you mean torque_uNm"),
        ("force_wieght", 1, "force_wieght is not a key: did you mean force_weight?"),
        ("expert.approach.depth_um", None, "expert.approach.depth_um is missing: must be"),
        ("gradient_norm_max", 0, "gradient_norm_max = 0 is not valid: must be greater than 0"),
        ("judged.seed", -1, "judged.seed = -1 is not valid: must be at least 0"),
        ("reward.alpha_x", 0.6, "reward.alpha_y = 0.3 is not valid: must be 0.4"),
    ],
)
def test_refused(path: str, value: Any, line: str, refuse: Refuse) -> None:
    text = refuse(changed(plans.values(), path, value), plans.plant_values())
    assert text.startswith(f"{FILE}: ")
    assert line in text
    assert len(text.splitlines()) == 1


def test_every_problem_has_its_line(refuse: Refuse) -> None:
    training = changed(plans.values(), "trial.step_box_um", [5, 20, 50])
    training = changed(training, "trial.turn_deg", 0.01)
    text = refuse(training, plans.plant_values())
    box = "trial.step_box_um = [5, 20, 50]"
    assert text.splitlines() == [
        f"{FILE}: residual.range_um = [10, 10, 2.4] is not valid: must not exceed {box}",
        f"{FILE}: expert.axial_step_um = 57.6 is not valid: must not exceed z of {box}",
        f"{FILE}: residual.turn_deg = 0.05 is not valid: must not exceed trial.turn_deg = 0.01",
    ]


def test_the_limits_themselves_are_valid(tmp_path: Path) -> None:
    training = changed(plans.values(), "residual.range_um", [20, 20, 60])
    training = changed(training, "expert.axial_step_um", 60)
    training = changed(training, "expert.approach.step_um", 60)
    plan = plans.plan(tmp_path, training, plans.plant_values())
    assert plan.expert.axial_step_m == pytest.approx(60e-6)


DRIFT = {
    "force_uN_rtHz": {"constant": 100},
    "torque_nNm_rtHz": {"constant": 500},
    "lowest_frequency_Hz": 0.001,
    "highest_frequency_Hz": 0.4,
}
EFFECTS: list[tuple[str, dict[str, Any]]] = [
    ("arm (drift or vibration)", {"arm.walk_um_rts": {"constant": 0.1}}),
    (
        "arm (drift or vibration)",
        {"arm.thermal": [{"end_um": {"constant": 1}, "time_constant_s": 600}]},
    ),
    (
        "arm (drift or vibration)",
        {"arm.vibration": [{"frequency_Hz": 12, "damping_ratio": 0.02, "rms_um": {"constant": 1}}]},
    ),
    (
        "force_sensor.crosstalk",
        {
            "force_sensor.crosstalk_percent": {"uniform": [-1, 1]},
            "force_sensor.force_range_mN": 5000,
            "force_sensor.torque_range_uNm": 50_000,
        },
    ),
    ("force_sensor.drift", {"force_sensor.drift": DRIFT}),
    ("force_sensor.latency", {"force_sensor.latency_ms": 2}),
    ("force_sensor.resolution", {"force_sensor.torque_resolution_uNm": 1}),
    ("stage.minimum_step", {"stage.minimum_step_um": {"constant": 0.1}}),
    ("stage.backlash", {"stage.backlash_um": {"constant": 0.5}}),
    ("stage.backlash", {"stage.backlash_deg": {"constant": 0.001}}),
    (
        "stage.hysteresis",
        {
            "stage.hysteresis_gap_um": {"constant": 0.4},
            "stage.hysteresis_weight": {"constant": 0.3},
        },
    ),
    ("stage.repeatability", {"stage.repeatability_um": {"constant": 0.2}}),
    ("holder", {"holder.compliance_x_um_mN": {"constant": 0.1}}),
    ("holder", {"holder.holding_force_z_mN": {"constant": 100}}),
]


@pytest.mark.parametrize(("name", "keys"), EFFECTS, ids=[next(iter(keys)) for _, keys in EFFECTS])
def test_an_effect_that_no_gradient_leads_through(
    name: str, keys: dict[str, Any], refuse: Refuse
) -> None:
    plants = plans.plant_values()
    for path, value in keys.items():
        changed(plants, path, value)
    assert refuse(plans.values(), plants) == (
        f"{PLANTS}: plants have {name}; the gradient leads through contact and alignment alone: "
        "leave them out"
    )


def test_effects_are_named_together(refuse: Refuse) -> None:
    plants = changed(plans.plant_values(), "stage.backlash_um", {"constant": 0.5})
    changed(plants, "force_sensor.latency_ms", 2)
    assert "have force_sensor.latency, stage.backlash; the" in refuse(plans.values(), plants)


def test_plants_that_cannot_be_used(refuse: Refuse) -> None:
    plants = changed(plans.plant_values(), "contact.stifness", 1)
    text = refuse(plans.values(), plants)
    assert text.startswith(f"{PLANTS}: contact.stifness is not a key: ")
    training = plans.values() | {"plants": "none.yaml"}
    assert refuse(training, plants) == "none.yaml: cannot be read: No such file or directory"


@pytest.mark.parametrize("name", ["extended", "nominal", "online"])
def test_shipped_plants_are_accepted(name: str, tmp_path: Path) -> None:
    plan = plans.plan(tmp_path, plans.values(), plans.plant_values(name))
    assert plan.plants.distribution().holes[1].gap_m is not None


def test_the_shipped_trainings() -> None:
    paper, extended = load_analytic(plans.PAPER), load_analytic(plans.EXTENDED)
    settings = paper.settings
    assert settings.force_weight == 0.0
    assert [name for name, _ in settings.inputs.inputs()] == [
        "force_x",
        "force_y",
        "force_z",
        "depth",
    ]
    assert [name for name, _ in settings.residual.outputs()] == ["step_x", "step_y", "step_z"]
    reward = settings.reward
    assert (reward.alpha_x, reward.alpha_y, reward.omega) == (0.7, 0.3, 2.0)
    assert paper.expert.gain_m_N == pytest.approx(160e-6)
    assert paper.expert.approach is None
    assert extended.expert.approach is not None
    assert len(extended.settings.inputs.inputs()) == 11
    assert len(extended.settings.residual.outputs()) == 5


ELSEWHERE = ("trial.", "reward.")
"""Groups whose keys another part of the reference explains."""


def keys_of(model: type[BaseModel], prefix: str = "") -> Iterator[str]:
    """Yield every key that is no group of keys."""
    for name, field in model.model_fields.items():
        path = f"{prefix}{field.alias or name}"
        options = get_args(field.annotation) or (field.annotation,)
        groups = [o for o in options if isinstance(o, type) and issubclass(o, BaseModel)]
        if groups:
            yield from keys_of(groups[0], f"{path}.")
        else:
            yield path


def test_the_reference_names_every_key_and_no_other() -> None:
    _, text = Path("docs/reference/training.md").read_text().split("## By the gradient")
    cells = re.findall(r"^\| (`.*?) \|", text, re.MULTILINE)
    named = {key for cell in cells for key in re.findall(r"`([\w.]+)`", cell)}
    keys = {key for key in keys_of(AnalyticSettings) if not key.startswith(ELSEWHERE)}
    last = {key.rpartition(".")[2]: key for key in keys}
    assert {last.get(name, name) for name in named} - {"trial", "reward"} == keys
