"""Jobs that are asked for again and again: one that has not changed since is not read a second time."""

from __future__ import annotations

import threading
from dataclasses import dataclass

from store.database import Database
from store.glance import Glance, Row
from store.job import Job
from store.jobs import Jobs
from store.records import JobRow
from store.workspace import WorkspaceId

HELD_JOBS = 500
LARGEST_INPUTS = 16 * 1024  # characters of JSON; jobs with more are read each time

# whatever of a job can change, and what its workspace says about how long it is kept; outputs change with `output_bytes` or
# `status` alone, and `inputs`, which may be long, never do
_CHANGING = ", ".join(
    f"jobs.{column.name}" for column in JobRow.__table__.columns if column.name not in ("inputs", "search_text")
)
_ROW = (
    f"SELECT length(jobs.inputs), {_CHANGING}, workspaces.* FROM jobs JOIN workspaces ON workspaces.id = jobs.workspace "  # noqa: S608
    "WHERE jobs.id = ? AND jobs.workspace = ?"
)


@dataclass(frozen=True, slots=True)
class _Held:
    row: Row
    job: Job


class RecentJobs:
    """Thread-safe. On SQLite a job that has not changed costs one look at its row; elsewhere all are read as ever."""

    def __init__(self, db: Database, jobs: Jobs) -> None:
        self._jobs = jobs
        self._glance = Glance(db)
        self._lock = threading.Lock()
        self._held: dict[tuple[str, str], _Held] = {}

    def close(self) -> None:
        """Close what glances."""
        self._glance.close()

    def get_at_once(self, workspace: WorkspaceId, job_id: str) -> Job | None:
        """The job as it is now, without waiting for anything; None if that takes longer, or there is no such job."""
        held = self._held.get((workspace, job_id))
        if held is None or held.row != self._glance.row(_ROW, (job_id, workspace)):
            return None
        return held.job

    def get(self, workspace: WorkspaceId, job_id: str) -> Job:
        """The same, for a thread that may wait. Raises StateError `job.not_found`."""
        before = self._glance.row(_ROW, (job_id, workspace))
        job = self._jobs.get(workspace, job_id)
        if before and before[0] <= LARGEST_INPUTS:  # what was read is as new as this row, or newer: then the rows will differ
            self._hold((workspace, job_id), _Held(before, job))
        return job

    def _hold(self, place: tuple[str, str], held: _Held) -> None:
        with self._lock:
            self._held.pop(place, None)
            if len(self._held) >= HELD_JOBS:
                del self._held[next(iter(self._held))]
            self._held[place] = held
