"""How long the cell waits for a policy's answer, next to onnxruntime and torch, side by side.

One answer, one CPU core, one thread each. Every row but the last two answers with the same
residual from the same list of numbers; `SkillController.step` does all from observation to move.
Run from the repository's root: python benchmarks/policy.py
"""

import gc
import os
import sys
import tempfile
import time
from collections.abc import Callable
from importlib.metadata import version
from itertools import cycle
from pathlib import Path

import numpy as np
import onnxruntime
import torch
from machine import describe

from controllers.messages import Observation
from drivers.contract.messages import Pose
from learning.policy.file import save_policy
from learning.policy.policy import Policy
from learning.skill_controller import SkillController

sys.path.append(str(Path(__file__).parents[1]))
from tests.learning.policy.policies import random_policy

CASES = ((64, 1), (256, 1), (64, 8))
"""Width of two hidden layers, and how many observations the network sees."""
WRENCH = ("force_x", "force_y", "force_z", "torque_x", "torque_y", "torque_z")
SEEN = (*WRENCH, "depth", "turn_x", "turn_y", "displacement_x", "displacement_y")
ANSWERED = ("step_x", "step_y", "step_z", "turn_x", "turn_y")
ROUNDS = 20
CALLS = 2_000
BUDGET_US = 50.0
OBSERVATIONS = [
    Observation(
        0,
        step,
        (0.01, -0.02, 0.3, 1e-3, -2e-3, 3e-3),
        (0.0,) * 6,
        Pose((1e-6, -2e-6, 1.5e-3), (2e-4, -3e-4, 0.0)),
        (4e-6, -5e-6, 1.8e-3),
        Pose((1e-6, -2e-6, 1.5e-3), (2e-4, -3e-4, 0.0)),
    )
    for step in (3, 4)
]
"""Of one step and the next, so that each is a new frame."""
Call = Callable[[], object]


def with_onnxruntime(policy: Policy, values: list[float]) -> Call:
    options = onnxruntime.SessionOptions()
    options.intra_op_num_threads = options.inter_op_num_threads = 1
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "p.safetensors"
        save_policy(policy, path, {})
        session = onnxruntime.InferenceSession(
            path.with_suffix(".onnx"), options, providers=["CPUExecutionProvider"]
        )
    return lambda: session.run(None, {"values": np.array([values], dtype=np.float32)})[0][0]


def with_torch(policy: Policy, values: list[float]) -> Call:
    modules: list[torch.nn.Module] = []
    for weight, bias in policy.layers:
        linear = torch.nn.Linear(weight.shape[1], weight.shape[0])
        linear.load_state_dict({"weight": torch.tensor(weight), "bias": torch.tensor(bias)})
        modules += [linear, torch.nn.ReLU()]
    network = torch.nn.Sequential(*modules[:-1], torch.nn.Tanh())
    inputs = torch.tensor([scale for _, scale in policy.inputs] * policy.history)
    outputs = torch.tensor([scale for _, scale in policy.outputs])

    def call() -> object:
        with torch.inference_mode():
            scaled = (torch.tensor(values) / inputs).clamp(-policy.bound, policy.bound)
            return (network(scaled) * outputs).numpy()

    return call


def durations_us(calls: dict[str, Call]) -> dict[str, list[np.ndarray]]:
    """Durations of each call in each round, the calls taking turns."""
    for call in calls.values():
        for _ in range(CALLS):
            call()
    rounds: dict[str, list[np.ndarray]] = {name: [] for name in calls}
    for _ in range(ROUNDS):
        for name, call in calls.items():
            taken = np.empty(CALLS)
            for i in range(CALLS):
                start = time.perf_counter_ns()
                call()
                taken[i] = time.perf_counter_ns() - start
            rounds[name].append(taken * 1e-3)
    return rounds


def main() -> None:
    core = min(os.sched_getaffinity(0))
    os.sched_setaffinity(0, {core})
    torch.set_num_threads(1)
    gc.disable()
    print(describe())
    print(f"onnxruntime {version('onnxruntime')}, torch {version('torch')}; on core {core} alone")
    print(f"{ROUNDS} rounds of {CALLS} calls, taking turns; each round has a p99 of its own: their")
    print("median holds what else ran on the core, the quietest round hardly any of it")
    for width, history in CASES:
        policy = random_policy(0, (width, width), SEEN, ANSWERED, history=history)
        values = policy.read(OBSERVATIONS[0]) * history
        observations = cycle(OBSERVATIONS)
        controller = SkillController(policy)
        calls: dict[str, Call] = {
            "Policy.residual": lambda policy=policy, values=values: policy.residual(values),
            "onnxruntime": with_onnxruntime(policy, values),
            "torch": with_torch(policy, values),
        }
        expected = policy.residual(values)
        for name, call in calls.items():
            if not np.allclose(np.asarray(call()), expected, rtol=1e-3, atol=1e-9):
                raise SystemExit(f"{name} answers {call()}, not {expected}")
        calls["SkillController.step"] = lambda controller=controller, seen=observations: (
            controller.step(next(seen))
        )
        print(
            f"{len(SEEN)} inputs of {history} observations, two hidden layers of {width}, "
            f"{len(ANSWERED)} outputs"
        )
        heads = f"{'p50 us':>9}{'p99 us':>9}{'quietest p99':>14}{'largest':>9}"
        print(f"{'':<24}{heads}  p50 by Policy.residual's")
        found = durations_us(calls)
        own = np.median(found["Policy.residual"])
        for name, rounds in found.items():
            p99 = [np.percentile(taken, 99) for taken in rounds]
            p50 = np.median(rounds)
            numbers = f"{p50:>9.1f}{np.median(p99):>9.1f}{min(p99):>14.1f}{np.max(rounds):>9.0f}"
            print(f"{name:<24}{numbers}  {p50 / own:.1f}x")
        print(f"SkillController.step within {BUDGET_US:g} us: {_share(found):.3%} of all calls")


def _share(found: dict[str, list[np.ndarray]]) -> float:
    return float((np.concatenate(found["SkillController.step"]) <= BUDGET_US).mean())


if __name__ == "__main__":
    main()
