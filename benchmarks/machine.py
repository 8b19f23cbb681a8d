"""What a benchmark says of the machine it ran on."""

import os
import platform
import sys
from importlib.metadata import version
from pathlib import Path


def cores() -> int:
    """Return how many cores this process may use."""
    return len(os.sched_getaffinity(0))


def describe() -> str:
    """Return processor, cores, Python, numpy and the command in a few lines."""
    cpu = platform.processor() or "unknown processor"
    info = Path("/proc/cpuinfo")
    if info.exists():
        names = [line for line in info.read_text().splitlines() if line.startswith("model name")]
        cpu = names[0].split(":", 1)[1].strip() if names else cpu
    return (
        f"machine: {cpu}, {cores()} cores, {platform.system()} {platform.release()}\n"
        f"python {platform.python_version()}, numpy {version('numpy')}\n"
        f"command: python {' '.join(sys.orig_argv[1:])}"
    )
