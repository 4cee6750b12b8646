"""The data folder: whoever holds its lock is the only server in it."""

from __future__ import annotations

import fcntl
import json
import os
import time
from contextlib import suppress
from datetime import UTC, datetime
from functools import cached_property
from pathlib import Path

import psutil

from core.errors import InputError, StateError
from server.valkey import choose_socket_path

HANDOVER_S = 5.0  # after a SIGKILL of the supervisor the kernel kills its parts, which hold the lock too, a moment later
DYING_S = 0.5  # a process that was just sent SIGKILL still looks alive
POLL_S = 0.02


class DataFolder:
    """A folder of mode 0700, locked with flock as long as this process, or a part it started, lives."""

    def __init__(self, path: Path) -> None:
        """Creates the folder. Raises: InputError `server.folder_unusable`; StateError `server.already_running`."""
        self.path = path.resolve()
        if "?" in str(self.path):  # SQLite URLs end there, and the database would lie elsewhere
            raise InputError("server.folder_unusable", f"The data folder {path} has a '?' in its path.", folder=str(path))
        try:
            self.path.mkdir(parents=True, exist_ok=True, mode=0o700)
            self.path.chmod(0o700)  # mkdir leaves a folder that exists as it is
            self._lock = os.open(self.path / "lock", os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o600)
        except OSError as error:
            raise InputError(
                "server.folder_unusable", f"The data folder {path} cannot be used: {error.strerror}.", folder=str(path)
            ) from error
        try:
            self._take_lock()
        except StateError:
            os.close(self._lock)
            raise
        self.withdraw()  # a killed server could not
        for inside in (self.logs, self.valkey):
            inside.mkdir(exist_ok=True, mode=0o700)

    @property
    def lock_fd(self) -> int:
        """Parts inherit it, so the folder stays locked until the last of them is gone."""
        return self._lock

    @property
    def notice(self) -> Path:
        """`server.json`: where the running server answers."""
        return self.path / "server.json"

    @property
    def valkey(self) -> Path:
        """What Valkey keeps."""
        return self.path / "valkey"

    @cached_property
    def socket_path(self) -> Path:
        """Where Valkey answers. Raises: InputError `server.socket_path_unusable`."""
        return choose_socket_path(self.valkey)

    @property
    def logs(self) -> Path:
        """One log per part."""
        return self.path / "logs"

    def publish(self, url: str) -> None:
        """Write `server.json` {url, pid, started_at} in one step, so no reader sees half of it."""
        notice = {"url": url, "pid": os.getpid(), "started_at": datetime.now(UTC).isoformat(timespec="seconds")}
        draft = self.notice.with_suffix(".tmp")
        draft.write_text(json.dumps(notice) + "\n", encoding="utf-8")
        draft.replace(self.notice)

    def withdraw(self) -> None:
        """Remove `server.json`: from now on nobody is invited."""
        self.notice.unlink(missing_ok=True)

    def release(self) -> None:
        """Give up the lock, and the short folder of the socket if there is one."""
        self.withdraw()
        if "socket_path" in vars(self) and self.socket_path.parent != self.valkey:
            self.socket_path.unlink(missing_ok=True)  # a killed Valkey leaves it behind
            with suppress(OSError):  # somebody else's file in it is no reason to fail at the very end
                self.socket_path.parent.rmdir()
        os.close(self._lock)

    def _take_lock(self) -> None:
        started = time.monotonic()
        while not self._try_lock():
            owner = self._read_owner()
            if time.monotonic() - started > (DYING_S if _is_alive(owner) else HANDOVER_S):
                raise StateError(
                    "server.already_running",
                    f"A server already runs in {self.path}: {self._read_url()} (process {owner}).",
                    folder=str(self.path),
                    pid=owner,
                )
            time.sleep(POLL_S)
        os.ftruncate(self._lock, 0)
        os.pwrite(self._lock, str(os.getpid()).encode(), 0)

    def _try_lock(self) -> bool:
        try:
            fcntl.flock(self._lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            return False
        return True

    def _read_owner(self) -> int:
        """The process that took the lock; 0 while it is about to say so."""
        return int(os.pread(self._lock, 20, 0) or b"0")

    def _read_url(self) -> str:
        try:
            return str(json.loads(self.notice.read_text(encoding="utf-8"))["url"])
        except FileNotFoundError:
            return "still starting"


def _is_alive(pid: int) -> bool:
    """False for a process that was killed and only waits for its parent to take note."""
    try:
        return psutil.Process(pid).status() != psutil.STATUS_ZOMBIE
    except psutil.NoSuchProcess:
        return False
