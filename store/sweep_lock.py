"""Keeps a sweep of blobs and their writers apart: many writers, or one sweep."""

from __future__ import annotations

import fcntl
import os
from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager
from pathlib import Path
from typing import Protocol

from sqlalchemy import func, select

from store.database import Database

SWEEP_LOCK = 0x1A7E7  # any number of our own: PostgreSQL's advisory locks have no names


class SweepLock(Protocol):
    """Held for moments."""

    def held(self, *, alone: bool = False) -> AbstractContextManager[None]:
        """Shared, or alone."""
        ...


class FileLock:
    """For processes on one disk."""

    def __init__(self, path: Path) -> None:
        self._path = path

    @contextmanager
    def held(self, *, alone: bool = False) -> Iterator[None]:
        """Ends with the process, too."""
        handle = os.open(self._path, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o600)
        try:
            fcntl.flock(handle, fcntl.LOCK_EX if alone else fcntl.LOCK_SH)
            yield
        finally:
            os.close(handle)


class DatabaseLock:
    """For hosts that share nothing but a PostgreSQL."""

    def __init__(self, db: Database) -> None:
        self._db = db

    @contextmanager
    def held(self, *, alone: bool = False) -> Iterator[None]:
        """Ends with the connection, too. Raises InternalError `database.unavailable`."""
        lock = func.pg_advisory_xact_lock if alone else func.pg_advisory_xact_lock_shared
        with self._db.session() as session:
            session.execute(select(lock(SWEEP_LOCK)))
            yield
