"""Resident memory of a process while something goes on."""

from __future__ import annotations

import threading
import time
from types import TracebackType
from typing import Self

import psutil

LOOK_S = 0.05
MIB = 1024**2


class Memory:
    """Looks twenty times a second until the end of the block."""

    def __init__(self, process: psutil.Process) -> None:
        self._process = process
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._loop, daemon=True)
        self._seen: list[tuple[float, float]] = []

    @property
    def growth_mib(self) -> float:
        """The most above what it was at the beginning."""
        return max(mib for _, mib in self._seen) - self._seen[0][1]

    @property
    def series(self) -> tuple[tuple[float, float], ...]:
        """(seconds, MiB), a hundred of them at most."""
        return tuple(self._seen[:: 1 + len(self._seen) // 100])

    def __enter__(self) -> Self:
        self._began = time.monotonic()
        self._look()
        self._thread.start()
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self._stop.set()
        self._thread.join()
        self._look()

    def _look(self) -> None:
        self._seen.append((round(time.monotonic() - self._began, 2), round(self._process.memory_info().rss / MIB, 1)))

    def _loop(self) -> None:
        while not self._stop.wait(LOOK_S):
            self._look()
