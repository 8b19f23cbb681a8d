"""Turns what pydantic finds into one line per problem: file, key, value and what is valid."""

import math
import re
from collections.abc import Iterable, Mapping
from difflib import get_close_matches
from functools import reduce
from pathlib import Path
from typing import TypeVar

from pydantic import ValidationError
from pydantic_core import ErrorDetails

from drivers.contract.configuration.describe import Accepted, keys, unit_of
from drivers.contract.errors import ConfigurationError
from drivers.contract.settings import Settings

Place = tuple[str | int, ...]
"""Keys and list indices that lead to a value."""
AnySettings = TypeVar("AnySettings", bound=Settings)

INVALID = "invalid"
"""Type of a `PydanticCustomError` whose message is what a key accepts."""
_LONGEST = 60
_OUT_OF_RANGE = ("greater_than", "greater_than_equal", "less_than", "less_than_equal")
_NUMBER = r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?"


class Problems:
    """Collects the problems of several files, so that all are reported at once."""

    def __init__(self) -> None:
        self._lines: list[str] = []

    def add(self, file: Path, text: str) -> None:
        """Note the problems of a file, one per line of `text`."""
        self._lines += [f"{file}: {line}" for line in text.splitlines()]

    def __bool__(self) -> bool:
        return bool(self._lines)

    def error(self) -> ConfigurationError:
        """Return the error that tells of all of them."""
        return ConfigurationError("\n".join(self._lines))

    def validated(
        self, model: type[AnySettings], values: object, file: Path, *group: str
    ) -> AnySettings | None:
        """Return `values` as `model`, or None after noting why not; `group` is where they stand."""
        try:
            return model.model_validate(values)
        except ValidationError as error:
            for line in _lines(Accepted.of(model), error.errors(), group):
                self.add(file, line)
            return None


def _lines(root: Accepted, errors: Iterable[ErrorDetails], group: Place) -> list[str]:
    meant = set()
    lines = []
    for error in errors:
        if error["type"] == "extra_forbidden":
            *before, key = error["loc"]
            correction, hint = _correction(_accepted(root, before), str(key))
            meant.add((*before, correction))
            lines.append(f"{_path(group, error['loc'])} is not a key: {hint}")
    for error in errors:
        if error["type"] == "missing" and error["loc"] in meant:
            continue
        if error["type"] != "extra_forbidden":
            lines.append(_line(root, error, group))
    return list(dict.fromkeys(lines))


def _line(root: Accepted, error: ErrorDetails, group: Place) -> str:
    kind, loc, value = error["type"], error["loc"], error["input"]
    if kind == "value_error":
        inside = f"{place}." if (place := _path(group, loc)) else ""
        return "\n".join(f"{inside}{line}" for line in str(error["ctx"]["error"]).splitlines())
    if kind == "missing":
        parent = _accepted(root, loc[:-1])
        if parent.is_list:
            return _invalid(_path(group, loc[:-1]), value, parent.description)
        unit = unit_of(str(loc[-1]))[1]
        unit = f", in {unit}" if unit else ""
        valid = parent.inside(loc[-1]).description
        return f"{_path(group, loc)} is missing: must be {valid}{unit}"
    if kind == INVALID:
        return _invalid(_path(group, loc), value, error["msg"])
    accepted = _accepted(root, loc)
    valid = accepted.description
    if kind in _OUT_OF_RANGE:
        valid = accepted.range
    elif kind == "finite_number":
        valid = valid.replace("a number", "a finite number")
    return _invalid(_path(group, loc), value, valid + _hint(accepted, value))


def _accepted(root: Accepted, loc: Iterable[str | int]) -> Accepted:
    return reduce(Accepted.inside, loc, root)


def _invalid(path: str, value: object, valid: str) -> str:
    return f"{path} = {_shown(value)} is not valid: must be {valid}"


def _path(*places: Place) -> str:
    steps = [f"[{s}]" if isinstance(s, int) else f".{s}" for place in places for s in place]
    return "".join(steps).removeprefix(".")


def _shown(value: object) -> str:
    text = _flow(value)
    return text if len(text) <= _LONGEST else f"{text[:_LONGEST]}..."


def _flow(value: object) -> str:
    if isinstance(value, Mapping):
        return f"{{{', '.join(f'{k}: {_flow(v)}' for k, v in value.items())}}}"
    if isinstance(value, tuple):
        return f"[{', '.join(_flow(v) for v in value)}]"
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, float) and not math.isfinite(value):
        return f"{value}".replace("inf", ".inf").replace("nan", ".nan")
    return repr(value)


def _hint(accepted: Accepted, value: object) -> str:
    if accepted.is_text and isinstance(value, bool | int | float):
        return "; put it in quotes"
    if not accepted.is_number or not isinstance(value, str):
        return ""
    if re.fullmatch(_NUMBER, value):
        return "; write a plain decimal number without quotes"
    if re.fullmatch(rf"{_NUMBER}\s*[^\W\d_xob][\w/*^]*", value):
        return "; write the number alone, the key carries the unit"
    return "; write a plain decimal number" if re.search(r"\d", value) else ""


def _correction(group: Accepted, key: str) -> tuple[str, str]:
    """Return the key that was probably meant, and what to tell."""
    valid = keys(group.model) if group.model else []
    with_unit = [k for k in valid if unit_of(k)[0] and f"{key}_".startswith(_stem(k))]
    if with_unit:
        longest = max(len(_stem(k)) for k in with_unit)
        alike = [k for k in with_unit if len(_stem(k)) == longest]
        if len(alike) > 1 and len(key) < longest:
            return alike[0], f"did you mean {' or '.join(alike)}?"
        (candidate,) = get_close_matches(key, alike, n=1, cutoff=0.0)
        return candidate, f"did you mean {candidate}? Its unit is {unit_of(candidate)[1]}"
    for candidate in get_close_matches(key, valid, n=1):
        return candidate, f"did you mean {candidate}?"
    return "", f"valid keys are {', '.join(valid)}"


def _stem(key: str) -> str:
    return key.removesuffix(unit_of(key)[0])
