"""What is expected of an attempt after one that ran out of memory, and of jobs no host can hold; on both databases."""

from __future__ import annotations

from datetime import UTC, datetime, timedelta

import pytest

from core.errors import InputError, IntegumentError, InternalError, LimitError
from core.schema.expectation import Expectation
from store.database import Database
from store.job import JobFailure, JobStatus
from store.jobs import Jobs
from store.larger_need import larger_need
from store.unfit import Unfit
from store.workspace import DEFAULT_WORKSPACE

MB = 10**6
OUT_OF_MEMORY = LimitError("limit.memory", "more than 700 MB", limit_bytes=700 * MB)
KILLED = InternalError("child.crashed", "SIGKILL", signal="SIGKILL")
CRASHED = InternalError("child.crashed", "SIGSEGV", signal="SIGSEGV")
LOST = InternalError("worker.lost", "gone")
OPEN = InputError("skin.not_closed", "3 open edges")


@pytest.mark.parametrize(
    ("error", "peak_mb", "next_mb"),
    [
        (OUT_OF_MEMORY, 700, 1050),
        (OUT_OF_MEMORY, None, 750),
        (OUT_OF_MEMORY, 100, 500),  # never less than before
        (KILLED, 600, 900),
        (LOST, None, 750),
        (CRASHED, 600, 500),
        (OPEN, 600, 500),
    ],
)
def test_only_what_may_have_been_memory_raises_the_need(error: IntegumentError, peak_mb: int | None, next_mb: int) -> None:
    peak_bytes = None if peak_mb is None else peak_mb * MB
    assert larger_need(500 * MB, JobFailure.of(error), peak_bytes) == next_mb * MB


def accept(jobs: Jobs, mb: int) -> str:
    return jobs.create(DEFAULT_WORKSPACE, "shells", {}, expectation=Expectation(mb * MB, 60.0)).id


def test_a_killed_attempt_is_followed_by_one_with_more_room(jobs: Jobs) -> None:
    job = jobs.claim(accept(jobs, 500), 1, "worker-1", 30.0)
    assert job is not None
    again = jobs.fail(job.id, job.lease_token, JobFailure.of(KILLED), peak_memory_bytes=600 * MB, retry=True)
    assert again is not None
    assert (again.status, again.attempt, again.expected_memory_bytes) == (JobStatus.ACCEPTED, 2, 900 * MB)


def test_a_lost_worker_raises_it_too(jobs: Jobs) -> None:
    job = jobs.claim(accept(jobs, 500), 1, "worker-1", 30.0)
    assert job is not None
    [again] = jobs.expire_leases(datetime.now(UTC) + timedelta(seconds=60))
    assert (again.attempt, again.expected_memory_bytes) == (2, 750 * MB)


def test_who_retries_after_running_out_gets_more_room(jobs: Jobs) -> None:
    job = jobs.claim(accept(jobs, 500), 1, "worker-1", 30.0)
    assert job is not None
    jobs.fail(job.id, job.lease_token, JobFailure.of(OUT_OF_MEMORY), peak_memory_bytes=800 * MB)
    assert jobs.retry(DEFAULT_WORKSPACE, job.id).expected_memory_bytes == 1200 * MB


def test_a_job_no_host_can_hold_fails_by_name_after_a_while(db: Database, jobs: Jobs) -> None:
    fits, large = accept(jobs, 900), accept(jobs, 3000)
    assert Unfit(db).fail(1000 * MB, 2000 * MB, wait_s=3600.0) == []
    [failed] = Unfit(db).fail(1000 * MB, 2000 * MB, wait_s=-1.0)
    assert (failed.id, failed.status) == (large, JobStatus.FAILED)
    assert failed.failure is not None
    assert (failed.failure.code, failed.failure.fault) == ("job.too_large_for_memory", "limit")
    assert failed.failure.facts == {"expected_bytes": 2000 * MB, "limit_bytes": 1000 * MB}
    assert jobs.get(DEFAULT_WORKSPACE, fits).status is JobStatus.ACCEPTED


def test_hosts_that_hold_any_job_are_never_too_small(db: Database, jobs: Jobs) -> None:
    accept(jobs, 3000)
    assert Unfit(db).fail(2000 * MB, 2000 * MB, wait_s=-1.0) == []
