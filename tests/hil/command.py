"""Starts the command `hil/run_cell.py` as its users do."""

import os
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]
MOCK = "config/mock_cell.yaml"


def start(*arguments: str) -> subprocess.Popen[str]:
    """Start the command in a process group of its own."""
    return subprocess.Popen(
        [sys.executable, "hil/run_cell.py", *arguments],
        cwd=ROOT,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env=os.environ | {"COLUMNS": "100", "TERM": "dumb"},
        start_new_session=True,
    )


def run(*arguments: str) -> tuple[int, str, str]:
    """Return exit code, output and errors of the command."""
    process = start(*arguments)
    out, err = process.communicate(timeout=600)
    return process.returncode, out, err
