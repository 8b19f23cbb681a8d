"""A policy on disk: what comes back, and what is refused."""

import json
import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from safetensors.numpy import load, save

from drivers.contract.errors import PolicyError
from learning.policy.expert import Approach
from learning.policy.file import load_policy, read_policy, save_policy
from learning.policy.inputs import OUTPUT_UNITS, READINGS
from learning.policy.manifest import Manifest, content_hash, make_manifest
from tests.learning.policy.policies import EXPERT, random_policy, same, zero_policy

ABOUT: dict[str, Any] = {"seed": 7, "metrics": {"success": 1.0}, "note": "π", "none": None}
ROOT = Path(__file__).parents[3]


@settings(max_examples=40)
@given(
    st.integers(0, 2**32 - 1),
    st.lists(st.integers(1, 12), max_size=3),
    st.lists(st.sampled_from(sorted(READINGS)), min_size=1, unique=True),
    st.lists(st.sampled_from(sorted(OUTPUT_UNITS)), min_size=1, unique=True),
    st.floats(1e-3, 10.0),
    st.floats(0.0, 1.0),
    st.integers(1, 5),
    st.none() | st.builds(Approach, st.floats(1e-9, 5e-5), st.floats(1e-9, 1e-3)),
)
def test_there_and_back(
    tmp_path_factory: pytest.TempPathFactory,
    seed: int,
    hidden: list[int],
    seen: list[str],
    answered: list[str],
    bound: float,
    gain_m_N: float,
    history: int,
    approach: Approach | None,
) -> None:
    expert = EXPERT._replace(gain_m_N=gain_m_N, approach=approach)
    policy = random_policy(
        seed, tuple(hidden), tuple(seen), tuple(answered), bound, expert, history
    )
    path = tmp_path_factory.getbasetemp() / "there.safetensors"
    save_policy(policy, path, ABOUT)
    stored = read_policy(path)
    assert same(stored.policy, policy)
    assert stored.manifest.about == ABOUT
    values = np.random.default_rng(seed).normal(0.0, 1.0, policy.n_values)
    assert (stored.policy.residual(values) == policy.residual(values)).all()


def test_the_same_policy_makes_the_same_bytes(tmp_path: Path) -> None:
    paths = [tmp_path / f"{name}.safetensors" for name in "ab"]
    for path in paths:
        save_policy(random_policy(3), path, ABOUT)
    for suffix in (".safetensors", ".onnx"):
        a, b = (path.with_suffix(suffix).read_bytes() for path in paths)
        assert a == b


def test_the_manifest_tells_all_and_tools_can_read_it(tmp_path: Path) -> None:
    path = tmp_path / "p.safetensors"
    save_policy(random_policy(), path, ABOUT)
    content = path.read_bytes()
    header = json.loads(content[8 : 8 + int.from_bytes(content[:8], "little")])
    manifest = json.loads(header["__metadata__"]["manifest"])
    assert manifest["inputs"][3] == {"name": "depth", "unit": "m", "scale": 2.3e-3}
    assert manifest["outputs"][0] == {"name": "step_x", "unit": "m", "scale": 2e-5}
    assert manifest["expert"]["step_box_m"] == [2e-5, 2e-5, 6e-5]
    assert manifest["about"] == ABOUT
    assert {"python", "numpy", "torch", "onnx", "tenon"} <= set(manifest["versions"])
    assert header["layer1.weight"]["shape"] == [16, 16]


@pytest.fixture
def path(tmp_path: Path) -> Path:
    """A good policy."""
    path = tmp_path / "paper.safetensors"
    save_policy(random_policy(), path, ABOUT)
    return path


def refusal(path: Path) -> str:
    with pytest.raises(PolicyError) as caught:
        load_policy(path)
    text = str(caught.value)
    assert text.startswith(f"{path}: ")
    return text.removeprefix(f"{path}: ")


def test_no_file(tmp_path: Path) -> None:
    assert refusal(tmp_path / "nowhere.safetensors") == "cannot be read: No such file or directory"
    assert refusal(tmp_path) == "cannot be read: Is a directory"


def test_cut_short_anywhere_or_longer_than_it_was(path: Path) -> None:
    content = path.read_bytes()
    for length in (0, 1, 7, 8, 9, 500, len(content) // 2, len(content) - 1):
        path.write_bytes(content[:length])
        assert refusal(path).startswith("is damaged or no safetensors file: ")
    path.write_bytes(content + b"\0")
    assert refusal(path).startswith("is damaged or no safetensors file: ")


def test_any_flipped_bit_is_noticed(path: Path) -> None:
    content = path.read_bytes()
    policy = load_policy(path)
    generator = np.random.default_rng(1)
    places = [*range(12), *generator.integers(0, len(content), 300), len(content) - 1]
    for place in places:
        spoiled = bytearray(content)
        spoiled[place] ^= 1 << int(generator.integers(8))
        path.write_bytes(spoiled)
        try:
            found = load_policy(path)
        except PolicyError:
            continue
        assert same(found, policy), f"byte {place}"


Spoil = Callable[[dict[str, Any], dict[str, np.ndarray]], object]


def rewritten(path: Path, spoil: Spoil, is_signed: bool) -> None:
    """Spoil manifest and tensors, and sign the result anew if the writer is to be believed."""
    content = path.read_bytes()
    header = json.loads(content[8 : 8 + int.from_bytes(content[:8], "little")])
    manifest = json.loads(header["__metadata__"]["manifest"])
    tensors = {name: array.copy() for name, array in load(content).items()}
    spoil(manifest, tensors)
    if is_signed:
        pairs = tuple(
            (tensors[f"layer{i}.weight"], tensors[f"layer{i}.bias"])
            for i in range(len(tensors) // 2)
        )
        signed = Manifest.model_validate_json(json.dumps(manifest))
        manifest["sha256"] = content_hash(signed, pairs)
    path.write_bytes(save(tensors, {"manifest": json.dumps(manifest)}))


@pytest.mark.parametrize(
    "spoil",
    [
        lambda manifest, tensors: tensors["layer0.weight"].__setitem__((0, 0), 0.5),
        lambda manifest, tensors: tensors["layer2.bias"].__setitem__(1, np.nan),
        lambda manifest, tensors: manifest["inputs"][0].update(scale=0.14),
        lambda manifest, tensors: manifest["inputs"].reverse(),
        lambda manifest, tensors: manifest["expert"].update(gain_m_N=8e-4),
        lambda manifest, tensors: manifest["expert"].update(
            approach={"step_m": 1e-6, "depth_m": 1e-5}
        ),
        lambda manifest, tensors: manifest.update(history=2),
        lambda manifest, tensors: manifest.update(bound=9.0),
        lambda manifest, tensors: manifest["about"].update(seed=8),
        lambda manifest, tensors: manifest["versions"].update(numpy="1"),
        lambda manifest, tensors: manifest.update(sha256="0" * 64),
    ],
)
def test_altered(path: Path, spoil: Spoil) -> None:
    rewritten(path, spoil, is_signed=False)
    assert refusal(path).startswith("has been altered: its content has SHA-256 ")


@pytest.mark.parametrize(
    ("spoil", "message"),
    [
        (
            lambda manifest, tensors: tensors["layer0.weight"].__setitem__((0, 0), np.nan),
            "weight of layer 0 has 1 values that are not finite in single precision; all must be",
        ),
        (
            lambda manifest, tensors: manifest["inputs"][0].update(name="forse_x"),
            "input 'forse_x' is not known; valid are force_x, force_y, force_z, torque_x, "
            "torque_y, torque_z, depth, turn_x, turn_y, displacement_x, displacement_y, "
            "displacement_z",
        ),
        (
            lambda manifest, tensors: manifest["outputs"][2].update(unit="um"),
            "unit of output 'step_z' is 'um'; it must be 'm'",
        ),
        (
            lambda manifest, tensors: tensors.update({"layer1.bias": np.zeros(3, np.float32)}),
            "bias of layer 1 has shape (3,); it must be (16,)",
        ),
        (
            lambda manifest, tensors: tensors.update({"layer1.bias": np.zeros(16)}),
            "tensor layer1.bias is float64; it must be float32",
        ),
        (
            lambda manifest, tensors: tensors.clear(),
            "there is no layer; there must be at least one",
        ),
        (
            lambda manifest, tensors: manifest["expert"].update(axial_step_m=1.0),
            "axial_step_m of the expert is 1.0; "
            "it must be at least 0 and at most 6e-05, the step box along z",
        ),
        (
            lambda manifest, tensors: manifest["expert"].update(
                approach={"step_m": 6e-5, "depth_m": 1e-5}
            ),
            "step_m of the expert's approach is 6e-05; it must be greater than 0 and at most "
            "5e-05, the expert's axial_step_m",
        ),
        (
            lambda manifest, tensors: manifest.update(history=65),
            "history is 65; it must be a whole number from 1 to 64",
        ),
    ],
)
def test_signed_but_not_valid(path: Path, spoil: Spoil, message: str) -> None:
    rewritten(path, spoil, is_signed=True)
    assert refusal(path) == message


@pytest.mark.parametrize(
    ("spoil", "message"),
    [
        (lambda manifest, tensors: manifest.update(format=2), "its manifest is not valid: format:"),
        (lambda manifest, tensors: manifest.pop("bound"), "its manifest is not valid: bound: Fiel"),
        (lambda manifest, tensors: manifest.update(extra=1), "its manifest is not valid: extra: E"),
        (
            lambda manifest, tensors: manifest.update(hidden_activation="elu"),
            "its manifest is not valid: hidden_activation: Input should be 'relu'",
        ),
        (
            lambda manifest, tensors: manifest.update(history=1.5),
            "its manifest is not valid: history: Input should be a valid integer",
        ),
        (
            lambda manifest, tensors: manifest["expert"].update(approach={"step_m": 1e-6}),
            "its manifest is not valid: expert.approach.depth_m: Field required",
        ),
        (
            lambda manifest, tensors: manifest["inputs"][1].update(scale="0.1"),
            "its manifest is not valid: inputs.1.scale: Input should be a valid number",
        ),
        (
            lambda manifest, tensors: manifest.update(bound=float("nan")),
            "its manifest is not valid: bound: Input should be a finite number",
        ),
        (
            lambda manifest, tensors: tensors.pop("layer1.bias"),
            "has the tensors layer0.bias, layer0.weight, layer1.weight, layer2.bias, layer2.weight",
        ),
    ],
)
def test_of_another_form(path: Path, spoil: Spoil, message: str) -> None:
    rewritten(path, spoil, is_signed=False)
    assert refusal(path).startswith(message)


def test_another_safetensors_file_is_no_policy(path: Path) -> None:
    path.write_bytes(save({"layer0.weight": np.zeros((3, 4), np.float32)}))
    assert refusal(path) == "has no manifest in its metadata, so it holds no policy of Tenon"
    header = b'{"layer0.weight":{"dtype":"BF16","shape":[1],"data_offsets":[0,2]}}'
    path.write_bytes(len(header).to_bytes(8, "little") + header + b"\0\0")
    assert refusal(path) == "has a tensor of type 'BF16'; all must be float32 (F32)"
    path.write_bytes(save({}, {"manifest": "not JSON"}))
    assert refusal(path).startswith("its manifest is not valid: it: Invalid JSON")


@pytest.mark.parametrize(
    ("about", "message"),
    [
        ({"metrics": {"mean": float("nan")}}, "the manifest cannot be written as JSON"),
        ({"path": Path()}, "the manifest cannot be written as JSON"),
        ({"note": "\ud800"}, "the manifest cannot be written as JSON"),
    ],
)
def test_what_json_cannot_hold_is_refused_before_anything_is_written(
    tmp_path: Path, about: dict[str, Any], message: str
) -> None:
    with pytest.raises(PolicyError, match=message):
        save_policy(zero_policy(), tmp_path / "p.safetensors", about)
    assert list(tmp_path.iterdir()) == []


def test_where_it_cannot_be_written(tmp_path: Path) -> None:
    with pytest.raises(PolicyError, match=r"its name must end in \.safetensors"):
        save_policy(zero_policy(), tmp_path / "p.pt", {})
    with pytest.raises(PolicyError, match="cannot be written: No such file or directory"):
        save_policy(zero_policy(), tmp_path / "nowhere" / "p.safetensors", {})


AT_RUN_TIME = """
import pickle, sys
def refused(*arguments, **keywords):
    raise SystemExit("pickle was used")
for name in ("load", "loads", "dump", "dumps", "Unpickler", "Pickler"):
    setattr(pickle, name, refused)
from pathlib import Path
from learning.policy.file import load_policy
load_policy(Path(sys.argv[1])).residual([0.0] * 4)
heavy = {"torch", "onnx", "onnxruntime", "stable_baselines3", "tensorboard", "gymnasium"}
print(sorted(heavy & set(sys.modules)))
"""


def test_no_training_library_is_loaded_and_no_pickle_used_at_run_time(path: Path) -> None:
    """numpy itself imports pickle, so that its presence alone says nothing."""
    done = subprocess.run(
        [sys.executable, "-c", AT_RUN_TIME, str(path)],
        cwd=ROOT,
        env=os.environ | {"PYTHONPATH": "."},
        capture_output=True,
        text=True,
        check=False,
    )
    assert (done.returncode, done.stdout, done.stderr) == (0, "[]\n", "")


def test_the_hash_covers_manifest_and_weights() -> None:
    manifest = make_manifest(random_policy(), ABOUT)
    assert manifest.sha256 == content_hash(manifest, random_policy().layers)
    assert manifest.sha256 != content_hash(manifest, random_policy(1).layers)
