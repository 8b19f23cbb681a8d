"""Logs that are cut off or altered are read as far as they are whole; none crashes the reader."""

import struct
from dataclasses import dataclass
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st
from mcap.reader import make_reader

from drivers.contract.errors import LogError
from hil.log_file import LogFile
from hil.log_reader import Log, read_log
from hil.recorder import Recorder
from tests.hil.log import scenario
from tests.hil.log.scenario import rows

HEADER_BYTES = 100
FOOTER_BYTES = 28
"""From the place of the summary to the end of the file."""
CHUNK_RAW_SIZE, CHUNK_DATA_SIZE = 25, 45
"""Where a chunk holds the sizes of its content, as it was and compressed."""


@dataclass(frozen=True)
class Whole:
    """A small log with some chunks."""

    folder: Path
    content: bytes
    log: Log
    chunk_places: list[int]
    summary_place: int


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Whole:
    path = tmp_path_factory.mktemp("damage") / "run.mcap"
    recorder = Recorder(LogFile(path, scenario.METADATA, flush_period_ns=10_000_000))
    for call in scenario.calls(seed=2, milliseconds=60):
        call.make(recorder)
    recorder.close()
    with path.open("rb") as stream:
        summary = make_reader(stream).get_summary()
    content = path.read_bytes()
    places = [chunk.chunk_start_offset for chunk in summary.chunk_indexes]
    (summary_place,) = struct.unpack_from("<Q", content, len(content) - FOOTER_BYTES)
    return Whole(path.parent, content, read_log(path), places, summary_place)


SHARES = st.floats(0.0, 1.0, exclude_max=True)
"""Of a stretch of the log; how long that is only the log itself tells."""
BYTES = st.binary(min_size=1, max_size=1)


def _place(share: float, start: int, end: int) -> int:
    return start + int(share * (end - start))


def _altered(whole: Whole, place: int, value: bytes) -> bytes:
    return whole.content[:place] + value + whole.content[place + len(value) :]


def _is_prefix(log: Log, whole: Log) -> bool:
    complete = rows(whole)
    return all(found == complete[name][: len(found)] for name, found in rows(log).items())


def _read_or_refuse(path: Path, content: bytes) -> Log | None:
    """Return the log, or None where it is refused with a text that names the file."""
    path.write_bytes(content)
    try:
        return read_log(path)
    except LogError as error:
        if str(path) not in str(error):
            raise
        return None


@given(share=SHARES)
def test_a_cut_off_log_is_read_up_to_the_cut(whole: Whole, share: float) -> None:
    length = _place(share, 0, len(whole.content))
    found = _read_or_refuse(whole.folder / "cut.mcap", whole.content[:length])
    if found is None:
        assert length < HEADER_BYTES
        return
    assert not found.complete
    assert found.ending.startswith("it has no end")
    assert _is_prefix(found, whole.log)


@given(share=SHARES, value=BYTES)
def test_an_altered_log_is_refused_or_says_that_it_is_damaged_or_says_the_same(
    whole: Whole, share: float, value: bytes
) -> None:
    place = _place(share, 0, len(whole.content))
    found = _read_or_refuse(whole.folder / "altered.mcap", _altered(whole, place, value))
    if found is not None:
        assert rows(found) == rows(whole.log) or not found.complete


@given(share=SHARES, value=BYTES)
def test_an_altered_index_does_not_matter(whole: Whole, share: float, value: bytes) -> None:
    place = _place(share, whole.summary_place, len(whole.content))
    found = _read_or_refuse(whole.folder / "altered.mcap", _altered(whole, place, value))
    assert found is not None
    assert rows(found) == rows(whole.log)


def test_a_lost_chunk_is_noticed(whole: Whole) -> None:
    for place in whole.chunk_places[1:]:
        altered = _altered(whole, place, b"\x7f")
        found = _read_or_refuse(whole.folder / "altered.mcap", altered)
        assert found is not None
        assert rows(found) != rows(whole.log)
        assert found.ending.startswith("it is damaged before byte")


def test_an_altered_record_of_metadata_is_noticed(whole: Whole) -> None:
    place = whole.content.index(b"hole_diameter_um: 1010") + len("hole_diameter_um: 10")
    found = _read_or_refuse(whole.folder / "altered.mcap", _altered(whole, place, b"2"))
    assert found is not None
    assert found.metadata["configuration"]["text"] == "hole_diameter_um: 1020\n"
    assert not found.complete
    assert found.ending.startswith("it is damaged before byte")
    assert rows(found) == rows(whole.log)


@pytest.mark.parametrize(
    ("field", "size"),
    [(CHUNK_RAW_SIZE, 2**63), (CHUNK_DATA_SIZE, 2**40), (CHUNK_DATA_SIZE, 2**63)],
)
def test_a_size_out_of_reason_is_damage(whole: Whole, field: int, size: int) -> None:
    altered = _altered(whole, whole.chunk_places[2] + field, struct.pack("<Q", size))
    found = _read_or_refuse(whole.folder / "altered.mcap", altered)
    assert found is not None
    assert found.ending.startswith("it is damaged before byte")
    assert _is_prefix(found, whole.log)
    assert found.raw_force.stamps_ns.size > 0


def test_a_longer_part_of_the_log_says_more(whole: Whole) -> None:
    counts = []
    for length in range(2000, len(whole.content), 500):
        found = _read_or_refuse(whole.folder / "cut.mcap", whole.content[:length])
        assert found is not None
        counts.append(found.raw_force.stamps_ns.size)
    assert counts == sorted(counts)
    assert len(set(counts)) > 4
