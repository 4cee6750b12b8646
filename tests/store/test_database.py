"""Transactions, clocks and failures of both databases."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from datetime import UTC, datetime
from functools import partial
from pathlib import Path

import pytest
from sqlalchemy import text
from sqlalchemy.exc import IntegrityError

from core.errors import InternalError, LimitError
from store.database import Database
from store.events import Events
from store.jobs import Jobs
from store.settings import Settings
from store.workspace import DEFAULT_WORKSPACE
from tests.postgres import running_postgres
from tests.store.samples import claimed

WRITER = """
import sys
from store.database import Database
from store.jobs import Jobs
from store.settings import Settings
from store.workspace import DEFAULT_WORKSPACE

jobs = Jobs(Database(Settings()))
while True:
    job = jobs.claim(jobs.create(DEFAULT_WORKSPACE, "shells", {}).id, 1, "w", 30.0)
    print(job.id, flush=True)
"""


def test_sqlite_is_set_up_for_durable_writers_beside_readers(tmp_path: Path) -> None:
    database = Database(Settings(data_dir=tmp_path))
    with database.reading() as session:
        found = {
            name: session.execute(text(f"PRAGMA {name}")).scalar_one()
            for name in ("journal_mode", "synchronous", "foreign_keys", "busy_timeout")
        }
    database.close()
    assert found == {"journal_mode": "wal", "synchronous": 2, "foreign_keys": 1, "busy_timeout": 10_000}


def test_postgres_is_set_up_in_utc_and_never_waits_for_ever(postgres_settings: Settings) -> None:
    database = Database(postgres_settings)
    with database.reading() as session:
        found = {name: session.execute(text(f"SHOW {name}")).scalar_one() for name in ("timezone", "lock_timeout")}
    database.close()
    assert found == {"timezone": "UTC", "lock_timeout": "10s"}


def test_the_clock_is_utc(db: Database) -> None:
    with db.session() as session:
        now = db.now(session)
    assert now.tzinfo is UTC
    assert abs((now - datetime.now(UTC)).total_seconds()) < 5


def test_a_reader_does_not_wait_for_a_writer(db: Database, jobs: Jobs) -> None:
    job = jobs.create(DEFAULT_WORKSPACE, "shells", {})
    with db.session() as session:
        jobs.create(DEFAULT_WORKSPACE, "shells", {}, session=session)
        assert [seen.id for seen in jobs.list(DEFAULT_WORKSPACE).items] == [job.id]
        assert jobs.get(DEFAULT_WORKSPACE, job.id) == job
    assert len(jobs.list(DEFAULT_WORKSPACE).items) == 2


def test_the_tables_refuse_a_state_that_cannot_be(db: Database, jobs: Jobs) -> None:
    job = claimed(jobs)
    for nonsense in ("status = 'lost'", "lease_until = NULL"):
        with pytest.raises(IntegrityError), db.session() as session:
            session.execute(text(f"UPDATE jobs SET {nonsense}"))
    assert jobs.get(DEFAULT_WORKSPACE, job.id) == job


def test_ping_answers(db: Database) -> None:
    db.ping()
    assert db.is_migrated()


def test_an_absent_postgres_is_unavailable_and_back_again(tmp_path: Path) -> None:
    with running_postgres() as server:
        database = Database(Settings(data_dir=tmp_path, database_url=server.new_database()))
        database.migrate()
        jobs = Jobs(database)
        job = jobs.create(DEFAULT_WORKSPACE, "shells", {})
        server.restart()
        assert jobs.get(DEFAULT_WORKSPACE, job.id) == job  # the connection that broke is not noticed
        server.stop()
        for ask in (database.ping, database.is_migrated, database.migrate, partial(jobs.list, DEFAULT_WORKSPACE)):
            with pytest.raises(InternalError) as caught:
                ask()
            assert caught.value.code == "database.unavailable"
            assert caught.value.retryable
        server.start()
        assert jobs.get(DEFAULT_WORKSPACE, job.id) == job
        database.close()


def test_a_locked_sqlite_is_unavailable(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("store.database.BUSY_TIMEOUT_S", 0.1)
    database, other = (Database(Settings(data_dir=tmp_path)) for _ in range(2))
    database.migrate()
    with database.session() as session:
        Jobs(database).create(DEFAULT_WORKSPACE, "shells", {}, session=session)
        with pytest.raises(InternalError) as caught:
            Jobs(other).create(DEFAULT_WORKSPACE, "shells", {})
    assert caught.value.code == "database.unavailable"
    database.close()
    other.close()


def test_a_full_sqlite_is_a_limit(tmp_path: Path) -> None:
    database = Database(Settings(data_dir=tmp_path))
    database.migrate()
    jobs = Jobs(database)

    def fill() -> None:
        with database.session() as session:
            session.execute(text("PRAGMA max_page_count = 1"))
            for _ in range(100):
                jobs.create(DEFAULT_WORKSPACE, "shells", {"text": "x" * 10_000}, session=session)

    with pytest.raises(LimitError) as caught:
        fill()
    assert caught.value.code == "storage.full"
    assert jobs.list(DEFAULT_WORKSPACE).items == ()
    database.close()


def test_what_was_accepted_survives_kill_9(settings: Settings, db: Database, jobs: Jobs, events: Events) -> None:
    writer = subprocess.Popen(
        [sys.executable, "-c", WRITER], env={**os.environ, **settings.as_environment()}, stdout=subprocess.PIPE, text=True
    )
    assert writer.stdout is not None
    told = [writer.stdout.readline().strip() for _ in range(20)]
    writer.send_signal(signal.SIGKILL)
    told += [line for line in writer.stdout.read().split("\n")[:-1] if line]
    writer.wait(timeout=30)
    writer.stdout.close()
    kept = {job.id: job for job in jobs.list(DEFAULT_WORKSPACE, limit=100_000).items}
    assert set(told) <= set(kept)
    assert len(kept) - len(told) <= 1
    for job in kept.values():
        assert [event.seq for event in events.after(DEFAULT_WORKSPACE, job.id)] == list(range(1, job.event_seq + 1))
        assert job.event_seq == (2 if job.status == "running" else 1)
