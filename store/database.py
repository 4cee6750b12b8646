"""One database, SQLite or PostgreSQL, and the transactions on it."""

from __future__ import annotations

import json
import sqlite3
import threading
from collections.abc import Iterator
from contextlib import contextmanager, nullcontext
from datetime import UTC, datetime
from functools import partial
from pathlib import Path
from typing import Any

import psycopg
from alembic import command
from alembic.config import Config
from alembic.runtime.migration import MigrationContext
from alembic.script import ScriptDirectory
from sqlalchemy import Connection, Engine, create_engine, event, func, make_url, select, text
from sqlalchemy.exc import DatabaseError, DBAPIError, InterfaceError, OperationalError
from sqlalchemy.exc import TimeoutError as PoolTimeoutError
from sqlalchemy.orm import Session
from sqlalchemy.pool import ConnectionPoolEntry

from core.errors import InternalError, LimitError
from store.settings import Settings
from store.sqlite_begin import begin_to_write
from store.writer_turn import WriterTurn

_ONE_AT_A_TIME = threading.Lock()  # Alembic keeps the migration under way in a global

BUSY_TIMEOUT_S = 10
WAL_BYTES = 64 * 1024**2  # a write-ahead log that grew larger is cut back once it is copied into the file
PAGE_BYTES = 4096  # SQLite's own
_DAMAGED = (sqlite3.SQLITE_CORRUPT, sqlite3.SQLITE_NOTADB)
MIGRATION_LOCK = 0x1A7E6  # any number of our own: PostgreSQL's advisory locks have no names


class Database:
    """Thread-safe, but not to be carried across a fork. Connects when first used.

    Any failure of the database itself is an InternalError `database.unavailable`, or a LimitError `storage.full`."""

    def __init__(self, settings: Settings) -> None:
        self._settings_url = str(settings.database_url)
        self._url = make_url(self._settings_url)
        self.is_sqlite = self._url.get_backend_name() == "sqlite"
        if self.is_sqlite:
            Path(str(self._url.database)).parent.mkdir(parents=True, exist_ok=True, mode=0o700)
        self.engine = _sqlite_engine(self._settings_url) if self.is_sqlite else _postgres_engine(self._settings_url)
        self._reader = self.engine.execution_options(read_only=True)
        self._turn = WriterTurn(BUSY_TIMEOUT_S)

    @contextmanager
    def session(self, joined: Session | None = None) -> Iterator[Session]:
        """One transaction that may write: committed at the end, rolled back on any exception.

        With `joined`, the work becomes part of that transaction and its owner commits."""
        if joined is not None:
            yield joined
            return
        turn = self._turn.held() if self.is_sqlite else nullcontext()
        with turn, _translated(), Session(self.engine, expire_on_commit=False) as session, session.begin():
            yield session

    @contextmanager
    def reading(self) -> Iterator[Session]:
        """One transaction that only reads; on SQLite it waits for no writer."""
        with _translated(), Session(self._reader) as session, session.begin():
            yield session

    @contextmanager
    def snapshot(self) -> Iterator[Session]:
        """One transaction that only reads, and sees one moment to its end however long it lasts."""
        one_moment = {"isolation_level": "REPEATABLE READ", "postgresql_readonly": True}
        engine = self._reader if self.is_sqlite else self.engine.execution_options(**one_moment)
        with _translated(), Session(engine) as session, session.begin():
            yield session

    def now(self, session: Session) -> datetime:
        """The moment by the clock all users of the database share: leases of many hosts are compared by one clock."""
        if self.is_sqlite:
            return datetime.now(UTC)
        moment: datetime = session.execute(select(func.clock_timestamp())).scalar_one()
        return moment.astimezone(UTC)

    def migrate(self, revision: str = "head") -> None:
        """Bring the tables to what this code expects, in one transaction. Safe to call from anywhere at once."""
        with self._migrating() as config:
            command.upgrade(config, revision)

    def revert(self, revision: str) -> None:
        """Bring the tables back to an older revision, `base` for none at all; what the older tables cannot hold is lost."""
        with self._migrating() as config:
            command.downgrade(config, revision)

    @contextmanager
    def _migrating(self) -> Iterator[Config]:
        engine = _sqlite_engine(self._settings_url, foreign_keys=False) if self.is_sqlite else self.engine
        try:
            with _ONE_AT_A_TIME, _translated(), engine.begin() as connection:
                if not self.is_sqlite:
                    connection.execute(select(func.pg_advisory_xact_lock(MIGRATION_LOCK)))
                yield _alembic(connection)
                if self.is_sqlite:
                    _require_whole(connection)
        finally:
            if engine is not self.engine:
                engine.dispose()

    def is_migrated(self) -> bool:
        """True if the tables are those this code expects."""
        with _translated(), self._reader.connect() as connection:
            current = MigrationContext.configure(connection).get_current_revision()
            return current == ScriptDirectory.from_config(_alembic(connection)).get_current_head()

    @property
    def sqlite_path(self) -> Path:
        """The file, if it is one."""
        return Path(str(self._url.database))

    def revision(self) -> str:
        """Of the tables; empty if there are none."""
        with _translated(), self._reader.connect() as connection:
            return MigrationContext.configure(connection).get_current_revision() or ""

    def knows(self, revision: str) -> bool:
        """Whether this code has tables of that revision, or can bring them to its own."""
        with _translated(), self._reader.connect() as connection:
            scripts = ScriptDirectory.from_config(_alembic(connection))
            return revision in {script.revision for script in scripts.walk_revisions()}

    def ping(self) -> None:
        """Raises InternalError `database.unavailable` if the database does not answer."""
        with self.reading() as session:
            session.execute(text("SELECT 1"))

    def close(self) -> None:
        """Close idle connections; the object can still be used."""
        self.engine.dispose()


@contextmanager
def _translated() -> Iterator[None]:
    """Drivers' words for an absent or full database become ours; violated constraints and bugs pass."""
    try:
        yield
    except (OperationalError, InterfaceError, PoolTimeoutError) as error:
        cause = error.orig if isinstance(error, DBAPIError) else error
        reason = (str(cause).strip() or type(cause).__name__).splitlines()[0]
        if isinstance(cause, psycopg.errors.DiskFull) or getattr(cause, "sqlite_errorcode", None) == sqlite3.SQLITE_FULL:
            raise LimitError("storage.full", f"the database has no space left: {reason}") from error
        raise InternalError("database.unavailable", f"the database does not answer: {reason}") from error
    except DatabaseError as error:
        if getattr(error.orig, "sqlite_errorcode", None) not in _DAMAGED:
            raise
        raise InternalError("database.damaged", f"the database file is damaged: {error.orig}") from error


def _require_whole(connection: Connection) -> None:
    """The foreign keys that were not looked at while tables were made anew. Raises InternalError `database.inconsistent`."""
    dangling = connection.exec_driver_sql("PRAGMA foreign_key_check").fetchall()
    if dangling:
        raise InternalError(
            "database.inconsistent",
            f"{len(dangling)} rows refer to rows that are not there, the first in {dangling[0][0]}; nothing was migrated",
            rows=len(dangling),
            table=str(dangling[0][0]),
        )


def _alembic(connection: Connection) -> Config:
    config = Config()
    config.set_main_option("script_location", str(Path(__file__).parent / "migrations").replace("%", "%%"))
    config.set_main_option("path_separator", "os")
    config.attributes["connection"] = connection
    return config


_to_json = partial(json.dumps, allow_nan=False)  # escapes all but ASCII: PostgreSQL takes any text in that form


def _postgres_engine(url: str) -> Engine:
    return create_engine(
        make_url(url).set(drivername="postgresql+psycopg"),
        pool_pre_ping=True,
        pool_size=5,
        max_overflow=15,
        hide_parameters=True,
        json_serializer=_to_json,
        connect_args={
            "connect_timeout": BUSY_TIMEOUT_S,
            "application_name": "integument",
            "options": f"-c timezone=UTC -c lock_timeout={BUSY_TIMEOUT_S}s -c idle_in_transaction_session_timeout=60s",
        },
    )


def _sqlite_engine(url: str, *, foreign_keys: bool = True) -> Engine:
    """Without `foreign_keys` for migrations alone: a table made anew is dropped first, which would take its children along."""
    # isolation_level None: the driver begins nothing by itself, we say which kind of transaction it is
    engine = create_engine(
        url,
        hide_parameters=True,
        pool_size=5,
        max_overflow=15,
        json_serializer=_to_json,
        connect_args={"isolation_level": None, "timeout": BUSY_TIMEOUT_S},
    )

    @event.listens_for(engine, "connect")
    def _configure(connection: sqlite3.Connection, _entry: ConnectionPoolEntry) -> None:
        cursor = connection.cursor()
        enforced = "foreign_keys=ON" if foreign_keys else "foreign_keys=OFF"
        if not cursor.execute("PRAGMA page_count").fetchone()[0]:
            cursor.execute("PRAGMA auto_vacuum=INCREMENTAL")  # of a new file alone: of another it would wait for every writer
        for pragma in (
            "journal_mode=WAL",
            f"journal_size_limit={WAL_BYTES}",
            f"wal_autocheckpoint={WAL_BYTES // PAGE_BYTES}",  # where no `store.checkpointer` does it before
            "synchronous=FULL",  # what was accepted survives a power cut
            enforced,
        ):
            cursor.execute(f"PRAGMA {pragma}")
        cursor.close()

    @event.listens_for(engine, "begin")
    def _begin(connection: Connection) -> None:
        options: dict[str, Any] = dict(connection.get_execution_options())
        if options.get("read_only"):
            connection.exec_driver_sql("BEGIN")
        else:
            begin_to_write(connection, BUSY_TIMEOUT_S)

    return engine
