"""A policy's file while it is written: the old one or the new one, whatever happens."""

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from drivers.contract.errors import PolicyError
from learning.policy.file import load_policy, save_policy
from tests.learning.policy.policies import random_policy, same

ROOT = Path(__file__).parents[3]


@pytest.fixture
def path(tmp_path: Path) -> Path:
    """A good policy."""
    path = tmp_path / "paper.safetensors"
    save_policy(random_policy(), path, {})
    return path


KILLED = """
import os, signal, sys
from pathlib import Path
from learning.policy.file import save_policy
from tests.learning.policy.policies import random_policy
count = 0
def die_at_the_nth(real):
    def call(*arguments):
        global count
        count += 1
        if count > int(sys.argv[2]):
            os.kill(os.getpid(), signal.SIGKILL)
        return real(*arguments)
    return call
os.fsync = die_at_the_nth(os.fsync)
Path.replace = die_at_the_nth(Path.replace)
save_policy(random_policy(99), Path(sys.argv[1]), {})
"""


@pytest.mark.parametrize("survived", range(6))
def test_a_killed_writer_leaves_the_old_policy_or_the_new_one(path: Path, survived: int) -> None:
    """Killed before each fsync and each renaming of the two files, the policy's being the last."""
    killed = subprocess.run(
        [sys.executable, "-c", KILLED, str(path), str(survived)],
        cwd=ROOT,
        env=os.environ | {"PYTHONPATH": "."},
        check=False,
    )
    assert killed.returncode == -signal.SIGKILL
    expected = random_policy(99) if survived == 5 else random_policy()
    assert same(load_policy(path), expected)


def test_nothing_is_left_beside_the_files_when_writing_fails(
    path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def full(descriptor: int) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(PolicyError, match="cannot be written: No space left on device"):
        save_policy(random_policy(99), path, {})
    assert sorted(p.name for p in path.parent.iterdir()) == ["paper.onnx", "paper.safetensors"]
    assert same(load_policy(path), random_policy())
