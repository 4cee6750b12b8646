"""Two writers of one job take turns, and the second sees what the first made of it, on both databases."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor

import pytest

from core.errors import StateError
from store.database import Database
from store.events import Events
from store.job import Job, JobStatus
from store.jobs import Jobs
from store.transition import end_dismissed, end_failed, held, owned, queue_again
from store.workspace import DEFAULT_WORKSPACE
from tests.store.samples import CRASHED, claimed, finish

WAIT_S = 0.2  # long enough for a call that does not wait to come back


def test_a_dismissal_waits_for_another_and_then_removes(jobs: Jobs, db: Database) -> None:
    job = jobs.create(DEFAULT_WORKSPACE, "shells", {})
    with ThreadPoolExecutor() as pool:
        with db.session() as session:
            row = owned(session, DEFAULT_WORKSPACE, job.id, lock=True)
            end_dismissed(session, row, db.now(session))
            session.flush()
            second = pool.submit(jobs.dismiss, DEFAULT_WORKSPACE, job.id)
            with pytest.raises(TimeoutError):
                second.result(timeout=WAIT_S)
        assert second.result(timeout=30).message == "removed"
    with pytest.raises(StateError):
        jobs.get(DEFAULT_WORKSPACE, job.id)


def test_a_worker_waits_for_the_reconciler_and_then_has_lost(jobs: Jobs, db: Database, events: Events) -> None:
    job = claimed(jobs)
    with ThreadPoolExecutor() as pool:
        with db.session() as session:
            row = held(session, job.id, job.lease_token)
            assert row is not None
            queue_again(session, row, 2, "lost", db.now(session))
            session.flush()
            calls = [
                pool.submit(finish, jobs, job),
                pool.submit(jobs.append_events, job.id, job.lease_token, [("log", {})]),
                pool.submit(lambda: jobs.renew(job.id, job.lease_token, 30.0).kept),
            ]
            with pytest.raises(TimeoutError):
                calls[0].result(timeout=WAIT_S)
        assert [call.result(timeout=30) for call in calls] == [False, False, False]
    now = jobs.get(DEFAULT_WORKSPACE, job.id)
    assert (now.status, now.attempt) == (JobStatus.ACCEPTED, 2)
    assert [event.seq for event in events.after(DEFAULT_WORKSPACE, job.id)] == [1, 2, 3]


def test_of_two_retries_one_wins(jobs: Jobs, db: Database) -> None:
    job = claimed(jobs)
    with db.session() as session:
        row = held(session, job.id, job.lease_token)
        assert row is not None
        end_failed(session, row, CRASHED, db.now(session))

    def retry(table: Jobs) -> Job | str:
        try:
            return table.retry(DEFAULT_WORKSPACE, job.id)
        except StateError as error:
            return error.code

    with ThreadPoolExecutor() as pool:
        outcomes = list(pool.map(retry, [jobs] * 4))
    assert outcomes.count("job.not_retryable") == 3
    assert jobs.get(DEFAULT_WORKSPACE, job.id).attempt == 2
