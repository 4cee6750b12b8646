"""A job as everybody outside the tables sees it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from datetime import datetime
from enum import StrEnum
from typing import Any

from core.errors import IntegumentError
from core.schema.expectation import JobQueue
from store.workspace import WorkspaceId


class JobStatus(StrEnum):
    """The words of OGC API - Processes."""

    ACCEPTED = "accepted"  # waits for a worker
    RUNNING = "running"  # a worker holds its lease
    SUCCESSFUL = "successful"  # done; the verdict may still be not_ready
    FAILED = "failed"  # could not do what the process promises
    DISMISSED = "dismissed"  # the user took it back

    @property
    def is_finished(self) -> bool:
        """True if nothing happens any more unless somebody asks."""
        return self not in (JobStatus.ACCEPTED, JobStatus.RUNNING)


@dataclass(frozen=True, slots=True)
class MeshInput:
    """One mesh a job reads: the link in its inputs and the blob it was bound to.

    `source_sha256` is of the file the user sent, if the blob is our canonical form of it: what `sha256sum` tells him."""

    href: str
    name: str
    sha256: str
    media_type: str
    file_name: str
    source_sha256: str | None = None
    faces: int | None = field(default=None, compare=False)  # counted when the job is accepted, not kept


@dataclass(frozen=True, slots=True)
class JobOutput:
    """One file a job made."""

    sha256: str
    size: int
    media_type: str
    file_name: str


@dataclass(frozen=True, slots=True)
class JobFailure:
    """Why a job failed and whose fault it is: `input`, `limit`, `state` or `internal`."""

    code: str
    fault: str
    message: str
    retryable: bool
    facts: Mapping[str, Any] = field(default_factory=dict)
    findings: tuple[Mapping[str, Any], ...] = ()

    @classmethod
    def of(cls, error: IntegumentError) -> JobFailure:
        """The failure an error stands for."""
        told = error.describe()
        return cls(error.code, error.fault, error.message, error.retryable, told["facts"], tuple(told["findings"]))

    def describe(self) -> dict[str, Any]:
        """JSON for rows, events and clients; the fault is called `class` there."""
        return {
            "code": self.code,
            "class": self.fault,
            "message": self.message,
            "retryable": self.retryable,
            "facts": dict(self.facts),
            "findings": list(self.findings),
        }

    @classmethod
    def read(cls, told: Mapping[str, Any]) -> JobFailure:
        """The inverse of `describe`."""
        return cls(told["code"], told["class"], told["message"], told["retryable"], told["facts"], tuple(told["findings"]))


@dataclass(frozen=True, slots=True)
class Job:
    """A snapshot of one job. `attempt` counts from 1; `lease_token` is the fencing token of the latest claim.

    `expires_at`: when it is removed with its results, where that was asked for; None: never, or not before it has ended."""

    id: str
    workspace: WorkspaceId
    process: str
    inputs: Mapping[str, Any]
    mesh_inputs: Mapping[str, MeshInput]
    status: JobStatus
    phase: str
    progress: float
    message: str
    attempt: int
    max_attempts: int
    lease_owner: str | None
    lease_token: int
    lease_until: datetime | None
    dismiss_requested: bool
    created_at: datetime
    queued_at: datetime
    started_at: datetime | None
    finished_at: datetime | None
    updated_at: datetime
    rung_at: datetime | None
    failure: JobFailure | None
    verdict: str | None
    summary: str | None
    outputs: Mapping[str, JobOutput]
    timings_s: Mapping[str, float]
    peak_memory_bytes: int | None
    event_seq: int
    queue: JobQueue
    expected_memory_bytes: int
    expected_cpu_s: float | None
    traceparent: str | None = None  # of the request that accepted it
    expires_at: datetime | None = None
    name: str | None = None
    labels: tuple[str, ...] = ()
    cohort_id: str | None = None
    subject: str | None = None  # of that cohort
