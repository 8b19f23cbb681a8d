"""Keys that a policy's file has only where the policy needs them, and the shipped file."""

import json
from pathlib import Path
from typing import Any

from safetensors.numpy import load, save

from learning.policy.expert import Approach
from learning.policy.file import load_policy, read_policy, save_policy
from learning.policy.manifest import make_manifest
from tests.learning.policy.policies import EXPERT, random_policy, same

SHIPPED = Path(__file__).parents[3] / "policies/paper.safetensors"


def manifest_in(path: Path) -> dict[str, Any]:
    content = path.read_bytes()
    header = json.loads(content[8 : 8 + int.from_bytes(content[:8], "little")])
    manifest: dict[str, Any] = json.loads(header["__metadata__"]["manifest"])
    return manifest


def test_history_and_approach_are_there_only_where_a_policy_has_them(tmp_path: Path) -> None:
    path = tmp_path / "p.safetensors"
    save_policy(random_policy(), path, {})
    plain = manifest_in(path)
    assert "history" not in plain
    assert set(plain["expert"]) == {"gain_m_N", "axial_step_m", "step_box_m"}
    expert = EXPERT._replace(approach=Approach(2e-6, 3e-5))
    save_policy(random_policy(history=3, expert=expert), path, {})
    assert manifest_in(path)["history"] == 3
    assert manifest_in(path)["expert"]["approach"] == {"step_m": 2e-6, "depth_m": 3e-5}


def test_defaults_that_are_spelt_out_are_the_same_policy(tmp_path: Path) -> None:
    path = tmp_path / "p.safetensors"
    save_policy(random_policy(), path, {})
    manifest = manifest_in(path)
    manifest["history"], manifest["expert"]["approach"] = 1, None
    path.write_bytes(save(load(path.read_bytes()), {"manifest": json.dumps(manifest)}))
    assert same(load_policy(path), random_policy())


def test_the_shipped_policy_is_written_as_it_was_read(tmp_path: Path) -> None:
    """All but the versions of the libraries, which are those that made it."""
    stored = read_policy(SHIPPED)
    assert stored.policy.history == 1
    assert stored.policy.expert.approach is None
    path = tmp_path / "paper.safetensors"
    save_policy(stored.policy, path, stored.manifest.about)
    found, shipped = manifest_in(path), manifest_in(SHIPPED)
    assert list(found) == list(shipped)
    for manifest in (found, shipped):
        del manifest["versions"], manifest["sha256"]
    assert found == shipped
    if make_manifest(stored.policy, {}).versions == stored.manifest.versions:
        for suffix in (".safetensors", ".onnx"):
            a, b = (p.with_suffix(suffix).read_bytes() for p in (path, SHIPPED))
            assert a == b
