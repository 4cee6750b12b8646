"""A request sent twice is done once, on both databases."""

from __future__ import annotations

import threading
from datetime import timedelta

import pytest
from sqlalchemy import update

from core.errors import StateError
from store import idempotency
from store.database import Database
from store.idempotency import IdempotencyKeys, Reply
from store.jobs import Jobs
from store.records import IdempotencyRow
from store.workspace import DEFAULT_WORKSPACE

REPLY = Reply(201, {"Location": "/v1/jobs/1"}, {"jobID": "1", "note": "é\x00"})


@pytest.fixture
def keys(db: Database) -> IdempotencyKeys:
    return IdempotencyKeys(db)


def age(db: Database, key: str, by: timedelta) -> None:
    """Let time pass for one key."""
    with db.session() as session:
        session.execute(update(IdempotencyRow).where(IdempotencyRow.key == key).values(created_at=db.now(session) - by))


def code_of(keys: IdempotencyKeys, key: str, fingerprint: str) -> str:
    with pytest.raises(StateError) as caught:
        keys.begin(DEFAULT_WORKSPACE, key, fingerprint)
    return caught.value.code


def test_the_second_request_gets_the_reply_of_the_first(keys: IdempotencyKeys) -> None:
    assert keys.begin(DEFAULT_WORKSPACE, "k", "f") is None
    assert code_of(keys, "k", "f") == "idempotency.in_flight"
    keys.complete(DEFAULT_WORKSPACE, "k", REPLY)
    assert keys.begin(DEFAULT_WORKSPACE, "k", "f") == REPLY
    assert keys.begin(DEFAULT_WORKSPACE, "k", "f") == REPLY
    assert keys.begin(DEFAULT_WORKSPACE, "other", "f") is None


def test_another_request_under_the_same_key_is_refused(keys: IdempotencyKeys) -> None:
    keys.begin(DEFAULT_WORKSPACE, "k", "f")
    assert code_of(keys, "k", "g") == "idempotency.mismatch"
    keys.complete(DEFAULT_WORKSPACE, "k", REPLY)
    assert code_of(keys, "k", "g") == "idempotency.mismatch"


def test_a_failed_request_may_be_sent_again(keys: IdempotencyKeys) -> None:
    keys.begin(DEFAULT_WORKSPACE, "k", "f")
    keys.abandon(DEFAULT_WORKSPACE, "k")
    assert keys.begin(DEFAULT_WORKSPACE, "k", "g") is None
    keys.complete(DEFAULT_WORKSPACE, "k", REPLY)
    keys.abandon(DEFAULT_WORKSPACE, "k")  # too late: it was answered
    assert keys.begin(DEFAULT_WORKSPACE, "k", "g") == REPLY


def test_the_reply_and_the_job_are_kept_together_or_not_at_all(keys: IdempotencyKeys, jobs: Jobs, db: Database) -> None:
    keys.begin(DEFAULT_WORKSPACE, "k", "f")

    def create_and_break() -> None:
        with db.session() as session:
            jobs.create(DEFAULT_WORKSPACE, "shells", {}, session=session)
            keys.complete(DEFAULT_WORKSPACE, "k", REPLY, session=session)
            raise RuntimeError("on purpose")

    with pytest.raises(RuntimeError, match="on purpose"):
        create_and_break()
    assert code_of(keys, "k", "f") == "idempotency.in_flight"
    assert jobs.list(DEFAULT_WORKSPACE).items == ()
    with db.session() as session:
        jobs.create(DEFAULT_WORKSPACE, "shells", {}, session=session)
        keys.complete(DEFAULT_WORKSPACE, "k", REPLY, session=session)
    assert keys.begin(DEFAULT_WORKSPACE, "k", "f") == REPLY
    assert len(jobs.list(DEFAULT_WORKSPACE).items) == 1


def test_a_request_that_died_with_its_server_gives_its_key_back(keys: IdempotencyKeys, db: Database) -> None:
    keys.begin(DEFAULT_WORKSPACE, "k", "f")
    age(db, "k", timedelta(seconds=idempotency.IN_FLIGHT_S - 30))
    assert code_of(keys, "k", "f") == "idempotency.in_flight"
    age(db, "k", timedelta(seconds=idempotency.IN_FLIGHT_S + 1))
    assert keys.begin(DEFAULT_WORKSPACE, "k", "f") is None
    assert code_of(keys, "k", "f") == "idempotency.in_flight"


def test_keys_are_kept_for_a_day(keys: IdempotencyKeys, db: Database) -> None:
    for key in ("old", "young"):
        keys.begin(DEFAULT_WORKSPACE, key, "f")
        keys.complete(DEFAULT_WORKSPACE, key, REPLY)
    age(db, "old", timedelta(hours=23.9))
    assert keys.begin(DEFAULT_WORKSPACE, "old", "f") == REPLY
    assert keys.sweep() == 0
    age(db, "old", timedelta(hours=24.1))
    assert keys.begin(DEFAULT_WORKSPACE, "old", "another request") is None
    age(db, "old", timedelta(hours=24.1))
    assert keys.sweep() == 1
    assert keys.begin(DEFAULT_WORKSPACE, "young", "f") == REPLY


def test_of_many_at_once_one_goes_on(keys: IdempotencyKeys) -> None:
    start = threading.Barrier(8)
    outcomes: list[str] = []

    def send() -> None:
        start.wait(timeout=30)
        try:
            outcomes.append("mine" if keys.begin(DEFAULT_WORKSPACE, "k", "f") is None else "replayed")
        except StateError as error:
            outcomes.append(error.code)

    threads = [threading.Thread(target=send) for _ in range(8)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert sorted(outcomes) == ["idempotency.in_flight"] * 7 + ["mine"]
