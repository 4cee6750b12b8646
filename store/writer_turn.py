"""SQLite has one writer at a time: the threads of a process take turns here instead of sleeping in its busy handler."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from contextlib import contextmanager

from core.errors import InternalError


class WriterTurn:
    """A lock with patience. The busy handler knows no turns: with many threads one may find the file locked every time it looks,
    up to a tenth of a second apart. Between processes it still decides."""

    def __init__(self, patience_s: float) -> None:
        self._patience_s = patience_s
        self._lock = threading.Lock()

    @contextmanager
    def held(self) -> Iterator[None]:
        """Raises InternalError `database.unavailable` if the turn does not come in time."""
        if not self._lock.acquire(timeout=self._patience_s):
            raise InternalError(
                "database.unavailable", f"the database does not answer: no turn to write came within {self._patience_s:g} s"
            )
        try:
            yield
        finally:
            self._lock.release()
