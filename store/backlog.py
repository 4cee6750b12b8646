"""How much there is to do: numbers for dashboards, alarms and autoscalers, counted in the job table itself.

Only jobs that wait or run are looked at, so that the cost does not grow with all that ever ran."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from sqlalchemy import func, select

from core.schema.expectation import JobQueue
from store.database import Database
from store.instant import Instant
from store.job import JobStatus
from store.records import JobRow, UploadRow

LIVE = (JobStatus.ACCEPTED, JobStatus.RUNNING)


@dataclass(frozen=True, slots=True)
class BacklogCount:
    """One look at the tables. uploads: those in pieces that are under way."""

    jobs: Mapping[tuple[str, JobQueue, JobStatus], int]  # (process, queue, status) -> number, without zeros
    oldest_waiting_s: Mapping[JobQueue, float]  # 0 if none waits
    uploads: int

    def total(self, status: JobStatus) -> int:
        """Of all processes and queues."""
        return sum(number for (_, _, one), number in self.jobs.items() if one is status)


class Backlog:
    """Reads only."""

    def __init__(self, db: Database) -> None:
        self._db = db

    def count(self) -> BacklogCount:
        """Waiting and running jobs, and for how long the job that waits longest in each queue has been waiting."""
        with self._db.reading() as session:
            grouped = session.execute(
                select(JobRow.process, JobRow.queue, JobRow.status, func.count())
                .where(JobRow.status.in_(LIVE))
                .group_by(JobRow.process, JobRow.queue, JobRow.status)
            ).all()
            uploads = session.execute(select(func.count()).where(UploadRow.mesh_id.is_(None))).scalar_one()
        jobs = {(process, JobQueue(queue), JobStatus(status)): count for process, queue, status, count in grouped}
        return BacklogCount(jobs, {**dict.fromkeys(JobQueue, 0.0), **self.oldest_waiting_s()}, uploads)

    def oldest_waiting_s(self) -> Mapping[JobQueue, float]:
        """The same waits alone, without the queues in which nothing waits."""
        with self._db.reading() as session:
            oldest = session.execute(
                select(JobRow.queue, func.min(JobRow.queued_at, type_=Instant()))
                .where(JobRow.status == JobStatus.ACCEPTED)
                .group_by(JobRow.queue)
            ).all()
            now = self._db.now(session)
        return {JobQueue(queue): max((now - since).total_seconds(), 0.0) for queue, since in oldest}
