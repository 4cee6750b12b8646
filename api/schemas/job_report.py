"""The report of a job as it is served: that of its result, and what belongs to this run alone."""

from __future__ import annotations

from datetime import datetime

from pydantic import Field

from api.schemas.document import Document
from api.schemas.job import Failure, JobStatus
from core.schema.report import Report


class ReportedJob(Document):
    """Whose report it is. Two runs of the same request differ here, and nowhere else."""

    id: str
    href: str
    process: str
    status: JobStatus
    attempt: int
    created: datetime
    started: datetime | None = None
    finished: datetime | None = None
    peak_memory_bytes: int | None
    failure: Failure | None


class JobReport(Report):
    """The report of a result, the job that made it, and how long its phases took."""

    job: ReportedJob
    timings_s: dict[str, float] = Field(description="Seconds per phase")
