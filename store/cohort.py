"""A cohort as everybody outside the tables sees it: one request for many subjects, each a job of its own."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from datetime import datetime
from typing import Any

from store.job import JobStatus
from store.workspace import WorkspaceId


@dataclass(frozen=True, slots=True)
class RefusedSubject:
    """A subject that has no job: its file could not be read."""

    subject: str
    code: str
    message: str

    def describe(self) -> dict[str, str]:
        """JSON for the row and the summary."""
        return {"subject": self.subject, "code": self.code, "message": self.message}


@dataclass(frozen=True, slots=True)
class Cohort:
    """A snapshot. `counts` are of the jobs that are there; `subjects` of all there ever were, refused ones included.

    `progress`: mean of all jobs in percent, those that ended as 100. `round` counts the times its jobs were queued.
    `finished_at`: when the last job of this round ended, and its summary was queued as job `summary_job_id`."""

    id: str
    workspace: WorkspaceId
    process: str
    name: str | None
    labels: tuple[str, ...]
    inputs: Mapping[str, Any]
    subjects: int
    refused: tuple[RefusedSubject, ...]
    round: int
    summary_job_id: str | None
    created_at: datetime
    finished_at: datetime | None
    counts: Mapping[JobStatus, int]
    ready: int
    progress: float

    @property
    def live(self) -> int:
        """Jobs that wait or run."""
        return sum(count for status, count in self.counts.items() if not status.is_finished)
