"""Counting what there is to do, on both databases."""

from __future__ import annotations

from store.backlog import Backlog
from store.database import Database
from store.job import JobStatus
from store.jobs import Jobs
from store.workspace import DEFAULT_WORKSPACE
from tests.store.samples import claimed, finish


def test_an_empty_table_is_no_backlog(db: Database) -> None:
    count = Backlog(db).count()
    assert (count.jobs, count.oldest_waiting_s) == ({}, 0.0)


def test_jobs_are_counted_by_process_and_status(db: Database, jobs: Jobs) -> None:
    jobs.create(DEFAULT_WORKSPACE, "shells", {})
    jobs.create(DEFAULT_WORKSPACE, "shells", {})
    claimed(jobs, "shells")
    finish(jobs, claimed(jobs, "validate"))
    count = Backlog(db).count()
    assert count.jobs == {
        ("shells", JobStatus.ACCEPTED): 2,
        ("shells", JobStatus.RUNNING): 1,
        ("validate", JobStatus.SUCCESSFUL): 1,
    }
    assert 0.0 < count.oldest_waiting_s < 60.0
