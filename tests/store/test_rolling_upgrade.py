"""Migrations while jobs are there, and two versions of the server on one database; on both databases."""

from __future__ import annotations

from collections.abc import Iterator
from datetime import UTC, datetime, timedelta
from pathlib import Path

import pytest
from sqlalchemy import text

from core.errors import StateError
from core.schema.expectation import UNKNOWN, Expectation, JobQueue
from store.choice import Room
from store.database import Database
from store.job import Job, JobStatus
from store.jobs import Jobs
from store.schema_check import require_own_schema
from store.settings import Settings
from store.workspace import DEFAULT_WORKSPACE
from tests.postgres import PostgresServer
from tests.store.earlier_version import REVISION, EarlierVersion
from tests.store.samples import claimed, finish

BOTH = frozenset(JobQueue)
ROOM = Room("host", BOTH, BOTH, memory_bytes=10**11, job_memory_bytes=10**10, patience_s=60.0)
LATER = datetime.now(UTC) + timedelta(hours=1)


@pytest.fixture(params=["sqlite", "postgresql"])
def db(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[Database]:
    """A migrated database of the test's own."""
    server: PostgresServer | None = request.getfixturevalue("postgres") if request.param == "postgresql" else None
    settings = Settings(data_dir=tmp_path) if server is None else Settings(data_dir=tmp_path, database_url=server.new_database())
    database = Database(settings)
    database.migrate()
    yield database
    database.close()


def take(jobs: Jobs) -> Job | None:
    return jobs.claim_next("host:1", 30.0, ROOM)


def test_jobs_survive_the_way_back_and_up_again(db: Database) -> None:
    jobs, earlier = Jobs(db), EarlierVersion(db)
    expectation = Expectation(123_000_000, 4.0)
    waiting = jobs.create(DEFAULT_WORKSPACE, "validate", {"a": 1}, expectation=expectation)
    running, done = claimed(jobs), claimed(jobs)
    finish(jobs, done)
    db.revert(REVISION)
    assert [earlier.status(job.id) for job in (waiting, running, done)] == ["accepted", "running", "successful"]
    accepted_below = earlier.accept(b=2)
    db.migrate()
    for job in (waiting, running):
        now = jobs.get(DEFAULT_WORKSPACE, job.id)
        assert (now.inputs, now.attempt, now.lease_token, now.lease_owner) == (
            *(job.inputs, job.attempt, job.lease_token, job.lease_owner),
        )
        assert (now.queue, now.expected_memory_bytes, now.expected_cpu_s) == (UNKNOWN.queue, UNKNOWN.memory_bytes, None)
    assert jobs.renew(running.id, running.lease_token, 30.0).kept, "a worker that slept through it all still holds its job"
    assert finish(jobs, running)
    taken = [take(jobs), take(jobs)]
    assert [job.id for job in taken if job is not None] == [waiting.id, accepted_below]


def test_two_versions_share_the_work_and_no_job(db: Database) -> None:
    jobs, earlier = Jobs(db), EarlierVersion(db)
    old, new = earlier.accept(a=1), jobs.create(DEFAULT_WORKSPACE, "shells", {}, expectation=Expectation(10**8, 100.0)).id
    token = earlier.claim(new, LATER)
    assert token == 1, "what a new API accepts, an old worker runs"
    job = take(jobs)
    assert job is not None
    assert (job.id, job.queue, job.expected_memory_bytes) == (old, UNKNOWN.queue, UNKNOWN.memory_bytes)
    assert take(jobs) is None
    assert earlier.claim(old, LATER) is None
    assert earlier.finish(new, token)
    assert finish(jobs, job)
    assert not earlier.finish(old, job.lease_token)
    assert {jobs.get(DEFAULT_WORKSPACE, job_id).status for job_id in (old, new)} == {JobStatus.SUCCESSFUL}


def test_the_jobs_of_old_workers_count_for_fairness_and_memory(db: Database) -> None:
    jobs, earlier = Jobs(db), EarlierVersion(db)
    assert earlier.claim(earlier.accept(), LATER) is not None
    jobs.create(DEFAULT_WORKSPACE, "shells", {}, expectation=Expectation(10**8, 100.0))
    full = Room("old-host", BOTH, BOTH, memory_bytes=UNKNOWN.memory_bytes, job_memory_bytes=10**10, patience_s=60.0)
    assert jobs.claim_next("old-host:8", 30.0, full) is None
    assert take(jobs) is not None


def test_the_job_of_a_lost_old_worker_goes_on(db: Database) -> None:
    jobs, earlier = Jobs(db), EarlierVersion(db)
    job_id = earlier.accept()
    token = earlier.claim(job_id, datetime.now(UTC) - timedelta(seconds=1))
    assert token is not None
    [expired] = jobs.expire_leases()
    assert (expired.id, expired.attempt) == (job_id, 2)
    job = take(jobs)
    assert job is not None
    assert (job.id, job.attempt) == (job_id, 2)
    assert not earlier.finish(job_id, token), "its late word is fenced off"


def test_tables_of_another_version_are_named(db: Database) -> None:
    require_own_schema(db)
    db.revert(REVISION)
    with pytest.raises(StateError) as older:
        require_own_schema(db)
    assert (older.value.code, older.value.facts) == ("database.schema_older", {"revision": REVISION})
    with db.session() as session:
        session.execute(text("UPDATE alembic_version SET version_num = 'v9999'"))
    with pytest.raises(StateError) as newer:
        require_own_schema(db)
    assert (newer.value.code, newer.value.facts) == ("database.schema_newer", {"revision": "v9999"})
