"""How much there is to do: numbers for dashboards, alarms and autoscalers, counted in the job table itself.

Only jobs that wait or run are looked at, so that the cost does not grow with all that ever ran."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from datetime import datetime

from sqlalchemy import func, select

from store.database import Database
from store.instant import Instant
from store.job import JobStatus
from store.records import JobRow, UploadRow

LIVE = (JobStatus.ACCEPTED, JobStatus.RUNNING)


@dataclass(frozen=True, slots=True)
class BacklogCount:
    """One look at the tables. uploads: those in pieces that are under way."""

    jobs: Mapping[tuple[str, JobStatus], int]  # (process, status) -> number, without zeros
    oldest_waiting_s: float  # 0 if none waits
    uploads: int

    def total(self, status: JobStatus) -> int:
        """Of all processes."""
        return sum(number for (_, one), number in self.jobs.items() if one is status)


class Backlog:
    """Reads only."""

    def __init__(self, db: Database) -> None:
        self._db = db

    def count(self) -> BacklogCount:
        """Waiting and running jobs by process, and for how long the job that waits longest has been waiting."""
        with self._db.reading() as session:
            grouped = session.execute(
                select(JobRow.process, JobRow.status, func.count())
                .where(JobRow.status.in_(LIVE))
                .group_by(JobRow.process, JobRow.status)
            ).all()
            oldest: datetime | None = session.execute(
                select(func.min(JobRow.queued_at, type_=Instant())).where(JobRow.status == JobStatus.ACCEPTED)
            ).scalar_one()
            uploads = session.execute(select(func.count()).where(UploadRow.mesh_id.is_(None))).scalar_one()
            waiting_s = (self._db.now(session) - oldest).total_seconds() if oldest is not None else 0.0
        jobs = {(process, JobStatus(status)): count for process, status, count in grouped}
        return BacklogCount(jobs, max(waiting_s, 0.0), uploads)
