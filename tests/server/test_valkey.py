"""The private Valkey, the real one."""

import socket
import stat
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

import psutil
import pytest
from kombu import Connection

from core.errors import InputError
from server.data_folder import DataFolder
from server.log_file import LogFile
from server.part import Part
from server.valkey import (
    SOCKET_PATH_LIMIT_BYTES,
    answers,
    broker_url,
    choose_socket_path,
    set_aside_append_only,
    valkey_program,
)

START_S = 10.0


@contextmanager
def running(data_dir: Path) -> Iterator[tuple[DataFolder, Part]]:
    """A Valkey in a data folder."""
    folder = DataFolder(data_dir)
    part = Part(valkey_program(folder.valkey, folder.socket_path), LogFile(folder.logs / "valkey.log"), folder.lock_fd)
    part.start()
    assert part.process is not None
    deadline = time.monotonic() + START_S
    while part.process.poll() is None and not answers(folder.socket_path):
        assert time.monotonic() < deadline
        time.sleep(0.01)
    try:
        yield folder, part
    finally:
        part.process.kill()
        part.collect()
        part.log.close()
        folder.release()


@pytest.mark.parametrize("name", ["data", "Meine Daten #1 100% ü&=", "deep/" + "x" * 120])
def test_broker_url_leads_to_it_through_any_folder_name(tmp_path: Path, name: str) -> None:
    with running(tmp_path / name) as (folder, part):
        with Connection(broker_url(folder.socket_path)) as connection:
            queue = connection.SimpleQueue("bell")
            queue.put({"job_id": "1"})
            assert queue.get(timeout=5).payload == {"job_id": "1"}
            queue.close()
        assert part.process is not None
        assert psutil.Process(part.process.pid).net_connections("inet") == []  # no TCP port
        assert len(str(folder.socket_path).encode()) <= SOCKET_PATH_LIMIT_BYTES
        assert stat.S_IMODE(folder.socket_path.parent.stat().st_mode) == 0o700
    assert folder.socket_path.parent.exists() == (folder.socket_path.parent == folder.valkey)  # no short folder stays behind


def test_messages_survive_its_sigkill(tmp_path: Path) -> None:
    with running(tmp_path) as (folder, _), Connection(broker_url(folder.socket_path)) as connection:
        queue = connection.SimpleQueue("bell")
        for number in range(50):
            queue.put({"number": number})
        queue.close()
    with running(tmp_path) as (folder, _), Connection(broker_url(folder.socket_path)) as connection:
        queue = connection.SimpleQueue("bell")
        assert [queue.get(timeout=5).payload["number"] for _ in range(50)] == list(range(50))
        queue.close()


def test_unreadable_append_only_file_is_set_aside(tmp_path: Path) -> None:
    with running(tmp_path) as (folder, _):
        append_only = folder.valkey / "appendonlydir"
    for file in append_only.glob("*.aof"):
        file.write_bytes(b"not an append-only file " * 1000)
    with running(tmp_path) as (folder, part):
        assert part.process is not None
        assert part.process.poll() is not None  # it refuses to start
        assert set_aside_append_only(folder.valkey) == folder.valkey / "appendonlydir.unreadable"
    with running(tmp_path) as (folder, _):
        assert answers(folder.socket_path)
        assert set_aside_append_only(tmp_path / "elsewhere") is None


def test_nobody_answers_where_nobody_listens(tmp_path: Path) -> None:
    assert not answers(tmp_path / "valkey.sock")
    with socket.socket(socket.AF_UNIX) as mute:
        mute.bind(str(tmp_path / "mute.sock"))
        mute.listen()
        assert not answers(tmp_path / "mute.sock")


def test_short_folder_of_somebody_else_is_not_trusted(monkeypatch: pytest.MonkeyPatch) -> None:
    with TemporaryDirectory() as runtime:  # shorter than what pytest would give
        monkeypatch.setenv("XDG_RUNTIME_DIR", runtime)
        long = Path(runtime) / ("x" * 100)
        private = choose_socket_path(long).parent
        assert private.parent == Path(runtime)
        private.chmod(0o755)
        with pytest.raises(InputError) as refusal:
            choose_socket_path(long)
    assert refusal.value.code == "server.socket_path_unusable"
