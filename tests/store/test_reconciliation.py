"""What lost workers and lost messages leave behind is put right, on both databases."""

from __future__ import annotations

from datetime import UTC, datetime, timedelta

import pytest

from store import reconciliation
from store.job import JobStatus
from store.jobs import Jobs
from store.workspace import DEFAULT_WORKSPACE
from tests.store.samples import claimed


def test_a_living_lease_is_left_alone(jobs: Jobs) -> None:
    job = claimed(jobs)
    assert jobs.expire_leases() == []
    assert jobs.get(DEFAULT_WORKSPACE, job.id) == job


def test_a_lost_job_waits_for_its_next_attempt(jobs: Jobs) -> None:
    job = claimed(jobs)
    (expired,) = jobs.expire_leases(datetime.now(UTC) + timedelta(seconds=60))
    assert (expired.id, expired.status, expired.attempt, expired.lease_owner) == (job.id, JobStatus.ACCEPTED, 2, None)
    assert jobs.get(DEFAULT_WORKSPACE, job.id) == expired
    assert jobs.due_to_ring(3600.0) == [(job.id, 2)]
    assert jobs.renew(job.id, job.lease_token, 30.0).kept is False
    assert jobs.expire_leases(datetime.now(UTC) + timedelta(seconds=60)) == []


def test_a_lost_job_keeps_its_place_and_a_retried_one_goes_to_the_end(jobs: Jobs) -> None:
    lost = claimed(jobs)
    waiting = jobs.create(DEFAULT_WORKSPACE, "shells", {})
    jobs.expire_leases(datetime.now(UTC) + timedelta(seconds=60))
    assert [jobs.queue_position(DEFAULT_WORKSPACE, job.id) for job in (lost, waiting)] == [1, 2]
    jobs.dismiss(DEFAULT_WORKSPACE, lost.id)
    jobs.retry(DEFAULT_WORKSPACE, lost.id)
    assert [jobs.queue_position(DEFAULT_WORKSPACE, job.id) for job in (lost, waiting)] == [2, 1]


def test_a_renewed_lease_outlives_the_first(jobs: Jobs) -> None:
    job = claimed(jobs)
    jobs.renew(job.id, job.lease_token, 3600.0)
    assert jobs.expire_leases(datetime.now(UTC) + timedelta(seconds=60)) == []


def test_a_job_that_kills_its_workers_ends_failed(jobs: Jobs) -> None:
    job_id = jobs.create(DEFAULT_WORKSPACE, "shells", {}, max_attempts=3).id
    for attempt in (1, 2, 3):
        assert jobs.claim(job_id, attempt, f"worker-{attempt}", -1.0) is not None
        jobs.expire_leases()
    job = jobs.get(DEFAULT_WORKSPACE, job_id)
    assert (job.status, job.attempt) == (JobStatus.FAILED, 3)
    assert job.failure is not None
    assert (job.failure.code, job.failure.fault, job.failure.retryable) == ("worker.lost", "internal", True)
    assert job.failure.facts == {"attempts": 3, "worker": "worker-3"}
    assert jobs.due_to_ring(0.0) == []
    assert jobs.retry(DEFAULT_WORKSPACE, job_id).attempt == 4


def test_a_lost_job_under_dismissal_is_dismissed(jobs: Jobs) -> None:
    job = jobs.claim(jobs.create(DEFAULT_WORKSPACE, "shells", {}).id, 1, "worker", -1.0)
    assert job is not None
    jobs.dismiss(DEFAULT_WORKSPACE, job.id)
    (ended,) = jobs.expire_leases()
    assert ended.status is JobStatus.DISMISSED


def test_after_a_restart_no_lease_counts(jobs: Jobs) -> None:
    running, waiting = claimed(jobs), jobs.create(DEFAULT_WORKSPACE, "shells", {})
    (expired,) = jobs.expire_all_leases()
    assert (expired.id, expired.attempt) == (running.id, 2)
    assert jobs.get(DEFAULT_WORKSPACE, waiting.id).attempt == 1


def test_a_new_job_is_due_until_it_is_rung(jobs: Jobs) -> None:
    job = jobs.create(DEFAULT_WORKSPACE, "shells", {})
    assert jobs.due_to_ring(3600.0) == [(job.id, 1)]
    jobs.mark_all_rung([(job.id, 2)])  # some other attempt
    assert jobs.due_to_ring(3600.0) == [(job.id, 1)]
    jobs.mark_all_rung([(job.id, 1)])
    assert jobs.due_to_ring(3600.0) == []
    assert jobs.due_to_ring(-1.0) == [(job.id, 1)]  # the message may be lost


def test_running_and_finished_jobs_are_never_rung(jobs: Jobs) -> None:
    claimed(jobs)
    jobs.dismiss(DEFAULT_WORKSPACE, jobs.create(DEFAULT_WORKSPACE, "shells", {}).id)
    assert jobs.due_to_ring(-1.0) == []


def test_of_a_long_queue_only_the_head_is_rung_again(jobs: Jobs, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(reconciliation, "HEAD_OF_QUEUE", 2)
    rung = [jobs.create(DEFAULT_WORKSPACE, "shells", {}) for _ in range(4)]
    for job in rung:
        jobs.mark_all_rung([(job.id, 1)])
    assert jobs.due_to_ring(-1.0) == [(rung[0].id, 1), (rung[1].id, 1)]
    unheard = jobs.create(DEFAULT_WORKSPACE, "shells", {})
    assert jobs.due_to_ring(-1.0) == [(rung[0].id, 1), (rung[1].id, 1), (unheard.id, 1)]
