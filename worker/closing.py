"""The end of a worker: told to stop, its jobs may go on for a while, then they are handed back."""

from __future__ import annotations

import time
from collections import deque


class Closing:
    """Set once, by a signal handler; read by every thread."""

    def __init__(self, drain_s: float) -> None:
        self._drain_s = drain_s
        self._until: float | None = None
        self.left: deque[tuple[str, int]] = deque()  # (job id, attempt) to announce again once we take none ourselves

    def begin(self) -> None:
        """Take no more jobs; the clock of the running ones starts."""
        if self._until is None:
            self._until = time.monotonic() + self._drain_s

    @property
    def has_begun(self) -> bool:
        """Whether no more jobs are to be taken."""
        return self._until is not None

    @property
    def is_over(self) -> bool:
        """Whether the jobs that still run must be handed back."""
        return self._until is not None and time.monotonic() > self._until
