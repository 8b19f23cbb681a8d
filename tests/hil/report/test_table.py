"""The table for the terminal: it fits, and it says what the summary holds."""

import io
from collections.abc import Callable

import pytest
from rich.console import Console

from controllers.messages import Reason, Rule, Severity, SkillPhase
from hil.summary import RunSummary, render_table, summarise
from tests.hil.report.runs import RunWriter

OVERLOAD = Reason(Rule.FORCE, Severity.STOP, "f_x = 70.3 mN, limit 70.0 mN")


def printed(summary: RunSummary, colour: bool = False) -> str:
    stream = io.StringIO()
    console = Console(
        file=stream, width=80, force_terminal=colour, color_system="standard" if colour else None
    )
    console.print(render_table(summary))
    return stream.getvalue()


def cells(text: str, first: str) -> list[str]:
    line = next(line for line in text.splitlines() if line.split()[:1] == [first])
    return line.split()


def test_thirty_rows_with_large_numbers_fit_into_80_columns(
    write_run: Callable[..., RunWriter],
) -> None:
    run = write_run(asked=30)
    for number in range(1, 30):
        run.insertion(number, radial_mN=9999.9, end=SkillPhase.FAILED)
    run.phase(30, SkillPhase.APPROACH)
    text = printed(summarise(run.close()))
    assert max(map(len, text.splitlines())) <= 80
    assert "…" not in text
    for number in range(1, 30):
        assert cells(text, str(number))[1] == "failed"
    assert cells(text, "30")[1:3] == ["not", "finished"]


def test_a_row_in_um_mN_and_s(write_run: Callable[..., RunWriter]) -> None:
    run = write_run(bias_mN=(5.0, 0.0, 0.0))
    run.insertion(1, radial_mN=60.0)
    text = printed(summarise(run.close()))
    # Five samples of 60 mN among seven: one at 0.5 mm, 1.0, 1.5, 2.0 and 2.3, and two of nothing.
    share, mean = "16.7", "50.0"
    numbers = ["5", "2300", "0.08", "60.0", "0.0", "1.0", mean, share, "60.0", "4.00"]
    assert cells(text, "1") == ["1", "done", *numbers]
    assert cells(text, "all")[1:3] == ["1/1", "done"]
    assert cells(text, "all")[4:] == ["0.1", *numbers[3:]]
    assert "1 of 1 inserted (100.0 %; 95 % interval 20.7 to 100.0 %)." in text
    assert "6 steps proposed, hardest verdicts: 6 passed." in text


@pytest.mark.parametrize("colour", [False, True])
def test_outcomes_are_words_and_colour_only_adds(
    write_run: Callable[..., RunWriter], colour: bool
) -> None:
    run = write_run(asked=3)
    run.insertion(1)
    run.insertion(2, end=SkillPhase.FAILED)
    text = printed(summarise(run.close()), colour)
    assert ("\x1b[" in text) is colour
    for words in ("done", "failed", "Insertion 2: failed, it did not fit.", "2 of the 3 "):
        assert words in text


def test_reasons_are_printed_as_they_are(write_run: Callable[..., RunWriter]) -> None:
    run = write_run()
    run.phase(1, SkillPhase.FAILED, "value [bold]7[/] is outside [0, 5]")
    assert "value [bold]7[/] is outside [0, 5]" in printed(summarise(run.close()))


def test_a_stop_stands_below_the_table(write_run: Callable[..., RunWriter]) -> None:
    run = write_run()
    run.phase(1, SkillPhase.INSERT)
    run.step()
    run.sample((70.3, 0.0, 0.0), 50.0, OVERLOAD)
    run.phase(1, SkillPhase.FAILED, str(OVERLOAD))
    text = " ".join(printed(summarise(run.close())).split())
    assert "stopped the cell 0.01 s into insertion 1: a force on the part exceeded" in text
    assert "1 steps proposed, hardest verdicts: 1 stop." in text


def test_a_log_without_an_insertion(write_run: Callable[..., RunWriter]) -> None:
    text = printed(summarise(write_run(asked=4).close()))
    assert "No insertion was begun." in text
    assert "0 of the 4 insertions asked for were begun." in text
