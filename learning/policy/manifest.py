"""What a policy's file says besides its weights, and the hash that ties both together."""

import json
import platform
from collections.abc import Mapping
from hashlib import sha256
from importlib.metadata import version
from typing import Literal

from pydantic import JsonValue

from drivers.contract.messages import Vector3
from drivers.contract.settings import Settings
from learning.policy.expert import Approach, Expert
from learning.policy.inputs import OUTPUT_UNITS, READINGS, Input, Output
from learning.policy.policy import Layer, Policy

_LIBRARIES = ("tenon", "numpy", "safetensors", "torch", "onnx", "onnxruntime")


class Channel(Settings):
    """One input or output."""

    name: str
    unit: str
    scale: float


class ApproachManifest(Settings):
    """The expert's short steps at the first rim."""

    step_m: float
    depth_m: float


class ExpertManifest(Settings):
    """The expert that the policy corrects."""

    gain_m_N: float
    axial_step_m: float
    step_box_m: Vector3
    approach: ApproachManifest | None = None


class Manifest(Settings):
    """Everything about a policy but its weights; SI units.

    A key that has its default is not written and not hashed.
    """

    format: Literal[1]
    inputs: tuple[Channel, ...]
    outputs: tuple[Channel, ...]
    history: int = 1
    torque_origin_m: Vector3 | None = None
    bound: float
    hidden_activation: Literal["relu"]
    output_activation: Literal["tanh"]
    expert: ExpertManifest
    versions: Mapping[str, str]
    """Of the libraries that made the file."""
    about: Mapping[str, JsonValue]
    """What the trainer tells of it: configuration, seed, metrics."""
    sha256: str
    """Of the rest of the manifest and the weights; see `content_hash`."""

    def written(self) -> str:
        """Return it as JSON, as files hold it."""
        return self.model_dump_json(exclude_defaults=True)


def make_manifest(policy: Policy, about: Mapping[str, JsonValue]) -> Manifest:
    """Return the manifest of a policy; raises `ValueError` for what JSON cannot hold."""
    expert, approach = policy.expert, policy.expert.approach
    manifest = Manifest(
        format=1,
        inputs=tuple(
            Channel(name=name, unit=READINGS[name].unit, scale=scale)
            for name, scale in policy.inputs
        ),
        outputs=tuple(
            Channel(name=name, unit=OUTPUT_UNITS[name], scale=scale)
            for name, scale in policy.outputs
        ),
        history=policy.history,
        torque_origin_m=policy.torque_origin_m,
        bound=policy.bound,
        hidden_activation="relu",
        output_activation="tanh",
        expert=ExpertManifest(
            gain_m_N=expert.gain_m_N,
            axial_step_m=expert.axial_step_m,
            step_box_m=expert.step_box_m,
            approach=None
            if approach is None
            else ApproachManifest(step_m=approach.step_m, depth_m=approach.depth_m),
        ),
        versions={
            "python": platform.python_version(),
            **{name: version(name) for name in _LIBRARIES},
        },
        about=about,
        sha256="",
    )
    return manifest.model_copy(update={"sha256": content_hash(manifest, policy.layers)})


def content_hash(manifest: Manifest, layers: tuple[Layer, ...]) -> str:
    """Return the SHA-256 of all of the manifest but its own hash, and of the weights in order.

    Raises `ValueError` if the manifest holds a number that is not finite.
    """
    rest = manifest.model_dump(mode="json", exclude={"sha256"}, exclude_defaults=True)
    digest = sha256(json.dumps(rest, sort_keys=True, allow_nan=False).encode())
    for weight, bias in layers:
        digest.update(weight.astype("<f4").tobytes())
        digest.update(bias.astype("<f4").tobytes())
    return digest.hexdigest()


def policy_of(manifest: Manifest, layers: tuple[Layer, ...]) -> Policy:
    """Return the policy; raises `ValueError` if manifest and layers do not make one."""
    for kind, channels, units in (
        ("input", manifest.inputs, {name: reading.unit for name, reading in READINGS.items()}),
        ("output", manifest.outputs, OUTPUT_UNITS),
    ):
        for channel in channels:
            unit = units.get(channel.name, channel.unit)
            if channel.unit != unit:
                raise ValueError(
                    f"unit of {kind} {channel.name!r} is {channel.unit!r}; it must be {unit!r}"
                )
    expert, approach = manifest.expert, manifest.expert.approach
    return Policy(
        inputs=tuple(Input(channel.name, channel.scale) for channel in manifest.inputs),
        outputs=tuple(Output(channel.name, channel.scale) for channel in manifest.outputs),
        bound=manifest.bound,
        layers=layers,
        expert=Expert(
            expert.gain_m_N,
            expert.axial_step_m,
            expert.step_box_m,
            None if approach is None else Approach(approach.step_m, approach.depth_m),
        ),
        history=manifest.history,
        torque_origin_m=manifest.torque_origin_m,
    )
