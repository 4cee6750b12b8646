"""A SQLite file shrinks when most of it is spare, while others write."""

from __future__ import annotations

import sqlite3
import threading
from collections.abc import Iterator
from pathlib import Path

import pytest
from sqlalchemy import text

from store.database import WAL_BYTES, Database
from store.jobs import Jobs
from store.settings import Settings
from store.sqlite_file import SPARE_SHARE, SqliteFile
from store.workspace import DEFAULT_WORKSPACE


@pytest.fixture
def db(tmp_path: Path) -> Iterator[Database]:
    database = Database(Settings(data_dir=tmp_path))
    database.migrate()
    yield database
    database.close()


def fill_and_empty(db: Database) -> None:
    jobs = Jobs(db)
    for _ in range(40):
        jobs.create(DEFAULT_WORKSPACE, "heal", {"text": "x" * 200_000})
    with db.session() as session:
        session.execute(text("DELETE FROM jobs"))


def test_spare_pages_go_back_while_others_write(db: Database) -> None:
    file = SqliteFile(db)
    fill_and_empty(db)
    before = file.measure()
    assert before.gives_back
    assert before.spare_bytes > 7_000_000
    stop = threading.Event()
    accepted = []

    def accept() -> None:
        while not stop.is_set():
            accepted.append(Jobs(db).create(DEFAULT_WORKSPACE, "heal", {}))

    writer = threading.Thread(target=accept)
    writer.start()
    try:
        file.give_back(60.0)
    finally:
        stop.set()
        writer.join()
    after = file.measure()
    assert after.bytes < before.bytes / 3
    assert after.spare_bytes <= SPARE_SHARE * after.bytes
    assert accepted
    assert after.wal_bytes <= WAL_BYTES
    assert db.sqlite_path.stat().st_size == pytest.approx(after.bytes, abs=2_000_000)


def test_a_file_that_is_full_stays_as_it_is(db: Database) -> None:
    Jobs(db).create(DEFAULT_WORKSPACE, "heal", {})
    assert SqliteFile(db).give_back() == 0
    assert SqliteFile(db).measure().wal_bytes == 0


def test_a_file_of_an_older_version_is_rewritten_on_request(tmp_path: Path) -> None:
    settings = Settings(data_dir=tmp_path)
    with sqlite3.connect(tmp_path / "integument.sqlite3") as old:
        old.execute("CREATE TABLE mine (x)")
    database = Database(settings)
    database.migrate()
    fill_and_empty(database)
    file = SqliteFile(database)
    assert not file.measure().gives_back
    assert file.give_back() == 0
    assert file.rewrite() > 7_000_000
    assert file.measure().gives_back
    assert database.is_migrated()
    database.close()
