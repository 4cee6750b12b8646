"""What a restored database must forget: workers, leases and requests of the world it was taken from."""

from __future__ import annotations

from sqlalchemy import delete, exists, select, update

from store.database import Database
from store.job import JobStatus
from store.records import CallbackRow, IdempotencyRow, JobRow, UploadPartRow, UploadRow
from store.transition import end_dismissed, queue_again


def revive(db: Database) -> int:
    """Queue again what was running; the attempt does not count. Returns how many. Safe to repeat."""
    with db.session() as session:
        now = db.now(session)
        rows = session.scalars(select(JobRow).where(JobRow.status == JobStatus.RUNNING).with_for_update()).all()
        for row in rows:
            if row.dismiss_requested:
                end_dismissed(session, row, now)
            else:
                queue_again(session, row, row.attempt, "restored from a backup, waits for a worker", now)
        session.flush()
        session.execute(update(JobRow).where(JobRow.status == JobStatus.ACCEPTED).values(rung_at=None))
        session.execute(update(CallbackRow).values(lease_until=None))
        in_store = exists().where(UploadPartRow.upload_id == UploadRow.id)  # else the pieces were on the disk of the old server
        session.execute(delete(UploadRow).where(UploadRow.mesh_id.is_(None), ~in_store))
        session.execute(delete(IdempotencyRow).where(IdempotencyRow.reply.is_(None)))
        return len(rows)
