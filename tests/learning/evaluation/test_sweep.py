"""Sweeps: each value makes its plants, all else stays, and a bad file is refused by its key."""

from pathlib import Path

import numpy as np
import pytest
import yaml
from typer import Typer
from typer.testing import CliRunner

from drivers.contract.errors import ConfigurationError
from learning.evaluation.sweep import Sweep, load_sweep
from learning.generalise import generalise
from simulator.randomisation.distributions import Constant

SHIPPED = Path(__file__).parents[3] / "config" / "evaluation" / "generalisation.yaml"
STIFFNESS = {
    "keys": ["contact.stiffness_mN_um"],
    "label": "stiffness [mN/um]",
    "values": [1, 20],
    "expected": [2, 12],
}


def sweep_file(folder: Path, **changes: object) -> Path:
    values: dict[str, object] = {
        "comparison": str(SHIPPED.with_name("extended.yaml")),
        "controllers": ["expert"],
        "plants": 3,
        "push": {"stiffness": STIFFNESS},
    }
    path = folder / "sweep.yaml"
    path.write_text(yaml.safe_dump({**values, **changes}), encoding="utf-8")
    return path


def loaded(folder: Path, **changes: object) -> Sweep:
    return load_sweep(sweep_file(folder, **changes))


def test_each_value_changes_its_parameter_alone(tmp_path: Path) -> None:
    sweep = loaded(tmp_path)
    (push,) = sweep.pushes
    assert [d.stiffness_N_m for d in push.distributions] == [Constant(1e3), Constant(20e3)]
    base = sweep.evaluation.distribution
    for distribution in push.distributions:
        assert distribution.friction == base.friction
        assert distribution.holes == base.holes


def test_a_key_reaches_into_lists(tmp_path: Path) -> None:
    gap = {**STIFFNESS, "keys": ["holes.1.gap_um"], "values": [700]}
    (push,) = loaded(tmp_path, push={"gap": gap}).pushes
    first, second = push.distributions[0].holes
    assert second.gap_m.quantile(np.array([0.0, 0.9])) == pytest.approx([7e-4, 7e-4])
    assert first.gap_m == Constant(0.0)


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ({"controllers": ["nobody"]}, "controllers: 'nobody' is not valid: must be one of expert"),
        ({"push": {}}, "push is missing"),
        (
            {"push": {"s": {**STIFFNESS, "keys": ["holes.7.gap_um"]}}},
            "push.s.keys: 'holes.7.gap_um' is no place in the plants' file",
        ),
        ({"push": {"s": {**STIFFNESS, "values": [-1]}}}, "push.s"),
        ({"push": {"s": {**STIFFNESS, "keys": ["contact.colour"]}}}, "contact.colour"),
        (
            {"push": {"s": {**STIFFNESS, "keys": ["force_sensor.latency_ms"], "values": [2]}}},
            "latency",
        ),
        ({"plants": 0}, "plants = 0"),
    ],
)
def test_bad_files_are_refused(tmp_path: Path, changes: dict[str, object], says: str) -> None:
    with pytest.raises(ConfigurationError) as caught:
        loaded(tmp_path, **changes)
    assert says in str(caught.value)


def test_the_shipped_sweep_loads() -> None:
    sweep = load_sweep(SHIPPED)
    assert {"stiffness", "clearance", "tilt", "step_error"} <= {push.name for push in sweep.pushes}


def test_the_command_writes_a_row_per_value_and_controller(tmp_path: Path) -> None:
    app = Typer()
    app.command()(generalise)
    out = tmp_path / "out"
    arguments = ["--config", str(sweep_file(tmp_path)), "--out", str(out), "--processes", "1"]
    ran = CliRunner().invoke(app, arguments)
    assert ran.exit_code == 0, ran.output
    head, *rows = (out / "sweep.csv").read_text(encoding="utf-8").splitlines()
    assert head.startswith("parameter,value,controller,insertions,success,")
    assert [row.split(",")[:4] for row in rows] == [
        ["stiffness", "1", "expert", "3"],
        ["stiffness", "20", "expert", "3"],
    ]
    soft, hard = (float(row.split(",")[7]) for row in rows)
    assert 0.0 < soft < hard
    assert (out / "sweep.svg").read_text(encoding="utf-8").count("stiffness [mN/um]") >= 1


def test_an_unusable_file_ends_with_2(tmp_path: Path) -> None:
    app = Typer()
    app.command()(generalise)
    ran = CliRunner().invoke(app, ["--config", str(tmp_path / "no.yaml"), "--out", str(tmp_path)])
    assert ran.exit_code == 2
    assert "no.yaml: cannot be read" in ran.output
