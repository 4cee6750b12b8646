"""How much there is to do: numbers for dashboards and alarms, counted in the job table itself."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from datetime import datetime

from sqlalchemy import func, select

from store.database import Database
from store.instant import Instant
from store.job import JobStatus
from store.records import JobRow


@dataclass(frozen=True, slots=True)
class BacklogCount:
    """One look at the table. Jobs that were removed are not counted."""

    jobs: Mapping[tuple[str, JobStatus], int]  # (process, status) -> number
    oldest_waiting_s: float  # 0 if none waits


class Backlog:
    """Reads only."""

    def __init__(self, db: Database) -> None:
        self._db = db

    def count(self) -> BacklogCount:
        """All jobs by process and status, and for how long the job that waits longest has been waiting."""
        with self._db.reading() as session:
            grouped = session.execute(
                select(JobRow.process, JobRow.status, func.count()).group_by(JobRow.process, JobRow.status)
            ).all()
            oldest: datetime | None = session.execute(
                select(func.min(JobRow.queued_at, type_=Instant())).where(JobRow.status == JobStatus.ACCEPTED)
            ).scalar_one()
            waiting_s = (self._db.now(session) - oldest).total_seconds() if oldest is not None else 0.0
        return BacklogCount({(process, JobStatus(status)): count for process, status, count in grouped}, max(waiting_s, 0.0))
