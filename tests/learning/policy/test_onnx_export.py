"""The ONNX model beside a policy, as another program would run it."""

import dataclasses
from pathlib import Path

import numpy as np
import onnx
import onnxruntime
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from drivers.contract.errors import PolicyError
from learning.policy import onnx_export
from learning.policy.file import save_policy
from learning.policy.manifest import make_manifest
from tests.learning.policy.policies import random_policy


def run(model: bytes, values: np.ndarray) -> np.ndarray:
    session = onnxruntime.InferenceSession(model, providers=["CPUExecutionProvider"])
    (residual,) = session.run(None, {"values": values.astype(np.float32)})
    return np.asarray(residual)


@settings(max_examples=40)
@given(st.integers(0, 2**32 - 1), st.lists(st.integers(1, 64), max_size=3), st.sampled_from([1, 3]))
def test_it_answers_as_the_policy(seed: int, hidden: list[int], history: int) -> None:
    policy = random_policy(seed, tuple(hidden), history=history)
    model = onnx_export.exported(policy, make_manifest(policy, {}))
    reach = [0.3, 0.3, 0.3, 0.01] * history
    values = np.random.default_rng(seed).uniform(-1.0, 1.0, (50, 4 * history)) * reach
    assert run(model, values) == pytest.approx(policy.residuals(values), abs=1e-5 * 2e-5)
    assert run(model, values[:1]).shape == (1, 3)


def test_its_input_is_as_wide_as_the_history() -> None:
    policy = random_policy(history=3)
    model = onnx.load_from_string(onnx_export.exported(policy, make_manifest(policy, {})))
    (port,) = model.graph.input
    assert [d.dim_param or d.dim_value for d in port.type.tensor_type.shape.dim] == ["batch", 12]


def test_the_file_stands_beside_the_policy_and_says_what_it_is(tmp_path: Path) -> None:
    save_policy(random_policy(), tmp_path / "p.safetensors", {"seed": 7})
    model = onnx.load(tmp_path / "p.onnx")
    (manifest,) = (entry.value for entry in model.metadata_props if entry.key == "manifest")
    assert '"about":{"seed":7}' in manifest
    assert [port.name for port in (*model.graph.input, *model.graph.output)] == [
        "values",
        "residual",
    ]


@pytest.mark.parametrize("spoil", ["bound", "scale", "weight"])
def test_a_model_that_answers_otherwise_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, spoil: str
) -> None:
    policy = random_policy()
    wrong = {
        "bound": dataclasses.replace(policy, bound=2.1),
        "scale": dataclasses.replace(
            policy, outputs=(*policy.outputs[:2], policy.outputs[2]._replace(scale=2.1e-5))
        ),
        "weight": random_policy(1),
    }[spoil]
    make = onnx_export._model
    monkeypatch.setattr(onnx_export, "_model", lambda policy, manifest: make(wrong, manifest))
    with pytest.raises(PolicyError, match=r"the ONNX model differs from the policy in output 'ste"):
        save_policy(policy, tmp_path / "p.safetensors", {})
    assert list(tmp_path.iterdir()) == []
