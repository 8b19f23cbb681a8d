"""A residual policy: a small network together with the processing of its inputs and outputs.

It is computed by numpy alone, so that a cell that runs it needs no training library.
"""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from controllers.messages import Observation
from drivers.contract.messages import Vector3
from learning.policy.expert import Expert, check_expert
from learning.policy.inputs import OUTPUT_UNITS, READINGS, Input, Output
from simulator.checks import FloatArray, positive

Float32Array = npt.NDArray[np.float32]

SMALLEST_SCALE, LARGEST_SCALE = 1e-12, 1e12
"""Between them a scale can be divided by without loss."""
_ORIGIN_TOLERANCE_M = 1e-4
"""A torque of 10 mN is off by 1 uN m for it, far below the noise of a sensor."""
LONGEST_HISTORY = 64
"""Most observations that a network sees at once."""


class Layer(NamedTuple):
    """One linear layer."""

    weight: Float32Array
    """(outputs, inputs)."""
    bias: Float32Array
    """(outputs,)."""


@dataclass(frozen=True, eq=False)
class Policy:
    """Answers inputs in SI units with a residual in SI units.

    The network sees the newest `history` observations, the newest first: all inputs of each, every
    one divided by its scale and cut to `bound`. It has ReLU between its layers and tanh at its end,
    which is multiplied by the output's scale. Raises `ValueError`, naming what is wrong, for names,
    scales, shapes or numbers that cannot be used.
    """

    inputs: tuple[Input, ...]
    outputs: tuple[Output, ...]
    bound: float
    """Largest magnitude of a scaled input."""
    layers: tuple[Layer, ...]
    expert: Expert
    history: int = 1
    """How many observations the network sees, from 1 to `LONGEST_HISTORY`."""
    torque_origin_m: Vector3 | None = None
    """Place in frame M of the sensor whose torques it reads; None if it reads none."""
    _input_scale: FloatArray = field(init=False, repr=False)
    _output_scale: FloatArray = field(init=False, repr=False)

    def __post_init__(self) -> None:
        _check_channels("input", self.inputs, READINGS)
        _check_channels("output", self.outputs, OUTPUT_UNITS)
        positive("bound", self.bound)
        check_expert(self.expert)
        _check_history(self.history)
        _check_torque_origin(self)
        object.__setattr__(self, "layers", tuple(_layers(self)))
        scales = [i.scale for i in self.inputs] * self.history
        object.__setattr__(self, "_input_scale", np.array(scales))
        object.__setattr__(self, "_output_scale", np.array([o.scale for o in self.outputs]))

    def torque_problem(self, origin_m: Vector3) -> str:
        """Return in words why it cannot read the torques of a sensor there, or nothing."""
        own_m = self.torque_origin_m
        if own_m is None or np.abs(np.subtract(own_m, origin_m)).max() <= _ORIGIN_TOLERANCE_M:
            return ""
        own, other = (
            f"[{', '.join(f'{1e6 * v:.12g}' for v in place)}] um" for place in (own_m, origin_m)
        )
        return (
            f"it reads torques about {own}, the sensor's are about {other}; "
            "it must be trained with the place of this sensor"
        )

    @property
    def n_values(self) -> int:
        """How many numbers the network sees: all inputs of `history` observations."""
        return len(self.inputs) * self.history

    def read(self, observation: Observation) -> list[float]:
        """Return the inputs (n_inputs,) of one observation in SI units."""
        return [READINGS[name].read(observation) for name, _ in self.inputs]

    def residual(self, values: Sequence[float] | FloatArray) -> FloatArray:
        """Return the residual (n_outputs,) in SI units for one set of values (n_values,).

        They are the inputs of `history` observations, the newest first, in SI units. A value that
        is NaN makes the whole residual NaN. Raises `ValueError` for another shape.
        """
        given = np.asarray(values, dtype=np.float64)
        if given.shape != self._input_scale.shape:
            raise ValueError(f"inputs have shape {given.shape}; it must be ({self.n_values},)")
        return self._answer(given)

    def residuals(self, values: npt.ArrayLike) -> FloatArray:
        """Return the residuals (n, n_outputs) in SI units for n sets of values (n, n_values).

        Each row is that of `residual` to rounding. Raises `ValueError` for another shape.
        """
        given = np.asarray(values, dtype=np.float64)
        if given.ndim != 2 or given.shape[1] != self.n_values:
            raise ValueError(f"inputs have shape {given.shape}; it must be (n, {self.n_values})")
        return self._answer(given)

    def _answer(self, values: FloatArray) -> FloatArray:
        scaled = values / self._input_scale
        signal = np.minimum(np.maximum(scaled, -self.bound), self.bound).astype(np.float32)
        *hidden, (weight, bias) = self.layers
        for inner_weight, inner_bias in hidden:
            signal = np.maximum(signal @ inner_weight.T + inner_bias, np.float32(0.0))
        residual: FloatArray = np.tanh(signal @ weight.T + bias) * self._output_scale
        return residual


def _check_channels(kind: str, channels: Sequence[Input | Output], valid: Iterable[str]) -> None:
    names = [channel.name for channel in channels]
    if not names:
        raise ValueError(f"there is no {kind}; there must be at least one")
    for name, scale in channels:
        if name not in valid:
            raise ValueError(f"{kind} {name!r} is not known; valid are {', '.join(valid)}")
        if names.count(name) > 1:
            raise ValueError(f"{kind} {name!r} is there {names.count(name)} times; it must be once")
        if not SMALLEST_SCALE <= scale <= LARGEST_SCALE:
            raise ValueError(
                f"scale of {kind} {name!r} is {scale!r}; "
                f"it must be at least {SMALLEST_SCALE:g} and at most {LARGEST_SCALE:g}"
            )


def _check_history(history: int) -> None:
    if not (isinstance(history, int) and 1 <= history <= LONGEST_HISTORY):
        raise ValueError(
            f"history is {history!r}; it must be a whole number from 1 to {LONGEST_HISTORY}"
        )


def _check_torque_origin(policy: Policy) -> None:
    reads_torque = any(name.startswith("torque_") for name, _ in policy.inputs)
    place = policy.torque_origin_m
    if reads_torque != (place is not None):
        raise ValueError(
            f"torque_origin_m is {place!r}; it must be a place if there is an input of torque, "
            "and None if there is none"
        )
    if place is not None and not (len(place) == 3 and np.isfinite(place).all()):
        raise ValueError(f"torque_origin_m is {place!r}; it must be three finite numbers")


def _layers(policy: Policy) -> Iterable[Layer]:
    """Yield the layers as read-only copies in single precision."""
    if not policy.layers:
        raise ValueError("there is no layer; there must be at least one")
    width = policy.n_values
    for number, (given_weight, given_bias) in enumerate(policy.layers):
        with np.errstate(over="ignore"):
            weight = np.array(given_weight, dtype=np.float32, order="C")
            bias = np.array(given_bias, dtype=np.float32, order="C")
        if weight.ndim != 2 or weight.shape[1] != width or weight.shape[0] == 0:
            raise ValueError(
                f"weight of layer {number} has shape {weight.shape}; it must be (outputs, {width})"
            )
        width = weight.shape[0]
        if bias.shape != (width,):
            raise ValueError(
                f"bias of layer {number} has shape {bias.shape}; it must be ({width},)"
            )
        for name, array in (("weight", weight), ("bias", bias)):
            if not np.isfinite(array).all():
                count = np.count_nonzero(~np.isfinite(array))
                raise ValueError(
                    f"{name} of layer {number} has {count} values that are not finite in single "
                    "precision; all must be"
                )
            array.setflags(write=False)
        yield Layer(weight, bias)
    if width != len(policy.outputs):
        raise ValueError(
            f"the last layer has {width} outputs; it must have {len(policy.outputs)}, "
            "one for each output of the policy"
        )
