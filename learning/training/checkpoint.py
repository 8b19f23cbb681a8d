"""A training as one safetensors file, so that it goes on as if it had never stopped.

Tensors are networks, targets, optimisers and replay; the rest is JSON in the metadata. Reading a
file runs nothing that it holds: there is no pickle in it.
"""

import json
import platform
from collections.abc import Mapping
from hashlib import sha256
from importlib.metadata import version
from pathlib import Path
from typing import Literal

import torch
from pydantic import JsonValue
from safetensors import SafetensorError
from safetensors.torch import load, save
from torch import Tensor

from drivers.contract.errors import TrainingError
from drivers.contract.settings import Settings
from learning.atomic_file import write_atomically
from learning.ddpg import Round
from learning.manifest_text import MANIFEST, read_manifest
from learning.training.plan import Plan
from learning.training.trainer import Trainer

SUFFIX = ".safetensors"
_LIBRARIES = ("tenon", "numba", "numpy", "torch")
_ADAM = ("step", "exp_avg", "exp_avg_sq")


class CheckpointManifest(Settings):
    """Everything of a training but its tensors."""

    format: Literal[1]
    seed: int
    configuration: Mapping[str, JsonValue]
    """Settings and part, SI units."""
    versions: Mapping[str, str]
    sigma: float
    """Of the next round's noise."""
    updates: int
    transitions: int
    """Added to the replay so far."""
    rounds: tuple[Round, ...]
    """Those that were played."""
    sha256: str
    """Of the rest of the manifest and the tensors."""


def versions() -> dict[str, str]:
    """Return the versions that a training's numbers depend on."""
    return {"python": platform.python_version(), **{name: version(name) for name in _LIBRARIES}}


def configuration(plan: Plan) -> dict[str, JsonValue]:
    """Return what a plan asks for as JSON, SI units; where its files lie is no part of it."""
    return {
        "training": plan.settings.model_dump(mode="json", exclude={"part"}, exclude_none=True),
        "part": plan.part.model_dump(mode="json"),
    }


def write_checkpoint(trainer: Trainer, path: Path) -> None:
    """Write a training to `path`, as a whole or not at all; raises TrainingError if it cannot."""
    tensors = _tensors(trainer)
    manifest = CheckpointManifest(
        format=1,
        seed=trainer.seed,
        configuration=configuration(trainer.plan),
        versions=versions(),
        sigma=trainer.exploration.sigma,
        updates=trainer.ddpg.updates,
        transitions=trainer.replay.added,
        rounds=tuple(trainer.rounds),
        sha256="",
    )
    signed = manifest.model_copy(update={"sha256": _hash(manifest, tensors)})
    try:
        write_atomically(path, save(tensors, {MANIFEST: signed.model_dump_json()}))
    except OSError as error:
        raise TrainingError(f"{path}: cannot be written: {error.strerror}") from error


def read_checkpoint(trainer: Trainer, path: Path) -> None:
    """Set a fresh trainer to where the one in `path` was.

    Raises TrainingError, naming file and cause, if the file is not there, damaged, altered, or of
    another configuration, seed or version of the libraries; the trainer is then not to be used.
    """
    try:
        content = path.read_bytes()
    except OSError as error:
        raise TrainingError(f"{path}: cannot be read: {error.strerror}") from error
    try:
        tensors = load(content)
    except SafetensorError as error:
        raise TrainingError(f"{path}: is damaged or no safetensors file: {error}") from error
    try:
        manifest = read_manifest(content, CheckpointManifest, "it is no checkpoint of Tenon")
        if (found := _hash(manifest, tensors)) != manifest.sha256:
            raise ValueError(
                f"has been altered: its content has SHA-256 {found}, "
                f"its manifest says {manifest.sha256}"
            )
        _check_origin(manifest, trainer)
        _set_tensors(trainer, tensors)
    except ValueError as error:
        raise TrainingError(f"{path}: {error}") from error
    trainer.exploration.sigma = manifest.sigma
    trainer.ddpg.updates = manifest.updates
    trainer.replay.added = manifest.transitions
    trainer.rounds[:] = manifest.rounds


def _check_origin(manifest: CheckpointManifest, trainer: Trainer) -> None:
    if manifest.seed != trainer.seed:
        raise ValueError(f"is of seed {manifest.seed}, not of {trainer.seed}")
    for group, wanted in configuration(trainer.plan).items():
        if (stored := manifest.configuration.get(group)) != wanted:
            raise ValueError(f"is of another {group}: {_difference(stored, wanted)}")
    if manifest.versions != (present := versions()):
        raise ValueError(f"was made with other versions: {_difference(manifest.versions, present)}")


def _difference(stored: object, wanted: object) -> str:
    """Say where two JSON values first differ."""
    if isinstance(stored, Mapping) and isinstance(wanted, Mapping):
        for key in sorted({*stored, *wanted}):
            if stored.get(key) != wanted.get(key):
                inside = _difference(stored.get(key), wanted.get(key))
                return f"{key} {inside}" if inside.startswith("is ") else f"{key}.{inside}"
    return f"is {stored!r} in the checkpoint and {wanted!r} now"


def _tensors(trainer: Trainer) -> dict[str, Tensor]:
    """Return all tensors of a training by name."""
    ddpg = trainer.ddpg
    tensors: dict[str, Tensor] = {}
    for name in ("actor", "critic", "target_actor", "target_critic"):
        for key, tensor in getattr(ddpg, name).state_dict().items():
            tensors[f"{name}.{key}"] = tensor
    for name in ("actor_optimiser", "critic_optimiser"):
        optimiser: torch.optim.Adam = getattr(ddpg, name)
        for number, weight in enumerate(optimiser.param_groups[0]["params"]):
            for key, tensor in _adam_state(optimiser, weight).items():
                tensors[f"{name}.{number}.{key}"] = tensor
    for key, tensor in trainer.replay.rows._asdict().items():
        tensors[f"replay.{key}"] = tensor
    return tensors


def _adam_state(optimiser: torch.optim.Adam, weight: Tensor) -> dict[str, Tensor]:
    """Return what Adam keeps of a weight; it is made here if no step was made."""
    state: dict[str, Tensor] = optimiser.state[weight]
    if not state:
        state["step"] = torch.zeros(())
        state["exp_avg"] = torch.zeros_like(weight)
        state["exp_avg_sq"] = torch.zeros_like(weight)
    return {key: state[key] for key in _ADAM}


def _set_tensors(trainer: Trainer, stored: Mapping[str, Tensor]) -> None:
    """Copy tensors into a training; raises ValueError if they do not fit."""
    own = _tensors(trainer)
    if missing := sorted(own.keys() - stored.keys()):
        raise ValueError(f"lacks the tensors {', '.join(missing)}")
    if unknown := sorted(stored.keys() - own.keys()):
        raise ValueError(f"has the unknown tensors {', '.join(unknown)}")
    for name, tensor in own.items():
        found = stored[name]
        if found.shape != tensor.shape or found.dtype != tensor.dtype:
            raise ValueError(
                f"tensor {name} is {found.dtype} {tuple(found.shape)}; "
                f"it must be {tensor.dtype} {tuple(tensor.shape)}"
            )
    with torch.no_grad():
        for name, tensor in own.items():
            tensor.copy_(stored[name])


def _hash(manifest: CheckpointManifest, tensors: Mapping[str, Tensor]) -> str:
    rest = manifest.model_dump(mode="json", exclude={"sha256"})
    digest = sha256(json.dumps(rest, sort_keys=True).encode())
    for name in sorted(tensors):
        tensor = tensors[name]
        digest.update(f"{name} {tensor.dtype} {tuple(tensor.shape)}".encode())
        digest.update(tensor.contiguous().numpy().tobytes())
    return digest.hexdigest()
