"""A request whose attempts took down what worked on them is refused, with the evidence, until it is released."""

from __future__ import annotations

from datetime import UTC, datetime, timedelta

import pytest
from sqlalchemy import update

from core.errors import InputError, InternalError, StateError
from store.database import Database
from store.job import Job, JobFailure, JobStatus
from store.jobs import Jobs
from store.lost_attempt import LastWords
from store.parked import Parked
from store.quotas import Quotas
from store.records import ParkedRow
from store.settings import Settings
from store.stale_rows import StaleRows
from store.workspace import DEFAULT_WORKSPACE, WorkspaceId
from store.workspaces import Workspaces

CRASHED = JobFailure.of(InternalError("child.crashed", "the work was ended by signal SIGSEGV", signal="SIGSEGV"))
REFUSED = JobFailure.of(InputError("mesh.empty", "nothing there"))
WORDS = LastWords(signal="SIGSEGV", peak_memory_bytes=2**40, log="Fatal Python error\x00")


@pytest.fixture
def parked(db: Database) -> Parked:
    return Parked(db)


def claim(jobs: Jobs, job: Job, attempt: int, worker: str = "host:1") -> Job:
    claimed = jobs.claim(job.id, attempt, worker, 30)
    assert claimed is not None
    jobs.renew(claimed.id, claimed.lease_token, 30, progress=40, phase="shells: fat", peak_memory_bytes=2**30)
    return claimed


def lose(jobs: Jobs) -> Job:
    [job] = jobs.expire_leases(datetime.now(UTC) + timedelta(days=1))
    return job


def limited(db: Database) -> Jobs:
    """As the API has it."""
    return Jobs(db, Quotas(db, default_bytes=0, default_jobs=0))


def refusal(db: Database, job: Job) -> StateError | None:
    """Of the request of `job`, sent once more by somebody who is limited."""
    try:
        with db.session() as session:
            limited(db).create(job.workspace, job.process, job.inputs, session=session)
            session.rollback()
    except StateError as error:
        return error
    return None


def test_two_losses_park_the_request_with_its_evidence(jobs: Jobs, db: Database, parked: Parked) -> None:
    job = jobs.create(DEFAULT_WORKSPACE, "shells", {"depth": 1})
    first = claim(jobs, job, 1)
    again = jobs.fail(first.id, first.lease_token, CRASHED, retry=True, last_words=WORDS)
    assert again is not None
    assert again.status is JobStatus.ACCEPTED
    assert refusal(db, job) is None, "once may be chance"
    claim(jobs, job, 2, "other:2")
    assert lose(jobs).status is JobStatus.FAILED
    error = refusal(db, job)
    assert error is not None
    assert (error.code, error.facts) == ("job.parked", {"job": job.id, "attempts": 2})

    one, two = parked.attempts(DEFAULT_WORKSPACE, job.id)
    assert (one.attempt, one.worker, one.code, one.signal) == (1, "host:1", "child.crashed", "SIGSEGV")
    assert (one.phase, one.progress, one.peak_memory_bytes) == ("shells: fat", 40.0, 2**40)
    assert one.log == "Fatal Python error\ufffd"
    assert one.started_at is not None
    assert one.started_at <= one.ended_at
    assert (two.attempt, two.worker, two.code, two.signal, two.log) == (2, "other:2", "worker.lost", None, "")
    assert two.peak_memory_bytes == 2**30, "as the last heartbeat told"

    with pytest.raises(StateError, match="took down 2 worker"):
        limited(db).retry(DEFAULT_WORKSPACE, job.id)
    assert jobs.get(DEFAULT_WORKSPACE, job.id).status is JobStatus.FAILED
    twin, other = (jobs.create(DEFAULT_WORKSPACE, "shells", {"depth": depth}) for depth in (1, 2))
    assert refusal(db, twin) is not None
    assert refusal(db, other) is None
    Workspaces(db).create("other")
    assert refusal(db, jobs.create(WorkspaceId("other"), "shells", {"depth": 1})) is None


def test_what_was_parked_long_ago_may_be_tried_again(jobs: Jobs, db: Database, parked: Parked, settings: Settings) -> None:
    job = jobs.create(DEFAULT_WORKSPACE, "shells", {}, max_attempts=1)
    claim(jobs, job, 1)
    lose(jobs)
    stale = StaleRows(db, settings.model_copy(update={"parked_days": 30.0}))
    assert (stale.count()["parked"], parked.sweep(30)) == (0, 0)
    assert refusal(db, job) is not None
    with db.session() as session:
        session.execute(update(ParkedRow).values(parked_at=db.now(session) - timedelta(days=31)))
    assert stale.count()["parked"] == 1
    assert stale.sweep()["parked"] == 1
    assert parked.list() == []
    assert refusal(db, job) is None


def test_evidence_outlives_the_job_and_ends_with_the_release(jobs: Jobs, db: Database, parked: Parked) -> None:
    job = jobs.create(DEFAULT_WORKSPACE, "shells", {}, max_attempts=1)
    crashed = claim(jobs, job, 1)
    jobs.fail(crashed.id, crashed.lease_token, CRASHED, retry=True, last_words=WORDS)
    twin = jobs.create(DEFAULT_WORKSPACE, "shells", {})
    jobs.dismiss(DEFAULT_WORKSPACE, job.id)  # removes it
    [kept] = parked.list()
    assert (kept.job_id, kept.process, kept.code, kept.workspace) == (job.id, "shells", "child.crashed", DEFAULT_WORKSPACE)
    assert [attempt["log"] for attempt in kept.evidence] == ["Fatal Python error\ufffd"]
    assert parked.list(WorkspaceId("nobody")) == []
    assert parked.get(job.id) == parked.get(twin.id) == kept
    assert parked.release(twin.id) == kept
    assert refusal(db, twin) is None
    with pytest.raises(StateError, match="no request is parked"):
        parked.release(job.id)
    with pytest.raises(StateError, match="there is no job"):
        parked.attempts(DEFAULT_WORKSPACE, job.id)


def test_other_ends_park_nothing(jobs: Jobs, db: Database, parked: Parked) -> None:
    refused = jobs.create(DEFAULT_WORKSPACE, "shells", {"why": "input"})
    first = claim(jobs, refused, 1)
    jobs.fail(first.id, first.lease_token, CRASHED, retry=True, last_words=WORDS)
    second = claim(jobs, refused, 2)
    jobs.fail(second.id, second.lease_token, REFUSED)
    handed_back = claim(jobs, jobs.create(DEFAULT_WORKSPACE, "shells", {"why": "drain"}), 1)
    jobs.release(handed_back.id, handed_back.lease_token)
    dismissed = claim(jobs, jobs.create(DEFAULT_WORKSPACE, "shells", {"why": "user"}, max_attempts=1), 1)
    jobs.dismiss(DEFAULT_WORKSPACE, dismissed.id)
    lose(jobs)
    whole_service = claim(jobs, jobs.create(DEFAULT_WORKSPACE, "shells", {"why": "power"}, max_attempts=1), 1)
    [failed] = jobs.expire_all_leases()
    assert (failed.id, failed.status) == (whole_service.id, JobStatus.FAILED)
    assert parked.list() == []
    alone = claim(jobs, jobs.create(DEFAULT_WORKSPACE, "shells", {"why": "worker"}, max_attempts=1), 1)
    jobs.expire_all_leases(worker_crashed=True)
    assert [request.job_id for request in parked.list()] == [alone.id]
    assert [len(parked.attempts(DEFAULT_WORKSPACE, job.id)) for job in (refused, handed_back, dismissed, failed)] == [1, 0, 0, 1]


def test_finish_told_twice_is_done_once(jobs: Jobs) -> None:
    job = claim(jobs, jobs.create(DEFAULT_WORKSPACE, "shells", {}), 1)

    def finish(token: int) -> bool:
        return jobs.finish(job.id, token, verdict="not_ready", summary="done", outputs={}, timings_s={})

    assert finish(job.lease_token)
    once = jobs.get(DEFAULT_WORKSPACE, job.id)
    assert finish(job.lease_token), "the answer to the first was lost on its way"
    assert not finish(job.lease_token - 1)
    assert jobs.get(DEFAULT_WORKSPACE, job.id) == once
    assert jobs.fail(job.id, job.lease_token, REFUSED) is None
    assert not jobs.release(job.id, job.lease_token)
