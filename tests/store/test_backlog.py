"""Counting what there is to do, on both databases."""

from __future__ import annotations

import pytest
from sqlalchemy import text

from core.schema.expectation import JobQueue
from store.backlog import Backlog
from store.database import Database
from store.job import JobStatus
from store.jobs import Jobs
from store.uploads import Uploads
from store.workspace import DEFAULT_WORKSPACE
from tests.store.samples import claimed, finish


def test_an_empty_table_is_no_backlog(db: Database) -> None:
    count = Backlog(db).count()
    assert (count.jobs, count.oldest_waiting_s, count.uploads) == ({}, {JobQueue.FAST: 0.0, JobQueue.HEAVY: 0.0}, 0)


def test_jobs_are_counted_by_process_and_status(db: Database, jobs: Jobs) -> None:
    jobs.create(DEFAULT_WORKSPACE, "shells", {})
    jobs.create(DEFAULT_WORKSPACE, "shells", {})
    claimed(jobs, "shells")
    finish(jobs, claimed(jobs, "validate"))
    count = Backlog(db).count()
    assert count.jobs == {
        ("shells", JobQueue.HEAVY, JobStatus.ACCEPTED): 2,
        ("shells", JobQueue.HEAVY, JobStatus.RUNNING): 1,
    }, "what has ended is counted elsewhere, and never again"
    assert (count.total(JobStatus.ACCEPTED), count.total(JobStatus.RUNNING)) == (2, 1)
    assert 0.0 < count.oldest_waiting_s[JobQueue.HEAVY] < 60.0
    assert count.oldest_waiting_s[JobQueue.FAST] == 0.0


def test_uploads_under_way_are_counted(db: Database) -> None:
    uploads = Uploads(db)
    done, _ = (uploads.create(DEFAULT_WORKSPACE, file_name="a.stl", fields={}, length=10) for _ in range(2))
    uploads.finish(DEFAULT_WORKSPACE, done.id, "0" * 36)
    assert Backlog(db).count().uploads == 1


@pytest.mark.parametrize("settings", ["postgresql"], indirect=True)
def test_a_look_does_not_grow_with_what_has_ended(db: Database) -> None:
    with db.session() as session:
        session.execute(text("SET LOCAL enable_seqscan = off"))  # so few rows are never worth an index to the planner
        plan = "\n".join(
            session.scalars(
                text("EXPLAIN SELECT process, status, count(*) FROM jobs WHERE status IN ('accepted', 'running') GROUP BY 1, 2")
            )
        )
    assert "status" in plan.partition("Index Cond")[2], plan
