"""The file of a SQLite database gives back what it does not need. PostgreSQL sees to that itself."""

from __future__ import annotations

import sqlite3
import time
from dataclasses import dataclass

from sqlalchemy import text
from sqlalchemy.orm import Session

from core.errors import InternalError
from store.database import Database

PAGES_AT_A_TIME = 2000  # 8 MB: other writers wait that long
SPARE_SHARE = 0.25  # of the file; some free pages are soon used again
LIMIT_S = 2.0
CHECKPOINT = "PRAGMA wal_checkpoint(TRUNCATE)"
"""Copy the log into the file and cut it, unless somebody is reading what is older."""


@dataclass(frozen=True, slots=True)
class FileUse:
    """Of a database file. spare_bytes: free pages within it; wal_bytes: the log beside it."""

    bytes: int
    spare_bytes: int
    wal_bytes: int
    gives_back: bool  # made by a version that can give pages back one by one


class SqliteFile:
    """Only for a database that is one."""

    def __init__(self, db: Database) -> None:
        self._db = db

    def measure(self) -> FileUse:
        """As it is now."""
        with self._db.reading() as session:
            page, pages, spare, mode = (
                _number(session, name) for name in ("page_size", "page_count", "freelist_count", "auto_vacuum")
            )
        wal = self._db.sqlite_path.with_name(self._db.sqlite_path.name + "-wal")
        return FileUse(page * pages, page * spare, wal.stat().st_size if wal.exists() else 0, mode == 2)

    def give_back(self, limit_s: float = LIMIT_S) -> int:
        """Shrink the file while a good part of it is spare, a little at a time; returns by how many bytes."""
        ends_at, before = time.monotonic() + limit_s, self.measure()
        use = before
        while use.gives_back and use.spare_bytes > SPARE_SHARE * use.bytes and time.monotonic() < ends_at:
            self._run(f"PRAGMA incremental_vacuum({PAGES_AT_A_TIME})")
            use = self.measure()
        self._run(CHECKPOINT)
        return before.bytes - use.bytes

    def rewrite(self) -> int:
        """Write the whole file anew, without spare pages and able to give them back later; everybody waits meanwhile.

        Returns by how many bytes it shrank."""
        before = self.measure()
        self._run("PRAGMA auto_vacuum=INCREMENTAL; VACUUM")
        self._run(CHECKPOINT)
        return before.bytes - self.measure().bytes

    def _run(self, statement: str) -> None:
        """Outside of any transaction, and to its end: a pragma that returns no columns is otherwise left after its first step.

        Raises InternalError `database.unavailable`."""
        connection = self._db.engine.raw_connection()
        try:
            connection.cursor().executescript(statement)
        except sqlite3.OperationalError as error:
            raise InternalError("database.unavailable", f"the database does not answer: {error}") from error
        finally:
            connection.close()


def _number(session: Session, pragma: str) -> int:
    return int(session.execute(text(f"PRAGMA {pragma}")).scalar_one())
