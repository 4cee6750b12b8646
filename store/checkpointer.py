"""SQLite's log is copied into the file by a thread of its own: no request waits for that.

By itself SQLite does it in the commit that fills the log beyond 4 MB, with two more waits for the disk: of fifty accepted jobs
one would wait ten times as long as the others."""

from __future__ import annotations

import logging
import sqlite3

from store.database import Database
from store.periodic import Periodic

EVERY_S = 0.5
LOG_BYTES = 4 * 1024**2

_log = logging.getLogger(__name__)


class Checkpointer:
    """One per process that writes; does nothing where the database is no SQLite file."""

    def __init__(self, db: Database) -> None:
        self._db = db
        self._log_path = db.sqlite_path.with_name(db.sqlite_path.name + "-wal") if db.is_sqlite else None
        self._connection: sqlite3.Connection | None = None
        self._periodic = Periodic("checkpoints of the log", self.look, EVERY_S)

    def start(self) -> None:
        """Begin to look."""
        if self._log_path is not None:
            self._periodic.start()

    def stop(self) -> None:
        """Returns when the present copying is over."""
        self._periodic.stop()
        if self._connection is not None:
            self._connection.close()
            self._connection = None

    def look(self) -> bool:
        """Copy what is new if the log has grown; True if that was done. Writers and readers go on meanwhile."""
        if self._log_path is None or not self._log_path.exists() or self._log_path.stat().st_size < LOG_BYTES:
            return False
        try:
            if self._connection is None:
                self._connection = sqlite3.connect(self._db.sqlite_path, isolation_level=None, timeout=0, check_same_thread=False)
            busy, _, _ = self._connection.execute("PRAGMA wal_checkpoint(PASSIVE)").fetchone()
        except sqlite3.OperationalError as error:  # the disk is full, say: the next look is soon
            _log.debug("the log is copied later: %s", error)
            return False
        return not busy
