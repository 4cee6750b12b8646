"""One row of a SQLite file, looked up in some ten microseconds: too little to send a request to a thread for it."""

from __future__ import annotations

import logging
import sqlite3
import threading
from collections.abc import Sequence
from typing import Any

from store.database import Database

_log = logging.getLogger(__name__)

Row = tuple[Any, ...]


class Glance:
    """Reads as it was committed last, on a connection of its own that waits for nobody. Thread-safe."""

    def __init__(self, db: Database) -> None:
        self._path = db.sqlite_path if db.is_sqlite else None
        self._lock = threading.Lock()
        self._connection: sqlite3.Connection | None = None

    def row(self, query: str, parameters: Sequence[object] = ()) -> Row | None:
        """The first row, as SQLite has it; () if there is none.

        None if it cannot be had at once: the database is another one, or something is wrong with it, which those who go the
        longer way find out."""
        if self._path is None:
            return None
        with self._lock:
            try:
                if self._connection is None:
                    self._connection = sqlite3.connect(
                        f"{self._path.absolute().as_uri()}?mode=ro",
                        uri=True,
                        isolation_level=None,
                        timeout=0,
                        check_same_thread=False,
                    )
                found = self._connection.execute(query, parameters).fetchone()
            except sqlite3.Error as error:
                _log.debug("no glance at the database: %s", error)
                self._close()
                return None
        return () if found is None else tuple(found)

    def close(self) -> None:
        """It can still be used."""
        with self._lock:
            self._close()

    def _close(self) -> None:
        if self._connection is not None:
            self._connection.close()
            self._connection = None
