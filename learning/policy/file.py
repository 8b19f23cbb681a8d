"""A policy as one safetensors file: weights as tensors, all the rest as JSON in its metadata.

Reading a file runs nothing that it holds: there is no pickle in it.
"""

from collections.abc import Mapping
from hashlib import sha256
from pathlib import Path
from typing import NamedTuple

import numpy as np
from pydantic import JsonValue
from safetensors import SafetensorError
from safetensors.numpy import load, save

from drivers.contract.errors import PolicyError
from learning.atomic_file import write_atomically
from learning.manifest_text import MANIFEST, read_manifest
from learning.policy.manifest import Manifest, content_hash, make_manifest, policy_of
from learning.policy.policy import Layer, Policy

SUFFIX = ".safetensors"


class StoredPolicy(NamedTuple):
    """A policy as its file holds it."""

    policy: Policy
    manifest: Manifest
    sha256: str
    """Of the file's bytes."""


def save_policy(policy: Policy, path: Path, about: Mapping[str, JsonValue]) -> None:
    """Write a policy to `path`, named .safetensors, and beside it as `<name>.onnx`.

    `about` is what its trainer tells of it: configuration, seed, metrics. Each file is replaced
    as a whole. Raises PolicyError if they cannot be written, or if the ONNX model does not answer
    as the policy does.
    """
    from learning.policy.onnx_export import exported  # needs libraries that no cell has to load

    if path.suffix != SUFFIX:
        raise PolicyError(f"the policy's file {path} is not valid: its name must end in {SUFFIX}")
    try:
        manifest = make_manifest(policy, about)
        text = manifest.written()
    except (TypeError, ValueError) as error:
        raise PolicyError(f"{path}: the manifest cannot be written as JSON: {error}") from error
    onnx = exported(policy, manifest)
    tensors = {
        name: array
        for number, layer in enumerate(policy.layers)
        for name, array in zip(_names(number), layer, strict=True)
    }
    content = save(tensors, {MANIFEST: text})
    try:
        write_atomically(path.with_suffix(".onnx"), onnx)
        write_atomically(path, content)
    except OSError as error:
        raise PolicyError(f"{path}: cannot be written: {error.strerror}") from error


def load_policy(path: Path) -> Policy:
    """Return the policy in `path`; raises PolicyError as `read_policy` does."""
    return read_policy(path).policy


def read_policy(path: Path) -> StoredPolicy:
    """Return the policy in `path` with its manifest and the file's hash.

    Raises PolicyError, naming file and cause, if the file is not there, damaged, altered, or of
    another kind.
    """
    try:
        content = path.read_bytes()
    except OSError as error:
        raise PolicyError(f"{path}: cannot be read: {error.strerror}") from error
    except ValueError as error:
        raise PolicyError(f"{str(path)!r}: cannot be read: {error}") from error
    try:
        tensors = load(content)
    except SafetensorError as error:
        raise PolicyError(f"{path}: is damaged or no safetensors file: {error}") from error
    except KeyError as error:
        raise PolicyError(
            f"{path}: has a tensor of type {error}; all must be float32 (F32)"
        ) from error
    try:
        manifest = read_manifest(content, Manifest, "it holds no policy of Tenon")
        layers = _layers(tensors)
        found = content_hash(manifest, layers)
        if found != manifest.sha256:
            raise ValueError(
                f"has been altered: its content has SHA-256 {found}, "
                f"its manifest says {manifest.sha256}"
            )
        policy = policy_of(manifest, layers)
    except ValueError as error:
        raise PolicyError(f"{path}: {error}") from error
    return StoredPolicy(policy, manifest, sha256(content).hexdigest())


def _layers(tensors: Mapping[str, np.ndarray]) -> tuple[Layer, ...]:
    names = [_names(number) for number in range((len(tensors) + 1) // 2)]
    expected = [name for pair in names for name in pair]
    if set(tensors) != set(expected):
        raise ValueError(
            f"has the tensors {', '.join(sorted(tensors))}; they must be weight and bias "
            "of layers counted from 0: layer0.weight, layer0.bias, and so on"
        )
    for name in expected:
        if tensors[name].dtype != np.float32:
            raise ValueError(f"tensor {name} is {tensors[name].dtype}; it must be float32")
    return tuple(Layer(tensors[weight], tensors[bias]) for weight, bias in names)


def _names(number: int) -> tuple[str, str]:
    return f"layer{number}.weight", f"layer{number}.bias"
