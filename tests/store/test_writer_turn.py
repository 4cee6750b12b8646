"""Threads that write to one SQLite file take turns."""

from __future__ import annotations

import threading
from pathlib import Path

import pytest

from core.errors import InternalError
from store.database import Database
from store.jobs import Jobs
from store.settings import Settings
from store.workspace import DEFAULT_WORKSPACE
from store.writer_turn import WriterTurn


def test_a_turn_that_does_not_come_is_an_absent_database() -> None:
    turn = WriterTurn(0.05)
    with turn.held(), pytest.raises(InternalError) as caught, turn.held():
        pass
    assert caught.value.code == "database.unavailable"
    with turn.held():  # it was given back
        pass


def test_a_failed_transaction_gives_its_turn_back(tmp_path: Path) -> None:
    database = Database(Settings(data_dir=tmp_path))
    database.migrate()
    for _ in range(2):
        with pytest.raises(ZeroDivisionError), database.session():
            raise ZeroDivisionError
    assert Jobs(database).create(DEFAULT_WORKSPACE, "validate", {}).attempt == 1
    database.close()


def test_no_thread_waits_in_vain_while_many_write(tmp_path: Path) -> None:
    """SQLite's own handler lets some of them find the file locked each time they look."""
    database = Database(Settings(data_dir=tmp_path))
    database.migrate()
    jobs, failures = Jobs(database), []

    def write() -> None:
        try:
            for _ in range(5):
                jobs.create(DEFAULT_WORKSPACE, "validate", {})
        except InternalError as error:
            failures.append(error)

    threads = [threading.Thread(target=write) for _ in range(20)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert failures == []
    assert len(jobs.list(DEFAULT_WORKSPACE, limit=1000).items) == 100
    database.close()
