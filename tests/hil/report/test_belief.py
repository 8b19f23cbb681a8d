"""What the report says of beliefs: against the truth where that is known, and nothing without."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from controllers.messages import SkillPhase
from hil.figures import belief_figure, true_pose_errors
from hil.summary import summarise
from tests.hil.report.page import report
from tests.hil.report.runs import RunWriter

pytestmark = pytest.mark.slow

NAME = "Believed and true offset and tilt"


def believing(run: RunWriter, with_truth: bool) -> RunWriter:
    """Two beliefs of an offset that is really 0: one of them 1, one 3 deviations off."""
    run.sample((0.0, 0.0, 0.0), 100.0)
    run.phase(1, SkillPhase.INSERT)
    for depth_um, offset_um in ((100.0, 2.0), (600.0, -6.0)):
        run.sample((0.0, 0.0, 0.0), depth_um)
        if with_truth:
            run.contact("c")
        run.believe(offset_um, 2.0)
    run.sample((0.0, 0.0, 0.0), 700.0)
    run.phase(1, SkillPhase.DONE)
    return run


def test_beliefs_are_drawn_and_held_against_the_truth(
    write_run: Callable[..., RunWriter], tmp_path: Path
) -> None:
    page = report(believing(write_run(), with_truth=True).close(), tmp_path)
    figure = page.figure(NAME)
    for label in ("offset (um)", "tilt (deg)", "believed", "2 standard deviations", "true"):
        assert label in figure
    # seven of the eight values: of x and y, offset and tilt, twice
    assert "within two standard deviations for 88 % of" in " ".join(page.text.split())


def test_without_truth_only_the_beliefs_are_shown(
    write_run: Callable[..., RunWriter], tmp_path: Path
) -> None:
    log = believing(write_run(), with_truth=False).close()
    page = report(log, tmp_path)
    assert "believed" in page.figure(NAME)
    assert "within two standard deviations" not in page.text
    assert np.isnan(true_pose_errors(log, list(log.beliefs))).all()
    assert belief_figure(log, summarise(log).facts, 1)


def test_without_beliefs_there_is_no_such_section(
    write_run: Callable[..., RunWriter], tmp_path: Path
) -> None:
    run = write_run()
    run.insertion(1)
    assert "What the controller believed" not in report(run.close(), tmp_path).text
