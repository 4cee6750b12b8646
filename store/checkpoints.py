"""Checkpoints of running jobs: kept under the fencing token, found by the next attempt."""

from __future__ import annotations

from datetime import timedelta

from sqlalchemy import delete, func, select

from store.blobs import require_digest
from store.checkpoint import Checkpoint, usable_by
from store.database import Database
from store.job import JobStatus
from store.records import JobCheckpointRow, JobRow
from store.storable import storable_text
from store.transition import held

MOST = 500  # of one job: far above the steps of any process
MAX_STAGE = 200


class Checkpoints:
    """Thread-safe. They count for no quota: a job has `limit_bytes` for them, and they go when it succeeds."""

    def __init__(self, db: Database, limit_bytes: int) -> None:
        self._db = db
        self._limit_bytes = limit_bytes

    def of(self, job_id: str) -> tuple[Checkpoint, ...]:
        """Each key once, in the order in which they were made."""
        with self._db.reading() as session:
            row = session.get(JobRow, job_id)
            if row is None:
                return ()
            query = select(JobCheckpointRow).where(usable_by(row))
            rows = session.scalars(query.order_by(JobCheckpointRow.created_at, JobCheckpointRow.key)).all()
            found = {row.key: Checkpoint(row.key, row.stage, row.sha256, row.size) for row in rows}
            return tuple(found.values())

    def keep(self, job_id: str, token: int, checkpoint: Checkpoint) -> bool:
        """Write one down; its blob must be stored already. False if the lease is lost or the job has too many of them."""
        require_digest(checkpoint.key)
        with self._db.session() as session:
            row = held(session, job_id, token)
            if row is None or row.dismiss_requested:
                return False
            if session.get(JobCheckpointRow, (job_id, checkpoint.key)) is not None:
                return True
            own = JobCheckpointRow.job_id == job_id
            size = func.coalesce(func.sum(JobCheckpointRow.size), 0)
            count, used = session.execute(select(func.count(), size).where(own)).one()
            if count >= MOST or int(used) + checkpoint.size > self._limit_bytes:
                return False
            session.add(
                JobCheckpointRow(
                    job_id=job_id,
                    key=checkpoint.key,
                    stage=storable_text(checkpoint.stage, MAX_STAGE),
                    sha256=checkpoint.sha256,
                    size=checkpoint.size,
                    created_at=self._db.now(session),
                )
            )
            return True

    def sweep(self, days: float) -> int:
        """Forget those of jobs that failed longer ago; returns how many."""
        with self._db.session() as session:
            before = self._db.now(session) - timedelta(days=days)
            stale = select(JobRow.id).where(JobRow.status == JobStatus.FAILED, JobRow.finished_at < before)
            forgotten = delete(JobCheckpointRow).where(JobCheckpointRow.job_id.in_(stale)).returning(JobCheckpointRow.key)
            return len(session.scalars(forgotten).all())
