"""Presence: who gives word is there, who falls silent is lost, who says goodbye is gone; on both databases."""

from __future__ import annotations

from dataclasses import replace
from datetime import timedelta

import pytest
from sqlalchemy import insert, update

from core.schema.expectation import JobQueue
from store.crew_records import WorkerRow
from store.database import Database
from store.settings import Settings
from store.workers import KEPT_S, Workers, WorkerState, WorkerWord, stale_s

WORD = WorkerWord("host-a:17", "host-a", "0.1.0", 2, 16 * 1024**3, 10**11)


@pytest.fixture
def workers(db: Database, settings: Settings) -> Workers:
    """The table, empty."""
    return Workers(db, settings)


def silence(db: Database, name: str, seconds: float) -> None:
    """As if its last word were that much older."""
    with db.session() as session:
        row = session.get_one(WorkerRow, name)
        session.execute(update(WorkerRow).where(WorkerRow.name == name).values(seen_at=row.seen_at - timedelta(seconds=seconds)))


def test_a_worker_is_what_it_last_said(workers: Workers) -> None:
    assert workers.list() == []
    assert not workers.served_queues()
    workers.beat(WORD)
    workers.beat(WorkerWord("host-b:3", "host-b", "0.2.0", 8, 2**40, 10**9))
    first, second = workers.list()
    assert (first.word, first.state) == (WORD, WorkerState.ALIVE)
    assert second.word.version == "0.2.0"
    assert 0 <= first.silent_s < 30
    began = first.started_at
    workers.beat(replace(WORD, draining=True))
    first, _ = workers.list()
    assert first.state is WorkerState.DRAINING
    assert first.started_at == began
    assert first.seen_at > began
    assert workers.served_queues(), "the other one"
    workers.leave("host-b:3")
    assert not workers.served_queues(), "one that drains takes nothing"


def test_silence_means_lost_and_at_last_forgotten(workers: Workers, db: Database, settings: Settings) -> None:
    assert stale_s(settings) == 60
    workers.beat(WORD)
    silence(db, WORD.name, 55)
    assert workers.served_queues()
    silence(db, WORD.name, 10)
    (lost,) = workers.list()
    assert lost.state is WorkerState.LOST
    assert lost.silent_s > 60
    assert not workers.served_queues()
    assert workers.sweep() == 0, "an operator wants to see whom he lost"
    silence(db, WORD.name, KEPT_S)
    assert workers.sweep() == 1
    assert workers.list() == []


def test_who_comes_back_lives(workers: Workers, db: Database) -> None:
    workers.beat(WORD)
    silence(db, WORD.name, 600)
    workers.beat(WORD)
    assert workers.served_queues()


def test_a_queue_is_served_by_those_that_take_its_jobs(workers: Workers, db: Database) -> None:
    workers.beat(replace(WORD, queues=(JobQueue.FAST,)))
    assert workers.served_queues() == {JobQueue.FAST}
    workers.beat(replace(WORD, name="host-b:3", queues=(JobQueue.HEAVY,)))
    assert workers.served_queues() == set(JobQueue)
    silence(db, "host-b:3", 61)
    assert workers.served_queues() == {JobQueue.FAST}


def test_a_worker_of_the_version_before_serves_both(workers: Workers, db: Database) -> None:
    """It writes its row without the column."""
    old = {"name": "old:1", "host": "old", "version": "0.0.9", "concurrency": 1, "memory_bytes": 1, "disk_free_bytes": 1}
    with db.session() as session:
        now = db.now(session)
        session.execute(insert(WorkerRow).values(**old, draining=False, started_at=now, seen_at=now))
    assert workers.served_queues() == set(JobQueue)
