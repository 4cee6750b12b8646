"""Transactions of threads that ask at the same moment are one, and none of them loses anything by it."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from pathlib import Path
from typing import Any

import pytest
from sqlalchemy import event, select, text
from sqlalchemy.orm import Session

from core.errors import InternalError, StateError
from store.database import Database
from store.group_commit import MOST, GroupCommit
from store.records import WorkspaceRow
from store.settings import Settings
from tests.postgres import running_postgres

who: ContextVar[str] = ContextVar("who", default="nobody")


@contextmanager
def counted_commits(db: Database) -> Iterator[list[int]]:
    """Commits of this process, one entry each."""
    seen: list[int] = []

    def note(_connection: Any) -> None:
        seen.append(1)

    event.listen(db.engine, "commit", note)
    try:
        yield seen
    finally:
        event.remove(db.engine, "commit", note)


class Asker(threading.Thread):
    """Asks once, in a thread of its own; `name` tells the order of locks."""

    def __init__(self, group: GroupCommit, work: Callable[[Session], Any], lock_order: str = "") -> None:
        super().__init__(daemon=True)
        self.result: Any = None
        self.error: BaseException | None = None
        self._asked = (group, work, lock_order)

    def run(self) -> None:
        group, work, lock_order = self._asked
        try:
            self.result = group.run(work, lock_order)
        except Exception as error:  # noqa: BLE001 - looked at by the test
            self.error = error


def adding(name: str, db: Database) -> Callable[[Session], str]:
    def add(session: Session) -> str:
        session.add(WorkspaceRow(id=name, created_at=db.now(session)))
        session.flush()
        return name

    return add


def names(db: Database) -> set[str]:
    with db.reading() as session:
        return set(session.scalars(select(WorkspaceRow.id))) - {"default"}


@contextmanager
def held_back(group: GroupCommit, askers: list[Asker]) -> Iterator[None]:
    """While a first transaction is open, all of `askers` come; they are ended after the block."""
    entered, leave = threading.Event(), threading.Event()

    def hold(_session: Session) -> None:
        entered.set()
        assert leave.wait(20)

    first = Asker(group, hold)
    first.start()
    assert entered.wait(20)
    for number, asker in enumerate(askers):
        asker.start()
        while len(group._waiting) <= number:
            pass
    yield
    leave.set()
    for asker in (first, *askers):
        asker.join(30)
        assert not asker.is_alive()
    assert first.error is None


def test_those_who_wait_share_one_commit(db: Database) -> None:
    group = GroupCommit(db)
    askers = [Asker(group, adding(f"lab-{number}", db)) for number in range(8)]
    with counted_commits(db) as commits, held_back(group, askers):
        pass
    assert [asker.result for asker in askers] == [f"lab-{number}" for number in range(8)]
    assert names(db) == {f"lab-{number}" for number in range(8)}
    assert len(commits) == 2


def test_more_than_fit_are_led_by_one_of_their_own(db: Database) -> None:
    group = GroupCommit(db)
    askers = [Asker(group, adding(f"lab-{number:03}", db)) for number in range(MOST + 3)]
    with counted_commits(db) as commits, held_back(group, askers):
        pass
    assert len(names(db)) == MOST + 3
    assert len(commits) == 3


def test_one_that_is_refused_spoils_nothing_of_the_others(db: Database) -> None:
    group = GroupCommit(db)

    def refuse_late(session: Session) -> None:
        adding("half", db)(session)
        raise StateError("job.parked", "not this one")

    good, twin = (Asker(group, adding(name, db)) for name in ("good", "twin"))
    bad, second_twin = Asker(group, refuse_late), Asker(group, adding("twin", db))
    with held_back(group, [good, bad, twin, second_twin]):
        pass
    assert names(db) == {"good", "twin"}
    assert (good.result, twin.result) == ("good", "twin")
    assert isinstance(bad.error, StateError)
    assert bad.error.code == "job.parked"
    assert type(second_twin.error).__name__ == "IntegrityError"


def test_nobody_is_told_of_a_commit_that_failed(db: Database) -> None:
    """And nothing is done twice: nobody knows what became of it."""
    group, runs = GroupCommit(db), []

    def work(session: Session) -> None:
        runs.append(1)
        session.execute(text("SELECT 1"))

    def fail(_connection: Any) -> None:
        if runs:
            raise ConnectionError("the disk is gone")

    askers = [Asker(group, work) for _ in range(3)]
    with held_back(group, askers):
        event.listen(db.engine, "commit", fail)
        runs.clear()
    event.remove(db.engine, "commit", fail)
    assert [type(asker.error) for asker in askers if asker.error is not None] == [ConnectionError] * 3
    assert len(runs) == 3
    assert group.run(adding("later", db)) == "later"


def test_everybody_keeps_his_own_context(db: Database) -> None:
    group = GroupCommit(db)
    seen: dict[str, str] = {}

    def asking(name: str) -> Asker:
        def work(_session: Session) -> None:
            seen[name] = who.get()

        class Named(Asker):
            def run(self) -> None:
                who.set(name)
                super().run()

        return Named(group, work)

    with held_back(group, [asking("a"), asking("b")]):
        pass
    assert seen == {"a": "a", "b": "b"}


def test_locks_are_taken_in_one_order(db: Database) -> None:
    group = GroupCommit(db)
    order: list[str] = []

    def noting(name: str) -> Callable[[Session], None]:
        return lambda _session: order.append(name)

    askers = [Asker(group, noting(name), name) for name in ("c", "a", "b")]
    with held_back(group, askers):
        pass
    assert order == ["a", "b", "c"]


def test_all_who_wait_hear_at_once_that_the_database_is_away(tmp_path: Path) -> None:
    with running_postgres() as server:
        database = Database(Settings(data_dir=tmp_path, database_url=server.new_database()))
        database.migrate()
        group = GroupCommit(database)
        group.run(adding("before", database))
    askers = [Asker(group, adding(f"lab-{number}", database)) for number in range(5)]
    for asker in askers:
        asker.start()
    for asker in askers:
        asker.join(60)
    database.close()
    assert [getattr(asker.error, "code", None) for asker in askers] == ["database.unavailable"] * 5
    assert all(isinstance(asker.error, InternalError) for asker in askers)


def test_without_company_an_error_is_the_askers(db: Database) -> None:
    with pytest.raises(ZeroDivisionError):
        GroupCommit(db).run(lambda _session: 1 // 0)
    assert GroupCommit(db).run(adding("next", db)) == "next"
