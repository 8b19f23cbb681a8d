"""The report's page: whole, by itself, the same each time, and not to be fooled by a log."""

import re
from collections.abc import Callable
from pathlib import Path

import pytest

from controllers.messages import Reason, Rule, Severity, SkillPhase
from drivers.contract.errors import LogError
from hil.report import write_report
from tests.hil.report.page import report
from tests.hil.report.runs import RunWriter

SCRIPT = '</p></svg><script>alert("1")</script>&'


def test_a_whole_run_has_every_section(write_run: Callable[..., RunWriter], tmp_path: Path) -> None:
    run = write_run(asked=2, name="monday.mcap")
    run.insertion(1)
    run.insertion(2, radial_mN=50.0)
    page = report(run.close(), tmp_path)
    assert page.headings == [
        "Insertions",
        "Force along an insertion",
        "How large the forces were",
        "Force over depth, all insertions",
        "Supervisor",
        "Loop timing",
        "Words",
    ]
    for words in ("monday.mcap", "two_walls", "expert", "2 of 2 inserted (100.0 %;"):
        assert words in page.text
    assert page.banner == []
    assert page.headline == "good"


@pytest.mark.slow
def test_the_page_needs_nothing_else(write_run: Callable[..., RunWriter], tmp_path: Path) -> None:
    run = write_run(busy_ns=500_000)
    run.insertion(1, end=SkillPhase.FAILED)
    source = report(run.close(), tmp_path).source
    without_namespaces = re.sub(r'xmlns(:\w+)?="[^"]*"', "", source)
    assert "//" not in without_namespaces
    assert not re.search(r"<(script|link|img|iframe|object|image)\b|@import|\son\w+=", source)


@pytest.mark.slow
def test_figures_do_not_borrow_parts_from_one_another(
    write_run: Callable[..., RunWriter], tmp_path: Path
) -> None:
    run = write_run(busy_ns=500_000)
    run.insertion(1, end=SkillPhase.FAILED)
    page = report(run.close(), tmp_path)
    assert len(page.ids) == len(set(page.ids)) > 100
    assert page.references
    assert page.references <= set(page.ids)


@pytest.mark.slow
def test_the_same_log_gives_the_same_bytes(
    write_run: Callable[..., RunWriter], tmp_path: Path
) -> None:
    run = write_run(busy_ns=500_000)
    run.insertion(1)
    run.insertion(2, end=SkillPhase.FAILED)
    log = run.close()
    for name in ("a.html", "b.html"):
        write_report(log, tmp_path / name)
    assert (tmp_path / "a.html").read_bytes() == (tmp_path / "b.html").read_bytes()


@pytest.mark.slow
def test_one_failure_is_enough_for_a_bad_headline(
    write_run: Callable[..., RunWriter], tmp_path: Path
) -> None:
    run = write_run(asked=2)
    run.insertion(1, end=SkillPhase.FAILED)
    run.insertion(2)
    page = report(run.close(), tmp_path)
    assert page.headline == "bad"
    assert page.banner == []


def test_text_from_the_log_is_only_text(
    write_run: Callable[..., RunWriter], tmp_path: Path
) -> None:
    stop = Reason(Rule.FORCE, Severity.STOP, SCRIPT)
    run = write_run(
        asked=2, controller=SCRIPT, part=f"name: '{SCRIPT}'\nholes: []", name="<b>.mcap"
    )
    run.sample((0.0, 0.0, 0.0), 0.0)
    run.phase(1, SkillPhase.INSERT)
    run.contact(SCRIPT)
    run.step(stop, is_sent=False)
    run.sample((70.3, 0.0, 0.0), 50.0, stop)
    run.phase(1, SkillPhase.FAILED, SCRIPT)
    run.reset(SCRIPT)
    log = run.close()
    page = report(log, tmp_path, compared_with=log)
    assert "<script" not in page.source
    assert SCRIPT in page.text
    assert any(SCRIPT in sentence for sentence in page.banner)


def test_a_log_without_an_insertion(write_run: Callable[..., RunWriter], tmp_path: Path) -> None:
    page = report(write_run(asked=3).close(), tmp_path)
    assert "The log holds no insertion." in page.text
    assert page.headings == ["Insertions", "Supervisor", "Loop timing", "Words"]
    assert page.banner == [
        "The log does not say why the run ended.",
        "0 of the 3 insertions asked for were begun.",
    ]


@pytest.mark.slow
def test_an_insertion_of_one_sample(write_run: Callable[..., RunWriter], tmp_path: Path) -> None:
    run = write_run()
    run.phase(1, SkillPhase.INSERT)
    run.sample((1.0, 1.0, 1.0), 0.0)
    page = report(run.close(), tmp_path)
    assert "not finished" in page.text
    assert "Force along an insertion" in page.headings


@pytest.mark.slow
def test_an_enormous_force_is_drawn_too(
    write_run: Callable[..., RunWriter], tmp_path: Path
) -> None:
    run = write_run()
    run.insertion(1, radial_mN=1e9)
    assert "1000000000.0" in report(run.close(), tmp_path).text


def test_a_page_that_cannot_be_written(write_run: Callable[..., RunWriter], tmp_path: Path) -> None:
    with pytest.raises(LogError, match=r"cannot write the report .*nowhere.*: No such file"):
        write_report(write_run().close(), tmp_path / "nowhere" / "report.html")
