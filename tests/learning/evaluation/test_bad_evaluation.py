"""Files of comparisons that cannot be used, and the line that follows before anything runs."""

from pathlib import Path

import pytest

from drivers.contract.errors import ConfigurationError
from learning.evaluation.load import load_evaluation
from tests.learning.evaluation.records import FILE, ROOT

EXTENDED = f"{ROOT}/config/randomisation/extended.yaml"


def test_the_file_of_these_tests_is_good(tmp_path: Path) -> None:
    path = tmp_path / "small.yaml"
    path.write_text(FILE, encoding="utf-8")
    evaluation = load_evaluation(path)
    assert [*evaluation.entries] == [
        "mild",
        "tuned",
        "admittance",
        "look_ahead",
        "skill",
        "privileged",
        "bound",
    ]
    assert len(evaluation.plants()) == 4
    assert len(load_evaluation(path, count=7, seed=9).plants()) == 7


@pytest.mark.parametrize("name", ["paper_simulation", "paper_online", "extended"])
def test_shipped_files_are_good(name: str) -> None:
    load_evaluation(ROOT / f"config/evaluation/{name}.yaml", count=1)


@pytest.mark.parametrize(
    ("good", "bad", "line"),
    [
        (
            "count: 4",
            "count: 0",
            "plants.count = 0 is not valid: must be at least 1 and at most 1000000",
        ),
        ("seed: 1}", "seed: -1}", "plants.seed = -1 is not valid: must be at least 0"),
        (
            EXTENDED,
            "none.yaml",
            "plants.file = 'none.yaml' is not valid: {folder}/none.yaml: cannot be read: "
            "No such file or directory",
        ),
        (
            "count: 2, seed: 2",
            "count: 2, seed: 1",
            "tuning.seed = 1 is not valid: must differ from plants.seed, or controllers are judged "
            "on the plants that they were tuned on",
        ),
        (
            "turn_deg: 0.05\n  force",
            "turn_rad: 0.001\n  force",
            "trial.turn_rad is not a key: did you mean turn_deg? Its unit is deg",
        ),
        (
            "step_time_ms: 100",
            "step_time_ms: 0",
            "trial.step_time_ms = 0 is not valid: must be greater than 0 and at most 60000",
        ),
        (
            "samples: 100",
            "samples: 10",
            "bootstrap.samples = 10 is not valid: must be at least 100 and at most 1000000",
        ),
        (
            "compared: [mild, privileged]",
            "compared: [mild, wild]",
            "figures.compared names 'wild', which is no controller: must be two of mild, tuned, "
            "admittance, look_ahead, skill, privileged, bound",
        ),
        (
            "compared: [mild, privileged]",
            "compared: mild",
            "figures.compared = 'mild' is not valid: must be a list of 2 texts",
        ),
        (
            "kind: tuned",
            "kind: tunned",
            "controllers.tuned.kind = 'tunned' is not valid: must be one of proportional, tuned, "
            "admittance, skill, look_ahead, privileged",
        ),
        (
            "bound: {kind: privileged, tilt: true}",
            "bound: {tilt: true}",
            "controllers.bound.kind is missing: must be one of proportional, tuned, admittance, "
            "skill, look_ahead, privileged",
        ),
        (
            "bound: {kind: privileged, tilt: true}",
            "bound: privileged",
            "controllers.bound is not valid: must be a group of keys, kind among them",
        ),
        (
            "gain_um_N: [20, 80]",
            "gain_um_N: [80, 20]",
            "controllers.tuned.gain_um_N = [80, 20] is not valid: must be a low and a high end, "
            "low less than high",
        ),
        (
            "lambda: 0.05",
            "lambda: 0",
            "controllers.mild.lambda = 0 is not valid: must be greater than 0 and at most 1",
        ),
        (
            "axial_step_um: [2.5, 60]",
            "axial_step_um: [2.5, 61]",
            "controllers.look_ahead.axial_step_um = [2.5, 61] is not valid: must not exceed "
            "trial.step_box_um = [20, 20, 60]",
        ),
        (
            "turn_deg: 0.05\n    force_budget",
            "turn_deg: 0.06\n    force_budget",
            "controllers.look_ahead.turn_deg = 0.06 is not valid: must not exceed "
            "trial.turn_deg = 0.05",
        ),
        (
            f"policy: {ROOT}/policies/paper.safetensors",
            "policy: none.safetensors",
            "controllers.skill.policy = 'none.safetensors' is not valid: "
            "{folder}/none.safetensors: cannot be read: No such file or directory",
        ),
    ],
)
def test_bad_files(tmp_path: Path, good: str, bad: str, line: str) -> None:
    assert FILE.count(good) == 1, "the test spoils another place as well"
    path = tmp_path / "bad.yaml"
    path.write_text(FILE.replace(good, bad), encoding="utf-8")
    with pytest.raises(ConfigurationError) as caught:
        load_evaluation(path)
    assert str(caught.value) == f"{path}: {line.replace('{folder}', str(tmp_path))}"


def test_a_policy_that_reads_torques_of_another_sensor(tmp_path: Path) -> None:
    path, extended = tmp_path / "evaluation.yaml", f"{ROOT}/policies/extended.safetensors"
    same = FILE.replace(f"{ROOT}/policies/paper.safetensors", extended)
    path.write_text(same, encoding="utf-8")
    assert "skill" in load_evaluation(path).entries
    path.write_text(same.replace("sensor_um: [0, 0, 40000]", "sensor_um: [0, 0, 39800]"))
    with pytest.raises(ConfigurationError) as caught:
        load_evaluation(path)
    assert str(caught.value) == (
        f"{path}: controllers.skill.policy is not valid: it reads torques about [0, 0, 40000] um, "
        "the sensor's are about [0, 0, 39800] um; it must be trained with the place of this sensor"
    )


def test_several_problems_are_told_at_once(tmp_path: Path) -> None:
    path = tmp_path / "bad.yaml"
    text = FILE.replace("steps_max: 1000", "steps_max: 0").replace("kind: tuned", "kind: x")
    path.write_text(text, encoding="utf-8")
    with pytest.raises(ConfigurationError) as caught:
        load_evaluation(path)
    assert len(str(caught.value).splitlines()) == 2


def test_no_controllers(tmp_path: Path) -> None:
    path = tmp_path / "bad.yaml"
    path.write_text(FILE[: FILE.index("controllers:")], encoding="utf-8")
    with pytest.raises(ConfigurationError, match="controllers is missing"):
        load_evaluation(path)


def test_plants_with_what_a_trial_has_not(tmp_path: Path) -> None:
    plants = tmp_path / "drifting.yaml"
    text = Path(EXTENDED).read_text(encoding="utf-8")
    plants.write_text(f"{text}\narm:\n  walk_um_rts: {{constant: 1}}\n", encoding="utf-8")
    path = tmp_path / "bad.yaml"
    path.write_text(FILE.replace(EXTENDED, str(plants)), encoding="utf-8")
    with pytest.raises(ConfigurationError, match=r"plants.file = .* have arm \(drift or vibration"):
        load_evaluation(path)
