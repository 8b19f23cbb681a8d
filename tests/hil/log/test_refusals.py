"""What the recorder cannot write and the reader cannot read: an error that names the file."""

import io
import subprocess
import sys
import textwrap
from pathlib import Path

import pytest
from mcap.writer import Writer

from controllers.messages import PhaseChange, SkillPhase
from drivers.contract.errors import LogError
from drivers.contract.messages import ForceSample
from hil import ros_messages, ros_types
from hil.log_file import LogFile
from hil.log_process import LogProcess
from hil.log_reader import read_log
from hil.recorder import Recorder
from tests.hil.log import scenario

SAMPLE = ForceSample(1, 2, 3, (0.0,) * 6)
LogKind = type[LogFile] | type[LogProcess]
each_kind = pytest.mark.parametrize("kind", [LogFile, LogProcess])


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return tmp_path / "run.mcap"


def _error_text(path: Path) -> str:
    with pytest.raises(LogError) as caught:
        read_log(path)
    text = str(caught.value)
    assert str(path) in text
    return text.replace(str(path), "")


@each_kind
def test_a_log_is_never_overwritten(kind: LogKind, path: Path) -> None:
    path.write_text("something of worth")
    with pytest.raises(LogError, match=r"run\.mcap exists .* move it away or choose another name"):
        Recorder(kind(path, {}))
    assert path.read_text() == "something of worth"


@each_kind
def test_a_folder_must_exist(kind: LogKind, tmp_path: Path) -> None:
    with pytest.raises(LogError, match=r"none/run\.mcap: No such file or directory"):
        Recorder(kind(tmp_path / "none" / "run.mcap", {}))


@each_kind
def test_a_closed_log_takes_nothing_more(kind: LogKind, path: Path) -> None:
    recorder = Recorder(kind(path, {}))
    recorder.close()
    recorder.close()
    content = path.read_bytes()
    with pytest.raises(LogError, match=r"run\.mcap is closed"):
        recorder.on_sample(SAMPLE)
    assert path.read_bytes() == content


FULL_DISK = """
    import resource, sys
    from pathlib import Path
    from drivers.contract.errors import LogError
    from hil.log_file import LogFile
    from hil.log_process import LogProcess
    from hil.recorder import Recorder
    from tests.hil.log import scenario

    kind = {"LogFile": LogFile, "LogProcess": LogProcess}[sys.argv[1]]
    path, limit, milliseconds = Path(sys.argv[2]), int(sys.argv[3]), int(sys.argv[4])
    resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))

    def attempt(call):
        try:
            call()
        except LogError as error:
            print(error)
            return False
        return True

    recorders = []
    if attempt(lambda: recorders.append(Recorder(kind(path, scenario.METADATA)))):
        recorder = recorders[0]
        for call in scenario.calls(seed=4, milliseconds=milliseconds):
            if not attempt(lambda: call.make(recorder)):
                attempt(lambda: call.make(recorder))
                break
        attempt(recorder.close)
"""


def _fill_disk(kind: LogKind, path: Path, limit: int, milliseconds: int) -> list[str]:
    """Record a run where only `limit` bytes can be written; return the errors."""
    command = [sys.executable, "-W", "error", "-X", "dev", "-c", textwrap.dedent(FULL_DISK)]
    arguments = [kind.__name__, str(path), str(limit), str(milliseconds)]
    done = subprocess.run([*command, *arguments], check=True, capture_output=True, text=True)
    assert done.stderr == ""
    assert path.stat().st_size == limit
    return done.stdout.splitlines()


@each_kind
def test_a_full_disk_is_an_error_and_keeps_what_was_recorded(kind: LogKind, path: Path) -> None:
    errors = _fill_disk(kind, path, limit=30_000, milliseconds=500)
    text = f"cannot write the log {path}: File too large; what it held until then can be read"
    assert set(errors) == {text}
    # a writer that lags says so once, when the log is closed
    assert len(errors) == 2 or (kind is LogProcess and len(errors) == 1)

    recorder = Recorder(LogFile(path.with_name("whole.mcap"), scenario.METADATA))
    for call in scenario.calls(seed=4, milliseconds=500):
        call.make(recorder)
    recorder.close()
    expected = scenario.rows(read_log(path.with_name("whole.mcap")))
    log = read_log(path)
    assert not log.complete
    assert log.metadata == scenario.METADATA
    assert log.raw_force.stamps_ns.size > 50
    for name, rows in scenario.rows(log).items():
        assert rows == expected[name][: len(rows)]


@pytest.mark.slow
@each_kind
def test_a_disk_without_room_for_the_metadata(kind: LogKind, path: Path) -> None:
    (text,) = _fill_disk(kind, path, limit=100, milliseconds=10)
    assert "File too large" in text


@pytest.mark.slow
@each_kind
def test_a_disk_that_is_full_when_the_log_is_closed(kind: LogKind, path: Path) -> None:
    (text,) = _fill_disk(kind, path, limit=12_000, milliseconds=30)
    assert "File too large" in text
    assert read_log(path).raw_force.stamps_ns.size == 30


def test_no_such_log(path: Path) -> None:
    assert "No such file" in _error_text(path)


def test_a_folder_is_no_log(tmp_path: Path) -> None:
    assert "Is a directory" in _error_text(tmp_path)


@pytest.mark.parametrize("content", [b"", b"\x89MCAP0", b"SQLite format 3\0" * 9])
def test_not_an_mcap_file(path: Path, content: bytes) -> None:
    path.write_bytes(content)
    assert "not an MCAP file" in _error_text(path)


def _foreign(
    path: Path,
    profile: str,
    topic: str,
    name: str,
    schema: str,
    metadata: dict[str, str] | None,
    message: bytes = b"\0\1\0\0",
) -> None:
    """Write a log by hand."""
    stream = io.BytesIO()
    writer = Writer(stream)
    writer.start(profile=profile)
    if metadata is not None:
        writer.add_metadata("tenon_log", metadata)
    channel = writer.register_channel(
        topic, "cdr", writer.register_schema(name, "ros2msg", schema.encode())
    )
    writer.add_message(channel, 0, message, 0)
    writer.finish()
    path.write_bytes(stream.getvalue())


def test_an_mcap_file_of_another_kind(path: Path) -> None:
    _foreign(path, "", "/scan", "Scan", "uint8 x\n", None)
    assert "no ROS 2 messages" in _error_text(path)


def test_a_ros_bag_of_somebody_else(path: Path) -> None:
    _foreign(path, "ros2", "/scan", "my_msgs/msg/Scan", "uint8 x\n", None)
    assert "no record 'tenon_log'" in _error_text(path)


@pytest.mark.parametrize("version", ["1", "3"])
def test_a_log_of_another_format(path: Path, version: str) -> None:
    """Whatever its messages look like, it is the format that is told."""
    _foreign(path, "ros2", "/skill/phase", "x/msg/Y", "bool x\n", {"version": version})
    assert f"log format {version}; this program reads 2" in _error_text(path)


@pytest.mark.parametrize(
    ("name", "schema"),
    [
        ("std_msgs/msg/String", "string data\n"),
        ("tenon_msgs/msg/PhaseChange", "std_msgs/Header header\nuint32 insertion\n"),
        ("tenon_msgs/msg/PhaseChange", "(not a definition)"),
    ],
)
def test_a_topic_with_a_foreign_schema(path: Path, name: str, schema: str) -> None:
    _foreign(path, "ros2", "/skill/phase", name, schema, {"version": "2"})
    text = _error_text(path)
    assert "/skill/phase" in text
    assert name in text


def test_a_topic_that_this_program_does_not_know_is_passed_over(path: Path) -> None:
    _foreign(path, "ros2", "/camera", "my_msgs/msg/Image", "uint8 x\n", {"version": "2"})
    log = read_log(path)
    assert log.complete
    assert not any(scenario.rows(log).values())


def test_comments_in_a_schema_do_not_matter(path: Path) -> None:
    change = PhaseChange(5, 1, SkillPhase.INSERT, "", 0)
    text = ros_types.definition(ros_types.PhaseChange)
    bare = "\n".join(line.partition("#")[0] for line in text.splitlines())
    assert bare != text
    message = ros_types.encode(ros_messages.phase_change(change))
    name = ros_types.PhaseChange.__msgtype__
    _foreign(path, "ros2", "/skill/phase", name, bare, {"version": "2"}, message)
    assert read_log(path).phases == (change,)
