"""The job table as its users see it: accept, look up, list, dismiss, retry; claims and reconciliation come with it."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from datetime import datetime
from typing import Any

from sqlalchemy import select
from sqlalchemy.orm import Session

from core.errors import StateError
from core.schema.expectation import UNKNOWN, Expectation, JobQueue
from store.acceptance import Membership, NewJob, accept_job
from store.admission import Admission
from store.announcement import announce
from store.callback import Subscriber
from store.claims import Claims
from store.cohort_end import reopen_cohort
from store.database import Database
from store.job import Job, JobStatus, MeshInput
from store.job_search import EVERY_JOB, JobSearch, jobs_query
from store.job_words import NO_WORDS, JobWords
from store.labelling import relabel_job
from store.page import Page, from_cursor, to_cursor
from store.parked import require_not_parked
from store.queue_position import find_queue_position
from store.quotas import Quotas
from store.reconciliation import Reconciliation
from store.records import JobRow
from store.retention_policy import RetentionPolicies
from store.transition import end_dismissed, no_such_job, owned, queue_again, snapshot
from store.workspace import WorkspaceId


class Jobs(Admission, Claims, Reconciliation):
    """Every state change commits together with its event. Thread-safe.

    To a workspace the jobs of others do not exist: they are looked for by id and workspace in one query, so what is foreign
    costs and says the same as what is not there."""

    def __init__(self, db: Database, quotas: Quotas | None = None, retention: RetentionPolicies | None = None) -> None:
        """Without `quotas` nobody is limited, and no request refused as parked: for workers, which only take what was accepted.

        With `retention`, jobs that are looked up tell when they expire."""
        super().__init__(db)
        self._quotas = quotas
        self._retention = retention

    def create(
        self,
        workspace: WorkspaceId,
        process: str,
        inputs: Mapping[str, Any],
        *,
        mesh_inputs: Iterable[MeshInput] = (),
        max_attempts: int = 2,
        subscriber: Subscriber | None = None,
        expectation: Expectation = UNKNOWN,
        words: JobWords = NO_WORDS,
        membership: Membership | None = None,
        session: Session | None = None,
    ) -> Job:
        """Accept a job; once this returns (or `session` commits), it survives everything. Ring the doorbell after that.

        Raises LimitError `quota.jobs`, `quota.bytes`, StateError `job.parked`."""
        new = NewJob(process, inputs, tuple(mesh_inputs), expectation, words, subscriber, membership)
        with self._db.session(session) as work:
            if self._quotas is not None:
                self._quotas.require_room_for_job(workspace, work)
                require_not_parked(work, workspace, new.fingerprint)
            return accept_job(work, workspace, new, max_attempts, self._db.now(work))

    def get(self, workspace: WorkspaceId, job_id: str) -> Job:
        """Raises StateError `job.not_found`."""
        with self._db.reading() as session:
            return self._dated(session, snapshot(owned(session, workspace, job_id)))

    def list(
        self,
        workspace: WorkspaceId,
        search: JobSearch = EVERY_JOB,
        *,
        limit: int = 50,
        cursor: str | None = None,
    ) -> Page[Job]:
        """Newest first. Raises InputError `cursor.invalid`."""
        query = jobs_query(workspace, search, None if cursor is None else from_cursor(cursor), limit + 1)
        with self._db.reading() as session:
            rows = session.scalars(query).all()
            more = len(rows) > limit
            items = tuple(self._dated(session, snapshot(row)) for row in rows[:limit])
            return Page(items, to_cursor(items[-1].created_at, items[-1].id) if more else None)

    def call(self, workspace: WorkspaceId, job_id: str, change: Callable[[JobWords], JobWords]) -> Job:
        """Give it another name or other labels, whatever its state: `change` gets those it has.

        Raises StateError `job.not_found`."""
        with self._db.session() as session:
            row = owned(session, workspace, job_id, lock=True)
            relabel_job(session, row, change(JobWords(row.name, tuple(row.labels or ()))))
            session.flush()
            return self._dated(session, snapshot(row))

    def _dated(self, session: Session, job: Job) -> Job:
        if self._retention is None or not job.status.is_finished:
            return job
        return replace(job, expires_at=self._retention.policy(job.workspace, session).expires_at(job.finished_at))

    def queue_position(self, workspace: WorkspaceId, job_id: str) -> int | None:
        """1 for the job that is taken next, those of all workspaces counted; None if the job does not wait.

        Raises StateError `job.not_found`."""
        with self._db.reading() as session:
            row = session.execute(
                select(JobRow.status, JobRow.queue, JobRow.queued_at).where(JobRow.id == job_id, JobRow.workspace == workspace)
            ).one_or_none()
            if row is None:
                raise no_such_job(job_id)
            if row.status != JobStatus.ACCEPTED:
                return None
            return find_queue_position(session, workspace, job_id, JobQueue(row.queue), row.queued_at)

    def position_of(self, workspace: WorkspaceId, job: Job) -> int:
        """The same for a job that was just accepted."""
        with self._db.reading() as session:
            return find_queue_position(session, workspace, job.id, job.queue, job.queued_at)

    def dismiss(self, workspace: WorkspaceId, job_id: str, *, keep_ended: bool = False) -> Job:
        """Take a job back: one that waits at once, a running one as soon as its worker has killed it (`dismiss_requested`).

        A finished one is removed, rows and events; its files go with the next sweep. With `keep_ended` it stays as it is.
        Returns the job as the user should see it: removed ones as `dismissed`. Raises StateError `job.not_found`."""
        with self._db.session() as session:
            row = owned(session, workspace, job_id, lock=True)
            now = self._db.now(session)
            status = JobStatus(row.status)
            if not status.is_finished:
                _take_back(session, row, now)
            elif not keep_ended:
                job = replace(snapshot(row), status=JobStatus.DISMISSED, message="removed")
                session.delete(row)
                return job
            return snapshot(row)

    def take_back(self, workspace: WorkspaceId, job_id: str) -> None:
        """As `dismiss`, but what has ended, or is gone, stays as it is."""
        with self._db.session() as session:
            row = session.scalars(
                select(JobRow).where(JobRow.id == job_id, JobRow.workspace == workspace).with_for_update()
            ).one_or_none()
            if row is not None and not JobStatus(row.status).is_finished:
                _take_back(session, row, self._db.now(session))

    def retry(self, workspace: WorkspaceId, job_id: str, *, session: Session | None = None) -> Job:
        """Queue a failed or dismissed job again, for one attempt more.

        Raises StateError `job.not_found`, `job.not_retryable`, `job.parked`, LimitError `quota.jobs`, `quota.bytes`."""
        with self._db.session(session) as work:
            if self._quotas is not None:
                self._quotas.require_room_for_job(workspace, work)
            row = owned(work, workspace, job_id, lock=True)
            if row.status not in (JobStatus.FAILED, JobStatus.DISMISSED):
                raise StateError(
                    "job.not_retryable",
                    f"job {job_id} is {row.status}; only failed and dismissed jobs can be retried",
                    job=job_id,
                    status=str(row.status),
                )
            if self._quotas is not None:
                require_not_parked(work, workspace, row.fingerprint)
            row.max_attempts = max(row.max_attempts, row.attempt + 1)
            row.queued_at = now = self._db.now(work)  # who asks once more waits once more
            queue_again(work, row, row.attempt + 1, "waits for a worker, retried on request", now)
            if row.cohort_id is not None:
                reopen_cohort(work, row.cohort_id)
            return snapshot(row)


def _take_back(session: Session, row: JobRow, now: datetime) -> None:
    if row.status == JobStatus.ACCEPTED:
        end_dismissed(session, row, now)
    elif not row.dismiss_requested:
        row.dismiss_requested, row.message = True, "is being dismissed"
        announce(session, row, now)
