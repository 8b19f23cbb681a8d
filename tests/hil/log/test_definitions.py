"""The message definitions: the Python classes agree with them, and other tools can take them."""

import re
from dataclasses import fields
from pathlib import Path

import pytest
from rosbags.interfaces import Nodetype
from rosbags.interfaces.typing import FieldDesc
from rosbags.typesys import get_types_from_msg

from controllers.messages import FilterHealth, Severity
from hil import ros_types
from hil.log_file import MESSAGE_TYPES, Topic

FILES = sorted((Path(ros_types.__file__).parent / "msg").glob("*.msg"))
WORDS_OF_CPP = {"operator", "std", "class", "new", "delete", "default", "this", "union", "register"}
PYTHON_NAMES = {
    "uint8": "int",
    "uint32": "int",
    "float64": "float",
    "string": "str",
    "bool": "bool",
}


def _python_type(field: FieldDesc) -> str:
    """Return how a field of a message definition should be annotated."""
    kind, detail = field
    if kind == Nodetype.NAME:
        return str(detail).rpartition("/")[2]
    if kind == Nodetype.SEQUENCE:
        return f"list[{_python_type(detail[0])}]"
    if kind == Nodetype.ARRAY:
        return "ndarray"
    return PYTHON_NAMES[detail[0]]


def _annotation(kind: object) -> str:
    name = str(kind) if str(kind).startswith("list[") else getattr(kind, "__name__", "")
    return re.sub(r"\w+(\.|__)", "", name)


@pytest.mark.parametrize("file", FILES, ids=lambda file: file.stem)
def test_the_class_has_the_fields_of_the_file(file: Path) -> None:
    kind = getattr(ros_types, file.stem)
    assert kind.__msgtype__ == f"tenon_msgs/msg/{file.stem}"
    _, defined = get_types_from_msg(file.read_text(), kind.__msgtype__)[kind.__msgtype__]
    expected = [(name, _python_type(field)) for name, field in defined]
    assert [(field.name, _annotation(field.type)) for field in fields(kind)] == expected


@pytest.mark.parametrize("file", FILES, ids=lambda file: file.stem)
def test_ros_can_build_the_definition(file: Path) -> None:
    name = f"tenon_msgs/msg/{file.stem}"
    constants, defined = get_types_from_msg(file.read_text(), name)[name]
    for field, _ in defined:
        assert re.fullmatch(r"[a-z](_?[a-z0-9]+)*", field)
        assert field not in WORDS_OF_CPP
    for constant, _, _ in constants:
        assert re.fullmatch(r"[A-Z](_?[A-Z0-9]+)*", constant)


def test_constants_say_what_our_flags_say() -> None:
    def constants(file: str) -> dict[str, object]:
        text = next(path for path in FILES if path.stem == file).read_text()
        found, _ = get_types_from_msg(text, f"tenon_msgs/msg/{file}")[f"tenon_msgs/msg/{file}"]
        return {name: value for name, _, value in found}

    assert constants("Verdict") == {severity.name: int(severity) for severity in Severity}
    assert constants("ForceEstimate") == {f"HEALTH_{flag.name}": int(flag) for flag in FilterHealth}


def test_each_topic_has_a_type_and_each_type_of_ours_a_use() -> None:
    assert set(MESSAGE_TYPES) == set(Topic)
    definitions = "".join(ros_types.definition(kind) for kind in MESSAGE_TYPES.values())
    used = {kind.__msgtype__.rpartition("/")[2] for kind in MESSAGE_TYPES.values()}
    assert all(file.stem in used or f"tenon_msgs/{file.stem}" in definitions for file in FILES)


def test_a_log_brings_its_units_along() -> None:
    text = ros_types.definition(ros_types.ForceEstimate)
    assert "# N/s, N*m/s" in text
    assert "MSG: geometry_msgs/Wrench" in text
