"""A file whose age says whether the worker lives. A broker or a database that is away does not make a worker dead."""

from __future__ import annotations

import socket
import time

from store.settings import Settings

STALE_BEATS = 6


class Liveness:
    """`worker-<host>.alive` in the data folder; touched once per look of the reconciler."""

    def __init__(self, settings: Settings) -> None:
        self._path = settings.data_dir / f"worker-{socket.gethostname()}.alive"
        self._stale_s = STALE_BEATS * settings.reconcile_s + settings.lease_s

    def beat(self) -> None:
        """The worker's own word."""
        self._path.touch()

    def end(self) -> None:
        """The worker stopped in good order."""
        self._path.unlink(missing_ok=True)

    def is_fresh(self) -> bool:
        """Whether the worker of this host has given word lately."""
        try:
            return time.time() - self._path.stat().st_mtime < self._stale_s
        except FileNotFoundError:
            return False
