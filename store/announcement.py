"""What becomes of a job is told by events, in the transaction that changes it."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from datetime import datetime
from typing import Any

from sqlalchemy.orm import Session

from store.job import Job, JobStatus
from store.records import EventRow, JobRow
from store.storable import storable

EVENT_LIMIT = 20_000  # ten hours of heartbeats

NewEvent = tuple[str, Mapping[str, Any]]


def append_events(session: Session, row: JobRow, events: Iterable[NewEvent], now: datetime) -> None:
    """Number the events on from the last one of this job.

    A job that talks without end is cut off after EVENT_LIMIT; what becomes of it is still told."""
    for kind, data in events:
        if row.event_seq >= EVENT_LIMIT and kind not in ("status", "done"):
            continue
        row.event_seq += 1
        session.add(EventRow(job_id=row.id, seq=row.event_seq, type=kind, data=storable(dict(data)), at=now))
    row.updated_at = now


def announce(session: Session, row: JobRow, now: datetime) -> None:
    """Tell what the job has become: `status`, or `done` when it is finished."""
    finished, data = JobStatus(row.status).is_finished, status_data(row)
    if finished:
        data |= {"verdict": row.verdict, "summary": row.summary, "failure": row.failure}
    append_events(session, row, [("done" if finished else "status", data)], now)


def status_data(job: Job | JobRow) -> dict[str, Any]:
    """Of an event `status`."""
    return {
        "status": str(job.status),
        "phase": job.phase,
        "progress": float(job.progress),
        "message": job.message,
        "attempt": job.attempt,
        "dismiss_requested": job.dismiss_requested,
    }
