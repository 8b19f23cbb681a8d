"""Every key of a training's file, spoiled, and the exact line that follows."""

import copy
import re
from collections.abc import Callable, Iterator
from pathlib import Path
from types import UnionType
from typing import Any, NamedTuple, get_args

import pytest
from pydantic import BaseModel

from drivers.contract.errors import ConfigurationError
from learning.settings import AdditionSettings, TrainingSettings
from learning.training.plan import load_plan
from tests.hil.config.cell_files import ROOT, flow
from tests.learning.training.plans import values

FILE = "training.yaml"


class Key(NamedTuple):
    """A key with a number; `low` and `high` lie just outside of its range."""

    path: str
    range: str
    low: float
    high: float
    unit: str = ""
    kind: str = "a number"


LENGTH = "greater than 0 and at most 1000"
SIGMA = "at least 0 and at most 1"
RATE = "greater than 0 and at most 1"
WHOLE, THREE = "a whole number", "a list of 3 numbers"
MILLION, STATES = "at least 1 and at most 1000000", "at least 1 and at most 100000"
KEYS = (
    Key("task.step_box_um", LENGTH, 0.0, 1001.0, "um", THREE),
    Key("task.force_limit_mN", "greater than 0 and at most 10000", 0.0, 10001.0, "mN", THREE),
    Key("task.start_depth_um", "at least -1000 and at most 0", -1001.0, 0.1, "um"),
    Key("task.state_sigma", SIGMA, -0.1, 1.1),
    Key("task.reward.alpha_x", SIGMA, -0.1, 1.1),
    Key("task.reward.alpha_y", SIGMA, -0.1, 1.1),
    Key("task.reward.omega", "greater than 1 and at most 100", 1.0, 101.0),
    Key("expert.lambda", RATE, 0.0, 1.1),
    Key("expert.force_jacobian_um_N", "greater than 0 and at most 100000", 0.0, 100_001.0, "um/N"),
    Key("residual.range_um", LENGTH, 0.0, 1001.0, "um", THREE),
    Key("rounds", MILLION, 0, 1_000_001, kind=WHOLE),
    Key("initial_states", STATES, 0, 100_001, kind=WHOLE),
    Key("exploration.sigma_first", SIGMA, -0.1, 1.1),
    Key("exploration.sigma_success", SIGMA, -0.1, 1.1),
    Key("exploration.sigma_failure", SIGMA, -0.1, 1.1),
    Key("ddpg.replay_size", "at least 1 and at most 10000000", 0, 10_000_001, kind=WHOLE),
    Key("ddpg.batch_size", MILLION, 0, 1_000_001, kind=WHOLE),
    Key("ddpg.discount", "at least 0 and less than 1", -0.1, 1.0),
    Key("ddpg.target_rate", RATE, 0.0, 1.1),
    Key("ddpg.target_period", MILLION, 0, 1_000_001, kind=WHOLE),
    Key("ddpg.actor.learning_rate", RATE, 0.0, 1.1),
    Key("ddpg.critic.learning_rate", RATE, 0.0, 1.1),
    Key("ddpg.actor_last_weight", SIGMA, -0.1, 1.1),
    Key("ddpg.additions.return_steps", "at least 1 and at most 1000", 0, 1001, kind=WHOLE),
    Key("ddpg.additions.target_noise", SIGMA, -0.1, 1.1),
    Key("ddpg.additions.actor_period", MILLION, 0, 1_000_001, kind=WHOLE),
    Key("evaluation.initial_states", STATES, 0, 100_001, kind=WHOLE),
    Key("checkpoint_rounds", MILLION, 0, 1_000_001, kind=WHOLE),
)
OTHERS = (
    "part",
    "expert.kind",
    "ddpg.terminal_mask",
    "ddpg.actor.hidden",
    "ddpg.critic.hidden",
    "ddpg.additions.twin_critics",
    "ddpg.additions.critic_norm",
)
GROUPS = (
    "task",
    "task.reward",
    "expert",
    "residual",
    "exploration",
    "ddpg",
    "ddpg.actor",
    "ddpg.critic",
    "evaluation",
)
MAY_BE_LEFT_OUT = "ddpg.additions"
Refuse = Callable[[dict[str, Any]], str]


@pytest.fixture
def refuse(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Refuse:
    """Returns the text with which a file is refused."""
    monkeypatch.chdir(tmp_path)

    def refuse_file(file: dict[str, Any]) -> str:
        Path(FILE).write_text(flow(file), encoding="utf-8")
        with pytest.raises(ConfigurationError) as caught:
            load_plan(Path(FILE))
        return str(caught.value)

    return refuse_file


FULL = values()
"""The shipped file with the group that it leaves out."""
FULL["ddpg"]["additions"] = {
    "twin_critics": True,
    "critic_norm": "layer",
    "return_steps": 3,
    "target_noise": 0.2,
    "actor_period": 2,
}


def spoiled(path: str, value: object) -> dict[str, Any]:
    """The full file with another value, or without the key for None."""
    file = copy.deepcopy(FULL)
    *groups, key = path.split(".")
    group = file
    for name in groups:
        group = group[name]
    if value is None:
        del group[key]
    else:
        group[key] = value
    return file


def each(rows: tuple[Key, ...]) -> pytest.MarkDecorator:
    return pytest.mark.parametrize("row", rows, ids=lambda row: row.path)


@each(KEYS)
def test_out_of_range(row: Key, refuse: Refuse) -> None:
    for value in (row.low, row.high):
        if row.kind == THREE:
            text, place = refuse(spoiled(row.path, [1.0, value, 1.0])), f"{row.path}[1]"
        else:
            text, place = refuse(spoiled(row.path, value)), row.path
        assert (
            text.splitlines()[0] == f"{FILE}: {place} = {value!r} is not valid: must be {row.range}"
        )


@each(KEYS)
def test_missing(row: Key, refuse: Refuse) -> None:
    separator = ", each " if row.kind == THREE else " "
    unit = f", in {row.unit}" if row.unit else ""
    assert refuse(spoiled(row.path, None)) == (
        f"{FILE}: {row.path} is missing: must be {row.kind}{separator}{row.range}{unit}"
    )


@each(tuple(row for row in KEYS if row.kind != THREE))
def test_not_a_number(row: Key, refuse: Refuse) -> None:
    for value in ("many", True, [1, 2]):
        shown = "true" if value is True else repr(value)
        text = refuse(spoiled(row.path, value))
        assert text.startswith(f"{FILE}: {row.path} = {shown} is not valid: must be {row.kind}")


@pytest.mark.parametrize("path", [*OTHERS, *GROUPS])
def test_other_keys_are_needed_too(path: str, refuse: Refuse) -> None:
    assert refuse(spoiled(path, None)).startswith(f"{FILE}: {path} is missing: must be ")


@pytest.mark.parametrize(
    ("path", "value", "line"),
    [
        ("ddpg.tau", 0.001, "ddpg.tau is not a key: valid keys are replay_size, batch_size,"),
        ("ddpg.batchsize", 32, "ddpg.batchsize is not a key: did you mean batch_size?"),
        ("task.step_box_mm", [1, 1, 1], "task.step_box_mm is not a key: did you mean step_box_um?"),
        (
            "ddpg.actor.hidden",
            [],
            "ddpg.actor.hidden = [] is not valid: must be a list with at least one entry",
        ),
        (
            "ddpg.actor.hidden",
            [64, 0],
            "ddpg.actor.hidden[1] = 0 is not valid: must be at least 1 and at most 4096",
        ),
        (
            "ddpg.terminal_mask",
            0,
            "ddpg.terminal_mask = 0 is not valid: must be true or false",
        ),
        (
            "ddpg.additions.critic_norm",
            "group",
            "ddpg.additions.critic_norm = 'group' is not valid: must be none or layer or batch",
        ),
        (
            "ddpg.additions.twin_critics",
            2,
            "ddpg.additions.twin_critics = 2 is not valid: must be true or false",
        ),
        (
            "ddpg.additions.n_steps",
            3,
            "ddpg.additions.n_steps is not a key: did you mean return_steps?",
        ),
        (
            "expert.kind",
            "skill",
            "expert.kind = 'skill' is not valid: must be proportional",
        ),
        (
            "ddpg.batch_size",
            201,
            "ddpg.batch_size = 201 is not valid: must not exceed replay_size = 200",
        ),
        (
            "task.reward.alpha_y",
            0.4,
            "task.reward.alpha_y = 0.4 is not valid: must be 0.3, such that",
        ),
        (
            "residual.range_um",
            [1, 1, 61],
            "residual.range_um = [1, 1, 61] is not valid: must not exceed "
            "task.step_box_um = [20, 20, 60]",
        ),
        ("task.start_depth_um", -2300.1, "task.start_depth_um = -2300.1 is not valid: must be"),
    ],
)
def test_what_else_can_be_wrong(path: str, value: object, line: str, refuse: Refuse) -> None:
    assert refuse(spoiled(path, value)).startswith(f"{FILE}: {line}")


def test_a_part_that_is_not_there(refuse: Refuse) -> None:
    assert refuse(spoiled("part", "none.yaml")) == (
        "none.yaml: cannot be read: No such file or directory"
    )


def test_an_axial_step_longer_than_the_step_box(refuse: Refuse) -> None:
    text = refuse(spoiled("task.step_box_um", [20, 20, 40]))
    assert text.endswith(
        "insertion.axial_step_um = 50 is not valid: must not exceed z of "
        f"task.step_box_um = [20, 20, 40] in {FILE}"
    )


def paths(model: type[BaseModel], prefix: str = "") -> Iterator[str]:
    for name, field in model.model_fields.items():
        path = f"{prefix}{field.alias or name}"
        yield path
        kind = field.annotation
        if isinstance(kind, UnionType):
            kind = get_args(kind)[0]
        if isinstance(kind, type) and not get_args(kind) and issubclass(kind, BaseModel):
            yield from paths(kind, f"{path}.")


def test_every_key_has_a_row() -> None:
    stated = [*(row.path for row in KEYS), *OTHERS, *GROUPS, MAY_BE_LEFT_OUT]
    assert len(stated) == len(set(stated))
    assert set(stated) == set(paths(TrainingSettings))


def test_the_reference_states_unit_and_range_of_every_key_and_no_other() -> None:
    page = (ROOT / "docs/reference/training.md").read_text(encoding="utf-8")
    text, _ = page.split("## By the gradient")
    rows = re.findall(r"^\| `([\w.]+)` \| (.*?) ?\| (.+?) \| .+ \|$", text, re.MULTILINE)
    found = {path: (unit, valid) for path, unit, valid in rows}
    numbers = {row.path: (row.unit, row.range) for row in KEYS}
    assert {path: row for path, row in found.items() if path in numbers} == numbers
    assert found.keys() == {*numbers, *OTHERS}


def test_the_shipped_file_is_the_papers() -> None:
    settings = load_plan(ROOT / "config/training/paper.yaml").settings
    ddpg, exploration = settings.ddpg, settings.exploration
    assert (ddpg.replay_size, ddpg.batch_size, ddpg.discount) == (200, 32, 0.99)
    assert (ddpg.target_rate, settings.rounds, settings.initial_states) == (0.001, 200, 300)
    assert (exploration.sigma_success, exploration.sigma_failure) == (0.1, 0.4)
    assert settings.task.state_sigma == 0.2
    assert settings.task.step_box_m == (20e-6, 20e-6, 60e-6)
    assert settings.task.force_limit_N == (0.07, 0.1, 1.0)
    assert settings.expert.gain_factor == 0.2
    assert settings.expert.force_jacobian_m_N == 800e-6
    assert not ddpg.terminal_mask
    assert ddpg.additions is None


def test_additions_are_read(tmp_path: Path) -> None:
    file = tmp_path / FILE
    file.write_text(flow(FULL), encoding="utf-8")
    assert load_plan(file).settings.ddpg.additions == AdditionSettings(
        twin_critics=True, critic_norm="layer", return_steps=3, target_noise=0.2, actor_period=2
    )
