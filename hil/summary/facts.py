"""What a log's metadata says of the run: part, controller, seed, geometry, limits."""

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import accumulate
from pathlib import Path

from pydantic import BaseModel, ConfigDict, NonNegativeInt

from drivers.contract.configuration.yaml_loader import parse_yaml
from drivers.contract.errors import ConfigurationError
from drivers.contract.messages import Vector3
from hil.log_file import ENDING_RECORD

_LENIENT = ConfigDict(frozen=True, extra="ignore")
"""A log may come from a version with other keys than this one."""


class ForceLimits(BaseModel):
    """The limits that a reader of forces and speeds needs, as they were in force."""

    model_config = _LENIENT

    force_N: Vector3
    speed_m_s: float


class _Run(BaseModel):
    model_config = _LENIENT

    controller: str
    insertions: NonNegativeInt
    seed: int
    time: str


class _Hole(BaseModel):
    model_config = _LENIENT

    thickness_um: float
    gap_um: float = 0.0


class _Part(BaseModel):
    model_config = _LENIENT

    name: str
    holes: tuple[_Hole, ...]


@dataclass(frozen=True, slots=True)
class RunFacts:
    """What is known of a run apart from what happened; None or empty where the log does not say."""

    part: str
    walls_m: tuple[tuple[float, float], ...]
    """Depth of upper and lower rim of each hole."""
    controller: str
    seed: int | None
    asked: int | None
    """Insertions asked for."""
    simulated_time: bool
    limits: ForceLimits | None
    early_end: str
    """Why the run ended before its time, in its own words; empty if it did not, or nobody knows."""


def run_facts(metadata: Mapping[str, Mapping[str, str]]) -> RunFacts:
    """Return the facts in a log's metadata. What is missing or cannot be read is left out."""
    run = _run(metadata.get("run", {}))
    part = _part(metadata.get("part", {}))
    return RunFacts(
        part=part.name if part else "",
        walls_m=_walls(part.holes) if part else (),
        controller=run.controller if run else "",
        seed=run.seed if run else None,
        asked=run.insertions if run else None,
        simulated_time=run is not None and run.time == "simulated",
        limits=_limits(metadata.get("limits", {}).get("in_force", "")),
        early_end=metadata.get(ENDING_RECORD, {}).get("text", ""),
    )


def _run(entries: Mapping[str, str]) -> _Run | None:
    try:
        return _Run.model_validate(entries)
    except ValueError:
        return None


def _part(entries: Mapping[str, str]) -> _Part | None:
    """Read a part as the run did: other YAML readers take a name such as `on` for a boolean."""
    try:
        content = parse_yaml(Path(entries.get("file", "")), entries.get("text", ""))
        return _Part.model_validate(content)
    except (ConfigurationError, ValueError):
        return None


def _limits(text: str) -> ForceLimits | None:
    try:
        return ForceLimits.model_validate_json(text)
    except ValueError:
        return None


def _walls(holes: tuple[_Hole, ...]) -> tuple[tuple[float, float], ...]:
    lengths_um = [length for hole in holes for length in (hole.gap_um, hole.thickness_um)]
    rims_m = [rim_um * 1e-6 for rim_um in accumulate(lengths_um)]
    return tuple(zip(rims_m[0::2], rims_m[1::2], strict=True))
