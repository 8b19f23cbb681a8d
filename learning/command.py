"""What the commands of this layer say when they cannot go on."""

from pathlib import Path

import typer
from rich.console import Console
from rich.text import Text

from drivers.contract.errors import ConfigurationError, TenonError

UNUSABLE = 2
"""Exit code for input that cannot be used, as of `hil/run_cell.py`."""


def refused(error: TenonError) -> typer.Exit:
    """Say on standard error what was wrong; return the end of the command, to be raised."""
    text = Text.assemble(("error:", "red"), f" {error}")
    Console(stderr=True).print(text, soft_wrap=True, highlight=False)
    return typer.Exit(UNUSABLE)


def make_folder(folder: Path) -> None:
    """Make a folder to write to; raises ConfigurationError if it cannot be."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise ConfigurationError(f"cannot create the folder {folder}: {error.strerror}") from error


def write_text(path: Path, text: str) -> None:
    """Write a whole file; raises ConfigurationError if it cannot be."""
    try:
        path.write_text(text, encoding="utf-8")
    except OSError as error:
        raise ConfigurationError(f"cannot write {path}: {error.strerror}") from error
