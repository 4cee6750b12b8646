"""Reading the events of a job: what an SSE stream sends."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from datetime import datetime
from typing import Any

from sqlalchemy import select

from store.database import Database
from store.records import EventRow, JobRow
from store.workspace import WorkspaceId


@dataclass(frozen=True, slots=True)
class Event:
    """`seq` counts 1, 2, 3, … within one job; `type` is status, progress, log or done.

    data of status and done: status, phase, progress, message, attempt, dismiss_requested;
    done has verdict, summary, failure besides.
    progress: progress, phase, message. log: what the worker sent. After a retry a stream goes on beyond `done`."""

    job_id: str
    seq: int
    type: str
    data: Mapping[str, Any]
    at: datetime


class Events:
    """Events become visible in order and without gaps: a number is given out under the lock of its job's row."""

    def __init__(self, db: Database) -> None:
        self._db = db

    def after(self, workspace: WorkspaceId, job_id: str, seq: int = 0, limit: int = 500) -> list[Event]:
        """Those with a higher number, in order; empty if there is nothing new or no such job in the workspace."""
        query = (
            select(EventRow)
            .join(JobRow, JobRow.id == EventRow.job_id)
            .where(JobRow.workspace == workspace, EventRow.job_id == job_id, EventRow.seq > seq)
            .order_by(EventRow.seq)
            .limit(limit)
        )
        with self._db.reading() as session:
            return [Event(row.job_id, row.seq, row.type, row.data, row.at) for row in session.scalars(query)]
