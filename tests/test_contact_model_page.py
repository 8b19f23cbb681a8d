"""The page on the contact model says what its program measures."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]


@pytest.mark.slow
def test_the_page_holds_every_measured_number_and_no_other() -> None:
    program = [sys.executable, str(ROOT / "docs" / "contact_model_numbers.py")]
    printed = subprocess.run(program, check=True, capture_output=True, encoding="utf-8", cwd=ROOT)
    lines = printed.stdout.splitlines()
    measured = {text for line in lines for text in re.split(r" {2,}", line)[1].split(", ")}
    page = (ROOT / "docs" / "explanation" / "contact-model.md").read_text(encoding="utf-8")
    said = set(re.findall(r"`((?:below )?\d[^`]*)`", page))
    assert len(lines) > 15
    assert measured == said


@pytest.mark.slow
def test_every_figure_of_the_page_has_its_command() -> None:
    page = (ROOT / "docs" / "explanation" / "contact-model.md").read_text(encoding="utf-8")
    shown = re.findall(r"\]\(\.\./figures/([a-z-]+)\.svg\)", page)
    assert shown
    assert shown == re.findall(r"^\*`docs/make_figures\.py ([a-z-]+)`", page, re.MULTILINE)
