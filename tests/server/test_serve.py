"""The embedded server as a whole: real API, worker and Valkey."""

import json
import os
import signal
import socket
import stat
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import httpx
import psutil
import pytest

from tests.embedded import Embedded, embedded

ODD_NAME = "Meine Daten #1 100% ü"


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Embedded]:
    with embedded(tmp_path_factory.mktemp("serve") / ODD_NAME) as server:
        yield server


def serve(*arguments: str, environment: dict[str, str] | None = None) -> subprocess.CompletedProcess[str]:
    """A start that is expected to be refused."""
    command = [sys.executable, "-m", "server", *arguments]
    return subprocess.run(command, capture_output=True, text=True, timeout=60, env={**os.environ, **(environment or {})})


def until(condition: Callable[[], bool], seconds: float = 60.0) -> None:
    deadline = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < deadline
        time.sleep(0.05)


def is_ready(url: str) -> bool:
    try:
        return httpx.get(f"{url}/readyz", timeout=5).status_code == 200
    except httpx.TransportError:
        return False


def test_it_says_where_it_answers_once_it_does(server: Embedded) -> None:
    assert server.process is not None
    notice = json.loads((server.data_dir / "server.json").read_text())
    assert set(notice) == {"url", "pid", "started_at"}
    assert notice["pid"] == server.process.pid
    assert httpx.get(f"{notice['url']}/readyz").status_code == 200
    assert server.output.read_text().strip().splitlines()[-1] == (
        f"Integument answers at {notice['url']} (data in {server.data_dir}; Ctrl-C stops it)."
    )


def test_nobody_but_its_user_can_look_into_its_folder(server: Embedded) -> None:
    assert stat.S_IMODE(server.data_dir.stat().st_mode) == 0o700


def test_only_the_api_listens_and_only_on_loopback(server: Embedded) -> None:
    listening = {
        (process.name(), connection.laddr.ip, connection.laddr.port)
        for process in server.family()
        for connection in process.net_connections("inet")
        if connection.status == psutil.CONN_LISTEN
    }
    assert {(ip, port) for _, ip, port in listening} == {("127.0.0.1", int(server.url.rpartition(":")[2]))}


def test_second_server_on_the_folder_is_refused_by_name(server: Embedded) -> None:
    outcome = serve("--data-dir", str(server.data_dir), "--port", "0")
    assert outcome.returncode == 2
    assert "server.already_running" in outcome.stderr
    assert server.url in outcome.stderr
    assert is_ready(server.url)


def test_crashed_api_comes_back_at_the_same_address(server: Embedded) -> None:
    crashed = server.part("api")
    url = server.url
    crashed.kill()
    assert server.part("api", other_than=crashed.pid).is_running()
    until(lambda: is_ready(url))
    assert server.url == url


def test_crashed_worker_comes_back_and_its_children_are_gone(server: Embedded) -> None:
    crashed = server.part("worker")
    family = [crashed, *crashed.children(recursive=True)]
    assert len(family) > 1  # it keeps a nursery
    crashed.kill()
    _, alive = psutil.wait_procs(family, timeout=10)
    assert alive == []
    assert server.part("worker", other_than=crashed.pid).is_running()


def test_crashed_valkey_comes_back_and_the_api_finds_it(server: Embedded) -> None:
    crashed = server.part("valkey")
    crashed.kill()
    assert server.part("valkey", other_than=crashed.pid).is_running()
    until(lambda: is_ready(server.url))
    assert "The valkey ended with signal SIGKILL" in server.output.read_text()


def test_it_stops_cleanly_and_completely(server: Embedded) -> None:
    family = server.family()
    started = time.monotonic()
    assert server.stop() == 0
    assert time.monotonic() - started < 20
    assert [process for process in family if process.is_running()] == []
    assert not (server.data_dir / "server.json").exists()
    assert not (server.data_dir / "valkey" / "valkey.sock").exists()
    assert "did not stop in time" not in server.output.read_text()


def test_nothing_outlives_its_sigkill_and_it_starts_again(tmp_path: Path) -> None:
    foreign = {"INTEGUMENT_DATABASE_URL": f"sqlite:///{tmp_path}/elsewhere.sqlite3"}
    with embedded(tmp_path / "data", foreign) as server:
        server.kill()  # waits for the end of the whole family
        for file in (server.data_dir / "valkey" / "appendonlydir").glob("*.aof"):
            file.write_bytes(b"torn by the crash " * 100)
        server.start()
        assert is_ready(server.url)
        assert "set aside" in server.output.read_text()
        assert server.stop(signal.SIGINT) == 0
        assert (server.data_dir / "integument.sqlite3").exists()
    assert not (tmp_path / "elsewhere.sqlite3").exists()  # the lock of the folder guards its own database only


def test_host_beyond_loopback_is_refused(tmp_path: Path) -> None:
    outcome = serve("--data-dir", str(tmp_path / "data"), "--host", "0.0.0.0")
    assert outcome.returncode == 2
    assert "server.host_not_loopback" in outcome.stderr
    assert not (tmp_path / "data").exists()


def test_port_in_use_is_refused(tmp_path: Path) -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        outcome = serve("--data-dir", str(tmp_path), "--port", str(taken.getsockname()[1]))
    assert outcome.returncode == 2
    assert "server.port_in_use" in outcome.stderr


def test_misspelt_setting_is_refused(tmp_path: Path) -> None:
    outcome = serve("--data-dir", str(tmp_path), environment={"INTEGUMENT_JOB_MEMORY": "1GiB"})
    assert outcome.returncode == 2
    assert "INTEGUMENT_JOB_MEMORY" in outcome.stderr
