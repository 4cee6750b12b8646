"""The jobs of all workspaces: the operator's side of the job table."""

from __future__ import annotations

from datetime import datetime

from sqlalchemy import Select, func, select, tuple_

from core.errors import StateError
from store.database import Database
from store.instant import Instant
from store.job import Job, JobStatus
from store.job_selector import JobSelector
from store.jobs import Jobs
from store.page import Page, from_cursor, to_cursor
from store.records import JobRow
from store.transition import snapshot


class AllJobs:
    """Quotas hold for users; what an operator queues again is not counted against them."""

    def __init__(self, db: Database) -> None:
        self._db = db
        self._jobs = Jobs(db)

    def list(self, selector: JobSelector, *, limit: int = 50, cursor: str | None = None) -> Page[Job]:
        """Newest first. Raises InputError `cursor.invalid`."""
        with self._db.reading() as session:
            query = _selected(selector, self._db.now(session))
            query = query.order_by(JobRow.created_at.desc(), JobRow.id.desc()).limit(limit + 1)
            if cursor is not None:
                query = query.where(tuple_(JobRow.created_at, JobRow.id) < from_cursor(cursor))
            rows = session.scalars(query).all()
            items = tuple(snapshot(row) for row in rows[:limit])
            return Page(items, to_cursor(items[-1].created_at, items[-1].id) if len(rows) > limit else None)

    def get(self, job_id: str) -> Job:
        """Raises StateError `job.not_found`."""
        with self._db.reading() as session:
            row = session.get(JobRow, job_id)
            if row is None:
                raise _is_missing(job_id)
            return snapshot(row)

    def dismiss(self, job_id: str) -> Job:
        """Take back one that waits or runs. Raises StateError `job.not_found`, `job.finished`."""
        job = self.get(job_id)
        if job.status.is_finished:
            raise StateError("job.finished", f"job {job_id} has ended, it is {job.status}", job=job_id, status=str(job.status))
        return self._jobs.dismiss(job.workspace, job_id)

    def retry(self, job_id: str) -> Job:
        """Queue a failed or dismissed one again; the reconciler announces it. Raises StateError as `Jobs.retry`."""
        return self._jobs.retry(self.get(job_id).workspace, job_id)

    def remove(self, job_id: str) -> Job:
        """Forget one that has ended, rows and events; its files go with the next sweep.

        Raises StateError `job.not_found`, `job.not_finished`."""
        with self._db.session() as session:
            row = session.get(JobRow, job_id, with_for_update=True)
            if row is None:
                raise _is_missing(job_id)
            if not JobStatus(row.status).is_finished:
                raise StateError(
                    "job.not_finished", f"job {job_id} is {row.status}; dismiss it first", job=job_id, status=str(row.status)
                )
            job = snapshot(row)
            session.delete(row)
            return job


def _is_missing(job_id: str) -> StateError:
    return StateError("job.not_found", f"there is no job {job_id[:80]}", job=job_id[:80])


def _selected(selector: JobSelector, now: datetime) -> Select[JobRow]:
    query = select(JobRow)
    if selector.statuses:
        query = query.where(JobRow.status.in_(selector.statuses))
    if selector.workspaces:
        query = query.where(JobRow.workspace.in_(selector.workspaces))
    if selector.processes:
        query = query.where(JobRow.process.in_(selector.processes))
    if selector.code is not None:
        query = query.where(JobRow.failure["code"].as_string() == selector.code)
    if selector.older_than is not None:
        query = query.where(func.coalesce(JobRow.finished_at, JobRow.created_at, type_=Instant()) < now - selector.older_than)
    return query
