"""A file that cannot be read as plain keys and values is refused in one line with file and line."""

import hashlib
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from drivers.contract.configuration.yaml_loader import read_yaml
from drivers.contract.errors import ConfigurationError
from hil.config import load_cell

KEY = "a key must be a name of letters, digits, '_' and '-'"


@pytest.fixture
def file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return Path("cell.yaml")


def refusal(file: Path, content: bytes) -> str:
    file.write_bytes(content)
    with pytest.raises(ConfigurationError) as caught:
        read_yaml(file)
    return str(caught.value)


@pytest.mark.parametrize(
    ("content", "expected"),
    [
        (b"", "cell.yaml: is empty"),
        (b"# nothing but a comment\n", "cell.yaml: is empty"),
        (b"- a\n- b\n", "cell.yaml: must be a mapping of keys to values"),
        (b"5\n", "cell.yaml: must be a mapping of keys to values"),
        (b"a: 1\nb: [1, 2\nc: 3\n", "cell.yaml, line 3: expected ',' or ']', but got ':'"),
        (b"a: 1\n b: 2\n", "cell.yaml, line 2: mapping values are not allowed here"),
        (b"a: 1\n\tb: 2\n", "cell.yaml, line 2: found character '\\t' that cannot start any token"),
        (b"a: 1\nb: 'open\n", "cell.yaml, line 3: found unexpected end of stream"),
        (b"a: 1\n---\nb: 2\n", "cell.yaml, line 2: but found another document"),
        (b"a: 1\nb: 2\n\na: 3\n", "cell.yaml, line 4: a appears a second time"),
        (b"g:\n  a: 1\n  a: 1\n", "cell.yaml, line 3: a appears a second time"),
        (b'a: 1\n"a": 3\n', "cell.yaml, line 2: a appears a second time"),
        (b"a: 1\nb:\nc: 3\n", "cell.yaml, line 2: b has no value"),
        (b"a: 1\nb: null\n", "cell.yaml, line 2: b has no value"),
        (b"a: 1\nb: ~\n", "cell.yaml, line 2: b has no value"),
        (b"a: 1\nb: [1, , 3]\n", "cell.yaml, line 2: expected the node content, but found ','"),
        (b"a: 1\nb: [1, ~, 3]\n", "cell.yaml, line 2: an entry has no value"),
        (b"a: 1\nb:\n  - 1\n  -\n", "cell.yaml, line 4: an entry has no value"),
        (
            b"a: 1\n5: 3\n",
            f"cell.yaml, line 2: {KEY}",
        ),
        (
            b"a: 1\n[b]: 3\n",
            f"cell.yaml, line 2: {KEY}",
        ),
        (
            b"a: 1\n'x\ty': 3\n",
            f"cell.yaml, line 2: {KEY}",
        ),
        (
            b'a: 1\n"x\\ny": 3\n',
            f"cell.yaml, line 2: {KEY}",
        ),
        (
            b"a: 1\n~: 3\n",
            f"cell.yaml, line 2: {KEY}",
        ),
        (b"a: 1\nb: &x 3\n", "cell.yaml, line 2: anchors and aliases are not used here"),
        (b"a: &x 1\nb: *x\n", "cell.yaml, line 1: anchors and aliases are not used here"),
        (b"a: 1\nb: *x\n", "cell.yaml, line 2: anchors and aliases are not used here"),
        (b"a: 1\nb: !!float 3\n", "cell.yaml, line 2: tags are not used here"),
        (b"a: !!python/object:os.system []\n", "cell.yaml, line 1: tags are not used here"),
        (b"a: 1\nb: caf\xe9\n", "cell.yaml, line 2: is not UTF-8 text"),
        (b"a: 1\nb: \x00\n", "cell.yaml, line 2: holds a character that is not allowed"),
        (b"a: " + b"[" * 5000, "cell.yaml: is nested too deeply"),
    ],
)
def test_refused(content: bytes, expected: str, file: Path) -> None:
    assert refusal(file, content) == expected


def test_not_there(file: Path) -> None:
    with pytest.raises(ConfigurationError) as caught:
        load_cell(file)
    assert str(caught.value) == "cell.yaml: cannot be read: No such file or directory"


def test_a_folder(file: Path) -> None:
    file.mkdir()
    with pytest.raises(ConfigurationError) as caught:
        load_cell(file)
    assert str(caught.value) == "cell.yaml: cannot be read: Is a directory"


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("5", 5),
        ("-7", -7),
        ("+7", 7),
        ("5.0", 5.0),
        ("5.", 5.0),
        (".5", 0.5),
        ("1e3", 1000.0),
        ("1E-3", 0.001),
        ("-2.5e+2", -250.0),
        ("1" * 400, float("inf")),
        (".inf", float("inf")),
        ("-.Inf", float("-inf")),
        ("true", True),
        ("False", False),
        ("yes", "yes"),
        ("off", "off"),
        ("010", "010"),
        ("0x1F", "0x1F"),
        ("1_000", "1_000"),
        ("1:30", "1:30"),
        ("2024-01-01", "2024-01-01"),
        ("5 mm", "5 mm"),
        ("'5'", "5"),
        ("''", ""),
        ("nan", "nan"),
        ("<<", "<<"),
        ("[1, [2, a]]", (1, (2, "a"))),
        ("{b: 1}", {"b": 1}),
    ],
)
def test_values(text: str, expected: object, file: Path) -> None:
    file.write_text(f"a: {text}\n", encoding="utf-8")
    value = read_yaml(file)[1]["a"]
    assert value == expected
    assert type(value) is type(expected)


def test_source_is_the_exact_file(file: Path) -> None:
    content = "\ufeff# µm\r\na: 1\r\n".encode()
    file.write_bytes(content)
    source, values = read_yaml(file)
    assert values == {"a": 1}
    assert source.path == file
    assert source.text.encode() == content
    assert source.sha256 == hashlib.sha256(content).hexdigest()


@given(st.text() | st.binary())
def test_any_content_is_read_or_refused_in_one_line(
    tmp_path_factory: pytest.TempPathFactory, content: str | bytes
) -> None:
    file = tmp_path_factory.getbasetemp() / "any.yaml"
    file.write_bytes(content.encode() if isinstance(content, str) else content)
    text = f"{file}: "
    try:
        read_yaml(file)
    except ConfigurationError as error:
        text = str(error)
    assert text.startswith(str(file))
    assert len(text.splitlines()) == 1
