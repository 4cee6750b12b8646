"""A SQLite file that several processes write to: turns come soon, and the log is copied beside the work."""

from __future__ import annotations

import sqlite3
import threading
import time
from pathlib import Path

import pytest
from sqlalchemy import text

import store.database
from core.errors import InternalError
from store.checkpointer import LOG_BYTES, Checkpointer
from store.database import Database
from store.jobs import Jobs
from store.settings import Settings
from store.workspace import DEFAULT_WORKSPACE


@pytest.fixture
def database(tmp_path: Path) -> Database:
    made = Database(Settings(data_dir=tmp_path))
    made.migrate()
    return made


def stranger_of(database: Database) -> sqlite3.Connection:
    """As another process has it."""
    return sqlite3.connect(database.sqlite_path, isolation_level=None, check_same_thread=False)


def test_a_writer_waits_for_another_process_and_follows_it(database: Database) -> None:
    stranger = stranger_of(database)
    stranger.execute("BEGIN IMMEDIATE")
    done: list[str] = []
    writer = threading.Thread(target=lambda: done.append(Jobs(database).create(DEFAULT_WORKSPACE, "heal", {}).id))
    writer.start()
    time.sleep(0.2)
    assert done == []
    stranger.execute("COMMIT")
    writer.join(20)
    assert len(done) == 1
    with database.session() as session:  # reads in a transaction that writes keep SQLite's own patience
        assert session.execute(text("PRAGMA busy_timeout")).scalar_one() == 10_000
    stranger.close()
    database.close()


def test_a_turn_that_does_not_come_is_an_absent_database(database: Database, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(store.database, "BUSY_TIMEOUT_S", 0.05)
    stranger = stranger_of(database)
    stranger.execute("BEGIN IMMEDIATE")
    with pytest.raises(InternalError) as caught:
        Jobs(database).create(DEFAULT_WORKSPACE, "heal", {})
    assert caught.value.code == "database.unavailable"
    stranger.close()
    assert Jobs(database).create(DEFAULT_WORKSPACE, "heal", {}).attempt == 1
    database.close()


def test_the_log_is_copied_once_it_has_grown(database: Database) -> None:
    jobs, checkpointer = Jobs(database), Checkpointer(database)
    assert checkpointer.look() is False
    log = database.sqlite_path.with_name(database.sqlite_path.name + "-wal")
    job = jobs.create(DEFAULT_WORKSPACE, "heal", {"text": "x" * LOG_BYTES})
    assert log.stat().st_size > LOG_BYTES  # no commit has copied it
    file = database.sqlite_path.stat().st_size
    assert checkpointer.look() is True
    assert database.sqlite_path.stat().st_size > file + LOG_BYTES // 2
    before = log.stat().st_size
    jobs.create(DEFAULT_WORKSPACE, "heal", {})
    assert log.stat().st_size == before  # its room is used again
    assert jobs.get(DEFAULT_WORKSPACE, job.id) == job
    checkpointer.stop()
    database.close()


def test_there_is_nothing_to_copy_in_another_database(postgres_settings: Settings) -> None:
    elsewhere = Database(postgres_settings)
    checkpointer = Checkpointer(elsewhere)
    checkpointer.start()
    assert checkpointer.look() is False
    checkpointer.stop()
    elsewhere.close()
