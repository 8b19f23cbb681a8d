"""The command `python hil/report.py`."""

import resource
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from drivers.contract.errors import LogError
from hil.report import write_report
from tests.hil.report.runs import RunWriter

ROOT = Path(__file__).parents[3]


def run_report(*arguments: Path | str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "hil/report.py", *map(str, arguments)]
    return subprocess.run(command, cwd=ROOT, capture_output=True, text=True, check=False)


@pytest.mark.slow
def test_the_page_goes_beside_the_log_or_where_it_is_told(
    write_run: Callable[..., RunWriter], tmp_path: Path
) -> None:
    run = write_run(name="monday.mcap")
    run.insertion(1)
    run.close()
    cut = tmp_path / "cut.mcap"
    cut.write_bytes(run.path.read_bytes()[:-1000])
    for arguments, page in (
        ((run.path,), tmp_path / "monday.html"),
        ((cut, "--output", tmp_path / "x.html", "--compare", run.path), tmp_path / "x.html"),
    ):
        done = run_report(*arguments)
        assert done.returncode == 0, done.stderr
        assert "</html>" in page.read_text("utf-8")
        assert done.stdout == f"Report: {page}\n"


@pytest.mark.slow
def test_unusable_input_is_told_in_one_line(tmp_path: Path) -> None:
    torn = tmp_path / "torn.mcap"
    torn.write_bytes(b"\x89MCAP0\r\n")
    for log in (torn, tmp_path / "none.mcap"):
        done = run_report(log)
        assert done.returncode == 2
        assert done.stderr.startswith("error: ")
        assert done.stderr.count("\n") == 1
        assert str(log) in done.stderr
        assert not log.with_suffix(".html").exists()


@pytest.mark.slow
@pytest.mark.parametrize("is_compared", [False, True])
def test_a_page_never_takes_the_place_of_a_log(
    write_run: Callable[..., RunWriter], tmp_path: Path, is_compared: bool
) -> None:
    run, other = write_run(), write_run()
    run.close()
    other.close()
    page = tmp_path / "page.html"
    page.symlink_to(other.path if is_compared else run.path)
    before = page.read_bytes()
    done = run_report(run.path, "--output", page, "--compare", other.path)
    assert done.returncode == 2
    assert done.stderr == f"error: the report {page} would overwrite the log that it is made from\n"
    assert page.read_bytes() == before


@pytest.mark.slow
def test_a_log_that_is_named_like_its_page_is_kept(write_run: Callable[..., RunWriter]) -> None:
    run = write_run(name="run.html")
    run.close()
    before = run.path.read_bytes()
    assert run_report(run.path).returncode == 2
    assert run.path.read_bytes() == before


def test_a_page_that_cannot_be_finished_leaves_the_one_before(
    write_run: Callable[..., RunWriter], tmp_path: Path
) -> None:
    log = write_run().close()
    page = tmp_path / "page.html"
    page.write_text("the page before")
    files = set(tmp_path.iterdir())
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (1000, limits[1]))
    try:
        with pytest.raises(LogError, match=r"page\.html: File too large"):
            write_report(log, page)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
    assert page.read_text() == "the page before"
    assert set(tmp_path.iterdir()) == files
