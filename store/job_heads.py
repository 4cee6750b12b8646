"""How far jobs are, in as few columns as it takes: what one look for all event streams and long polls reads."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass

from sqlalchemy import select

from store.database import Database
from store.job import JobStatus
from store.records import JobRow


@dataclass(frozen=True, slots=True)
class JobHead:
    """Number of the last event of a job, and whether it was its end."""

    seq: int
    finished: bool


class JobHeads:
    """Reads only; knows no workspaces, so ids must come from whoever has looked."""

    def __init__(self, db: Database) -> None:
        self._db = db

    def of(self, job_ids: Collection[str]) -> Mapping[str, JobHead]:
        """Those that are there, by one query."""
        query = select(JobRow.id, JobRow.event_seq, JobRow.status).where(JobRow.id.in_(job_ids))
        with self._db.reading() as session:
            return {job_id: JobHead(seq, JobStatus(status).is_finished) for job_id, seq, status in session.execute(query)}
