"""The reference states every key with unit and range, and every metric."""

from collections.abc import Iterator

import pytest

from drivers.contract.configuration.describe import Accepted, unit_of
from drivers.contract.settings import Settings
from learning.evaluation.metrics import QUANTITIES
from learning.evaluation.settings import KINDS, EvaluationSettings
from tests.learning.evaluation.records import ROOT

PAGE = (ROOT / "docs/reference/evaluation.md").read_text(encoding="utf-8")


def rows(model: type[Settings], prefix: str = "") -> Iterator[str]:
    for name, field in model.model_fields.items():
        key, accepted = field.alias or name, Accepted.of(field.annotation, field.metadata)
        if key != "kind":
            valid = accepted.range or accepted.description
            yield f"| `{prefix}{key}` | {unit_of(key)[1]} | {valid} | "


@pytest.mark.parametrize("group", EvaluationSettings.model_fields)
def test_keys_of_the_file(group: str) -> None:
    model = EvaluationSettings.model_fields[group].annotation
    assert isinstance(model, type)
    for row in rows(model, f"{group}."):
        assert row in PAGE


@pytest.mark.parametrize("kind", KINDS)
def test_keys_of_a_kind(kind: str) -> None:
    section = PAGE.split(f"### `kind: {kind}`")[1].split("\n##")[0]
    stated = [line for line in section.splitlines() if line.startswith("| `")]
    for row in rows(KINDS[kind]):
        assert sum(line.startswith(row) for line in stated) == 1, row
    assert len(stated) == len([*rows(KINDS[kind])])


@pytest.mark.parametrize("name", QUANTITIES)
def test_metrics(name: str) -> None:
    assert f"`{name}`" in PAGE
