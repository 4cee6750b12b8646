"""Jobs no host can hold: they wait a while for a larger one, then they fail by name instead of waiting for ever."""

from __future__ import annotations

from datetime import timedelta

from sqlalchemy import select

from core.errors import LimitError
from store.database import Database
from store.job import Job, JobFailure, JobStatus
from store.records import JobRow
from store.transition import end_failed, snapshot


class Unfit:
    """The reconciler's look at what waits."""

    def __init__(self, db: Database) -> None:
        self._db = db

    def fail(self, largest_bytes: int, job_memory_bytes: int, wait_s: float) -> list[Job]:
        """End those that need more than `largest_bytes`, the memory of the largest host, and have waited for `wait_s`.

        No job needs more than `job_memory_bytes`, where its child is ended."""
        if largest_bytes >= job_memory_bytes:
            return []
        with self._db.session() as session:
            now = self._db.now(session)
            waiting = select(JobRow).where(
                JobRow.status == JobStatus.ACCEPTED,
                JobRow.queued_at < now - timedelta(seconds=wait_s),
                JobRow.expected_memory_bytes > largest_bytes,
            )
            rows = session.scalars(waiting.order_by(JobRow.queued_at, JobRow.id).with_for_update(skip_locked=True)).all()
            for row in rows:
                end_failed(session, row, _too_large(min(row.expected_memory_bytes, job_memory_bytes), largest_bytes), now)
            return [snapshot(row) for row in rows]


def _too_large(expected_bytes: int, limit_bytes: int) -> JobFailure:
    error = LimitError(
        "job.too_large_for_memory",
        f"the job needs about {expected_bytes} bytes of memory; jobs on the largest worker host may use {limit_bytes} together",
        expected_bytes=expected_bytes,
        limit_bytes=limit_bytes,
    )
    return JobFailure.of(error)
