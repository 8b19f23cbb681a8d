"""A policy as an ONNX model: SI units in, SI units out, the processing included."""

import numpy as np
import onnx
import onnxruntime
from onnx import TensorProto, helper, numpy_helper

from drivers.contract.errors import PolicyError
from learning.policy.manifest import Manifest
from learning.policy.policy import Float32Array, Policy

OPSET = 17
IR_VERSION = 8
"""As old as the operators allow, so that old runtimes take it too."""
TOLERANCE = 1e-5
"""Largest difference between model and policy, by an output's scale."""
_SAMPLES = 1_000


def exported(policy: Policy, manifest: Manifest) -> bytes:
    """Return the policy as an ONNX model with input `values` and output `residual`.

    Both are float32, of shape (batch, n_values) as `Policy.residuals` takes them, and of shape
    (batch, n_outputs). Raises PolicyError if onnxruntime does not compute
    what the policy does.
    """
    content: bytes = _model(policy, manifest).SerializeToString()
    _check(policy, content)
    return content


def _model(policy: Policy, manifest: Manifest) -> onnx.ModelProto:
    nodes, constants = [], []

    def constant(name: str, value: object) -> str:
        constants.append(numpy_helper.from_array(np.asarray(value, dtype=np.float32), name))
        return name

    def add(operator: str, *operands: str, output: str) -> str:
        nodes.append(helper.make_node(operator, operands, [output], name=output))
        return output

    scales = constant("input_scale", _input_scales(policy))
    low, high = constant("lower_bound", -policy.bound), constant("upper_bound", policy.bound)
    signal = add("Div", "values", scales, output="scaled")
    signal = add("Clip", signal, low, high, output="bounded")
    for number, (weight, bias) in enumerate(policy.layers):
        name = f"layer{number}"
        tensors = constant(f"{name}.weight", weight.T), constant(f"{name}.bias", bias)
        signal = add("Gemm", signal, *tensors, output=name)
        is_last = number == len(policy.layers) - 1
        activation = "Tanh" if is_last else "Relu"
        signal = add(activation, signal, output=f"{name}.{activation.lower()}")
    ranges = constant("output_scale", [scale for _, scale in policy.outputs])
    add("Mul", signal, ranges, output="residual")
    width = {"values": policy.n_values, "residual": len(policy.outputs)}
    ports = {
        name: helper.make_tensor_value_info(name, TensorProto.FLOAT, ["batch", size])
        for name, size in width.items()
    }
    graph = helper.make_graph(
        nodes, "policy", [ports["values"]], [ports["residual"]], initializer=constants
    )
    model = helper.make_model(
        graph, opset_imports=[helper.make_opsetid("", OPSET)], ir_version=IR_VERSION
    )
    helper.set_model_props(model, {"manifest": manifest.written()})
    onnx.checker.check_model(model, full_check=True)
    return model


def _input_scales(policy: Policy) -> list[float]:
    return [scale for _, scale in policy.inputs] * policy.history


def _check(policy: Policy, content: bytes) -> None:
    """Compare on random inputs, some of them beyond the bound."""
    session = onnxruntime.InferenceSession(content, providers=["CPUExecutionProvider"])
    reach = 1.5 * policy.bound * np.array(_input_scales(policy))
    generator = np.random.default_rng(0)
    values = generator.uniform(-reach, reach, (_SAMPLES, len(reach))).astype(np.float32)
    (found,) = session.run(["residual"], {"values": values})
    _compare(policy, values, found)


def _compare(policy: Policy, values: Float32Array, found: Float32Array) -> None:
    scales = np.array([scale for _, scale in policy.outputs])
    difference = np.abs(found - policy.residuals(values)) / scales
    if not (difference <= TOLERANCE).all():
        worst = np.unravel_index(np.argmax(difference), difference.shape)
        raise PolicyError(
            f"the ONNX model differs from the policy in output "
            f"{policy.outputs[worst[1]].name!r} by {difference.max():.3g} of its scale; "
            f"at most {TOLERANCE:g} is valid"
        )
