"""The server of one call, with the real server."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import httpx
import psutil
import pytest
from integument import Client, EmbeddedServer, ServerNotInstalledError, ServerStartError
from integument.cli import main
from integument.data_folder import DataFolder, default_data_dir

from core.schema.processes import PROCESSES

USER = """
import sys
from pathlib import Path
from integument import EmbeddedServer
with EmbeddedServer(Path(sys.argv[1])) as server:
    print(server.started_here, server.url, flush=True)
    sys.stdin.read()
"""


@pytest.fixture
def other_call(tmp_path: Path) -> Iterator[tuple[subprocess.Popen[str], str]]:
    """Another process that started the server and uses it."""
    command = [sys.executable, "-c", USER, str(tmp_path)]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        started_here, url = process.stdout.readline().split()
        assert started_here == "True"
        yield process, url
        process.kill()


def server_of(user: subprocess.Popen[str]) -> psutil.Process:
    return next(child for child in psutil.Process(user.pid).children() if "serve" in child.cmdline())


def test_a_server_goes_with_its_last_user_however_the_users_end(
    other_call: tuple[subprocess.Popen[str], str], tmp_path: Path
) -> None:
    user, url = other_call
    server = server_of(user)
    with EmbeddedServer(tmp_path) as shared, Client(shared.url) as client:
        assert (shared.started_here, shared.url) == (False, url)
        user.send_signal(signal.SIGKILL)
        user.wait()
        # who started it is dead; we are still there
        with pytest.raises(psutil.TimeoutExpired):
            server.wait(1)
        assert [process.id for process in client.processes()] == list(PROCESSES)
    server.wait(30)
    with pytest.raises(httpx.ConnectError):
        httpx.get(f"{url}/healthz", trust_env=False)
    assert DataFolder(tmp_path).running_url() is None


def test_a_server_that_cannot_start_says_why(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("INTEGUMENT_LEASE_S", "soon")
    with pytest.raises(ServerStartError, match=r"ended with exit code 2:[\s\S]*lease_s"), EmbeddedServer(tmp_path):
        pass
    monkeypatch.delenv("INTEGUMENT_LEASE_S")
    (tmp_path / "file").write_text("")
    with pytest.raises(ServerStartError, match="cannot use the data folder"), EmbeddedServer(tmp_path / "file"):
        pass


def test_without_the_server_installed_the_command_line_says_how_to_install_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("integument.server_entry.entry_points", lambda **_group: ())
    monkeypatch.setenv("INTEGUMENT_DATA_DIR", str(tmp_path))
    monkeypatch.delenv("INTEGUMENT_URL", raising=False)
    with pytest.raises(ServerNotInstalledError), EmbeddedServer(tmp_path):
        pass
    for arguments in (["serve"], ["jobs"]):
        assert main(arguments) == 2
        assert "`pip install .`" in capsys.readouterr().err


def test_a_file_of_a_dead_server_does_not_count(tmp_path: Path) -> None:
    folder = DataFolder(tmp_path)
    assert folder.running_url() is None
    for text in ("", "[]", "{}", '{"url": "http://127.0.0.1:1", "pid": 1}'):
        (tmp_path / "server.json").write_text(text)
        assert folder.running_url() is None


def test_the_data_folder(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_DATA_HOME", "/xdg")
    monkeypatch.delenv("INTEGUMENT_DATA_DIR", raising=False)
    assert default_data_dir() == Path("/xdg/integument")
    monkeypatch.delenv("XDG_DATA_HOME")
    assert default_data_dir() == Path.home() / ".local/share/integument"
    monkeypatch.setenv("INTEGUMENT_DATA_DIR", "~/lab")
    assert default_data_dir() == Path(os.path.expanduser("~/lab"))
