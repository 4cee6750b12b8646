"""How many event streams may be open at once: each costs a connection and a look at the database every quarter second."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from contextlib import contextmanager

from core.errors import StateError


class StreamSlots:
    """A counter with a limit; thread-safe."""

    def __init__(self, limit: int) -> None:
        self._limit = limit
        self._open = 0
        self._lock = threading.Lock()

    @property
    def open(self) -> int:
        """Streams open now."""
        return self._open

    @contextmanager
    def take(self) -> Iterator[None]:
        """Hold one slot. Raises StateError `server.busy` when all are taken."""
        with self._lock:
            if self._open >= self._limit:
                raise StateError(
                    "server.busy",
                    f"All {self._limit} event streams of this server are taken; poll the job's status or try again",
                    limit=self._limit,
                )
            self._open += 1
        try:
            yield
        finally:
            with self._lock:
                self._open -= 1
