"""A request sent twice is done once, on both databases."""

from __future__ import annotations

import threading
from datetime import timedelta

import pytest
from sqlalchemy import update

from core.errors import StateError
from store.database import Database
from store.idempotency import IdempotencyKeys, OvertakenError, Reply
from store.jobs import Jobs
from store.records import IdempotencyRow
from store.workspace import DEFAULT_WORKSPACE

REPLY = Reply(201, {"Location": "/v1/jobs/1"}, {"jobID": "1", "note": "é\x00"})
OTHER = Reply(201, {"Location": "/v1/jobs/2"}, {"jobID": "2"})


@pytest.fixture
def keys(db: Database) -> IdempotencyKeys:
    return IdempotencyKeys(db)


def keep(keys: IdempotencyKeys, db: Database, key: str, fingerprint: str, reply: Reply = REPLY) -> None:
    """As a request does when its work is done."""
    with db.session() as session:
        keys.keep(DEFAULT_WORKSPACE, key, fingerprint, reply, session)


def age(db: Database, key: str, by: timedelta) -> None:
    """Let time pass for one key."""
    with db.session() as session:
        session.execute(update(IdempotencyRow).where(IdempotencyRow.key == key).values(created_at=db.now(session) - by))


def test_the_second_request_gets_the_reply_of_the_first(keys: IdempotencyKeys, db: Database) -> None:
    assert keys.find(DEFAULT_WORKSPACE, "k", "f") is None
    keep(keys, db, "k", "f")
    assert keys.find(DEFAULT_WORKSPACE, "k", "f") == REPLY
    assert keys.find(DEFAULT_WORKSPACE, "other", "f") is None


def test_another_request_under_the_same_key_is_refused(keys: IdempotencyKeys, db: Database) -> None:
    keep(keys, db, "k", "f")
    with pytest.raises(StateError) as caught:
        keys.find(DEFAULT_WORKSPACE, "k", "g")
    assert caught.value.code == "idempotency.mismatch"


def test_a_reply_is_kept_once(keys: IdempotencyKeys, db: Database) -> None:
    keep(keys, db, "k", "f")
    with pytest.raises(OvertakenError):
        keep(keys, db, "k", "f", OTHER)
    assert keys.find(DEFAULT_WORKSPACE, "k", "f") == REPLY


def test_the_reply_and_the_job_are_kept_together_or_not_at_all(keys: IdempotencyKeys, jobs: Jobs, db: Database) -> None:
    def create_and_break() -> None:
        with db.session() as session:
            jobs.create(DEFAULT_WORKSPACE, "shells", {}, session=session)
            keys.keep(DEFAULT_WORKSPACE, "k", "f", REPLY, session)
            raise RuntimeError("on purpose")

    with pytest.raises(RuntimeError, match="on purpose"):
        create_and_break()
    assert keys.find(DEFAULT_WORKSPACE, "k", "f") is None
    assert jobs.list(DEFAULT_WORKSPACE).items == ()
    with db.session() as session:
        jobs.create(DEFAULT_WORKSPACE, "shells", {}, session=session)
        keys.keep(DEFAULT_WORKSPACE, "k", "f", REPLY, session)
    assert keys.find(DEFAULT_WORKSPACE, "k", "f") == REPLY
    assert len(jobs.list(DEFAULT_WORKSPACE).items) == 1


def test_a_key_an_older_version_left_when_it_was_killed_is_free(keys: IdempotencyKeys, db: Database) -> None:
    with db.session() as session:
        row = IdempotencyRow(workspace=DEFAULT_WORKSPACE, key="k", fingerprint="e", reply=None, created_at=db.now(session))
        session.add(row)
    assert keys.find(DEFAULT_WORKSPACE, "k", "f") is None
    keep(keys, db, "k", "f")
    assert keys.find(DEFAULT_WORKSPACE, "k", "f") == REPLY


def test_keys_are_kept_for_a_day(keys: IdempotencyKeys, db: Database) -> None:
    for key in ("old", "young"):
        keep(keys, db, key, "f")
    age(db, "old", timedelta(hours=23.9))
    assert keys.find(DEFAULT_WORKSPACE, "old", "f") == REPLY
    assert keys.sweep() == 0
    age(db, "old", timedelta(hours=24.1))
    assert keys.find(DEFAULT_WORKSPACE, "old", "another request") is None
    keep(keys, db, "old", "another request", OTHER)
    assert keys.find(DEFAULT_WORKSPACE, "old", "another request") == OTHER
    age(db, "old", timedelta(hours=24.1))
    assert keys.sweep() == 1
    assert keys.find(DEFAULT_WORKSPACE, "young", "f") == REPLY


def test_of_many_at_once_one_does_the_work(keys: IdempotencyKeys, jobs: Jobs, db: Database) -> None:
    start = threading.Barrier(8)
    outcomes: list[str] = []

    def send() -> None:
        start.wait(timeout=30)
        try:
            with db.session() as session:
                jobs.create(DEFAULT_WORKSPACE, "shells", {}, session=session)
                keys.keep(DEFAULT_WORKSPACE, "k", "f", REPLY, session)
            outcomes.append("done")
        except OvertakenError:
            outcomes.append("overtaken")

    threads = [threading.Thread(target=send) for _ in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert sorted(outcomes) == ["done"] + ["overtaken"] * 7
    assert len(jobs.list(DEFAULT_WORKSPACE).items) == 1
