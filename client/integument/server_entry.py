"""The server, if it is installed beside this client: entry points `serve` and `admin` of the group `integument.server`."""

from __future__ import annotations

import os
import signal
import threading
from collections.abc import Callable, Sequence
from importlib.metadata import EntryPoint, entry_points
from pathlib import Path

from integument.data_folder import DataFolder
from integument.errors import ServerNotInstalledError
from integument.file_lock import FileLock

GROUP = "integument.server"
SERVE, ADMIN = "serve", "admin"


def server_is_installed() -> bool:
    """Nothing is imported."""
    return _find(SERVE) is not None


def run_server(*, data_dir: Path, host: str, port: int, while_used: bool = False) -> int:
    """Run the server in this process until it is asked to stop; returns its exit code.

    while_used: stop when no call holds `clients.lock` any more.
    Raises: ServerNotInstalledError.
    """
    entry = _find(SERVE)
    if entry is None:
        raise ServerNotInstalledError
    serve: Callable[..., int] = entry.load()
    if while_used:
        lock = FileLock(DataFolder(data_dir).clients_lock)
        threading.Thread(target=_stop_when_free, args=(lock,), daemon=True, name="users").start()
    return serve(data_dir=data_dir, host=host, port=port)


def run_admin(words: Sequence[str]) -> int:
    """Run an admin command of the server in this process; returns its exit code. Raises: ServerNotInstalledError."""
    entry = _find(ADMIN)
    if entry is None:
        raise ServerNotInstalledError
    admin: Callable[[Sequence[str]], int] = entry.load()
    return admin(words)


def _find(name: str) -> EntryPoint | None:
    return next(iter(entry_points(group=GROUP, name=name)), None)


def _stop_when_free(lock: FileLock) -> None:
    with lock:
        os.kill(os.getpid(), signal.SIGTERM)
        # kept to the end of this process: a call that comes now waits, and then starts a new server
        threading.Event().wait()
