"""What a log says about the run it holds: configuration, limits, seed, versions."""

import platform
from collections.abc import Mapping
from importlib.metadata import version

from hil.config import CellConfig
from hil.config.load import PolicyConfig

_LIBRARIES = ("tenon", "filterpy", "mcap", "numpy", "pydantic", "rosbags", "scipy")


def metadata(
    config: CellConfig, controller: str, insertions: int, seed: int, real_time: bool
) -> Mapping[str, Mapping[str, str]]:
    """Return the log's metadata records by name.

    The files of cell, limits and part are held word by word, each with its SHA-256; the limits in
    force, which part and stage may have tightened, in SI units. Where the controller runs a policy,
    so are its name, the SHA-256 of its file, and its manifest.
    """
    cell, limits, part = config.sources
    choice = config.controllers[controller]
    policy = {"policy": _about(choice)} if isinstance(choice, PolicyConfig) else {}
    return {
        "run": {
            "controller": controller,
            "insertions": str(insertions),
            "seed": str(seed),
            "time": "real" if real_time else "simulated",
        },
        "configuration": {"file": str(cell.path), "text": cell.text, "sha256": cell.sha256},
        "limits": {
            "file": str(limits.path),
            "text": limits.text,
            "sha256": limits.sha256,
            "in_force": config.limits.model_dump_json(),
        },
        "part": {"file": str(part.path), "text": part.text, "sha256": part.sha256},
        **policy,
        "versions": {
            "python": platform.python_version(),
            **{name: version(name) for name in _LIBRARIES},
        },
    }


def _about(choice: PolicyConfig) -> Mapping[str, str]:
    return {
        "name": choice.path.stem,
        "file": str(choice.path),
        "sha256": choice.stored.sha256,
        "manifest": choice.stored.manifest.written(),
    }
