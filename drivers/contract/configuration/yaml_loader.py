"""Reads a configuration file as plain mappings, tuples, texts and numbers.

Stricter than YAML 1.1: numbers are plain decimals (`1e3` is one; `010`, `1_000` and `1:30` are
texts), only `true` and `false` are booleans. Duplicate keys, empty values, tags, anchors and a
second document are refused.
"""

import hashlib
import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import cast

import yaml

from drivers.contract.errors import ConfigurationError

Plain = str | int | float | bool | tuple["Plain", ...] | Mapping[str, "Plain"]

_NULL = "tag:yaml.org,2002:null"
_BOOL = "tag:yaml.org,2002:bool"
_INT = "tag:yaml.org,2002:int"
_FLOAT = "tag:yaml.org,2002:float"
_KEY = r"[^\W\d][\w-]*"
_DECIMAL = r"(0|[1-9][0-9]*)"


@dataclass(frozen=True, slots=True)
class SourceFile:
    """A configuration file as it was read."""

    path: Path
    text: str
    sha256: str
    """Of the file's bytes, in hexadecimal."""


def read_yaml(path: Path) -> tuple[SourceFile, dict[str, Plain]]:
    """Read `path`; raises ConfigurationError, in one line, if it does not hold a mapping."""
    try:
        content = path.read_bytes()
    except OSError as error:
        raise ConfigurationError(f"{path}: cannot be read: {error.strerror}") from error
    except ValueError as error:
        raise ConfigurationError(f"{str(path)!r}: cannot be read: {error}") from error
    try:
        text = content.decode("utf-8")
    except UnicodeDecodeError as error:
        line = content.count(b"\n", 0, error.start) + 1
        raise ConfigurationError(f"{path}, line {line}: is not UTF-8 text") from error
    source = SourceFile(path, text, hashlib.sha256(content).hexdigest())
    return source, parse_yaml(path, text)


def parse_yaml(path: Path, text: str) -> dict[str, Plain]:
    """Return what `text`, the content of `path`, holds; raises ConfigurationError as read_yaml."""
    try:
        node = _Loader(text).get_single_node()
        if node is None:
            raise ConfigurationError(f"{path}: is empty")
        if not isinstance(node, yaml.MappingNode):
            raise ConfigurationError(f"{path}: must be a mapping of keys to values")
        return _mapping(node)
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        line = "" if mark is None else f", line {mark.line + 1}"
        raise ConfigurationError(f"{path}{line}: {error.problem or error.context}") from error
    except yaml.reader.ReaderError as error:
        line = f", line {text.count(chr(10), 0, error.position) + 1}"
        raise ConfigurationError(f"{path}{line}: holds a character that is not allowed") from error
    except RecursionError as error:
        raise ConfigurationError(f"{path}: is nested too deeply") from error


class _Loader(yaml.SafeLoader):
    """Composes nodes with the few scalar types that a configuration needs."""

    # PyYAML declares it an attribute of instances, which ClassVar would contradict.
    yaml_implicit_resolvers: dict[str, list[tuple[str, re.Pattern[str]]]] = {}  # noqa: RUF012, see above

    def compose_node(self, parent: yaml.Node | None, index: int) -> yaml.Node | None:
        event: yaml.Event = self.peek_event()  # type: ignore[no-untyped-call]  # PyYAML has no types here
        if isinstance(event, yaml.AliasEvent) or getattr(event, "anchor", None) is not None:
            raise _problem("anchors and aliases are not used here", event)
        if getattr(event, "tag", None) is not None:
            raise _problem("tags are not used here", event)
        return super().compose_node(parent, index)


for _tag, _pattern, _first in (
    (_NULL, r"(~|null|Null|NULL|)", ["~", "n", "N", ""]),
    (_BOOL, r"(true|True|TRUE|false|False|FALSE)", list("tTfF")),
    # Longer integers are read as floats, whose range is checked.
    (_INT, r"[-+]?(0|[1-9][0-9]{0,14})", list("-+0123456789")),
    (_FLOAT, rf"[-+]?({_DECIMAL}(\.[0-9]*)?|\.[0-9]+)([eE][-+]?[0-9]+)?", list("-+.0123456789")),
    (_FLOAT, r"([-+]?\.(inf|Inf|INF)|\.(nan|NaN|NAN))", list("-+.")),
):
    _Loader.add_implicit_resolver(_tag, re.compile(rf"^(?:{_pattern})$"), _first)


def _problem(text: str, at: yaml.Event | yaml.Node) -> yaml.MarkedYAMLError:
    return yaml.MarkedYAMLError(problem=text, problem_mark=cast(yaml.Mark, at.start_mark))


def _mapping(node: yaml.MappingNode) -> dict[str, Plain]:
    values: dict[str, Plain] = {}
    for key_node, value_node in node.value:
        key = key_node.value
        if not isinstance(key, str) or not re.fullmatch(_KEY, key):
            raise _problem("a key must be a name of letters, digits, '_' and '-'", key_node)
        if key in values:
            raise _problem(f"{key} appears a second time", key_node)
        if value_node.tag == _NULL:
            raise _problem(f"{key} has no value", value_node)
        values[key] = _plain(value_node)
    return values


def _plain(node: yaml.Node) -> Plain:
    if isinstance(node, yaml.MappingNode):
        return _mapping(node)
    if isinstance(node, yaml.SequenceNode):
        return tuple(_plain(item) for item in node.value)
    if node.tag == _NULL:
        raise _problem("an entry has no value", node)
    text: str = node.value
    if node.tag == _BOOL:
        return text.lower() == "true"
    if node.tag == _INT:
        return int(text)
    if node.tag == _FLOAT:
        return float(re.sub(r"\.(?=[in])", "", text.lower()))
    return text
