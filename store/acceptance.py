"""A job comes into the table: its row, its labels and its first event."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from datetime import datetime
from typing import Any
from uuid import uuid4

from sqlalchemy import insert
from sqlalchemy.orm import Session

from core.schema.expectation import UNKNOWN, Expectation
from store.announcement import status_data
from store.callback import Subscriber
from store.fingerprint import fingerprint_of
from store.job import Job, JobStatus, MeshInput
from store.job_words import NO_WORDS, JobWords, search_text
from store.record import Record
from store.telemetry import current_traceparent
from store.workspace import WorkspaceId


@dataclass(frozen=True, slots=True)
class Membership:
    """Which subject of which cohort a job works on."""

    cohort_id: str
    subject: str


@dataclass(frozen=True, slots=True)
class NewJob:
    """What is asked for. `fingerprint` says it by content."""

    process: str
    inputs: Mapping[str, Any]
    mesh_inputs: tuple[MeshInput, ...] = ()
    expectation: Expectation = UNKNOWN
    words: JobWords = NO_WORDS
    subscriber: Subscriber | None = None
    membership: Membership | None = None

    @property
    def fingerprint(self) -> str:
        """The same for the same process, inputs and bytes."""
        return fingerprint_of(self.process, self.inputs, self.meshes.values())

    @property
    def meshes(self) -> dict[str, MeshInput]:
        """By link: the last of equal ones."""
        return {mesh.href: mesh for mesh in self.mesh_inputs}


def accept_job(session: Session, workspace: WorkspaceId, new: NewJob, max_attempts: int, now: datetime) -> Job:
    """Once `session` commits the job survives everything. Quotas are compared before.

    The rows are written as they are: objects that know when they change, which nobody needs of a new job, take five times as
    long as the rest of the request."""
    job, meshes = _job(workspace, new, max_attempts, now), new.meshes
    session.flush()  # what was added before is there before
    connection = session.connection()
    connection.execute(_JOB, _row(job, new))
    if meshes:
        connection.execute(_INPUTS, [{"job_id": job.id, **_input(mesh)} for mesh in meshes.values()])
    if job.labels:
        labels = [{"job_id": job.id, "label": label, "workspace": workspace, "created_at": now} for label in job.labels]
        connection.execute(_LABELS, labels)
    event = {"job_id": job.id, "seq": job.event_seq, "type": "status", "data": status_data(job), "at": now}
    connection.execute(_EVENT, event)
    return job


def _job(workspace: WorkspaceId, new: NewJob, max_attempts: int, now: datetime) -> Job:
    return Job(
        id=str(uuid4()),
        workspace=workspace,
        process=new.process,
        inputs=dict(new.inputs),
        mesh_inputs=new.meshes,
        status=JobStatus.ACCEPTED,
        phase="",
        progress=0.0,
        message="waits for a worker",
        attempt=1,
        max_attempts=max_attempts,
        lease_owner=None,
        lease_token=0,
        lease_until=None,
        dismiss_requested=False,
        created_at=now,
        queued_at=now,
        started_at=None,
        finished_at=None,
        updated_at=now,
        rung_at=None,
        failure=None,
        verdict=None,
        summary=None,
        outputs={},
        timings_s={},
        peak_memory_bytes=None,
        event_seq=1,
        queue=new.expectation.queue,
        expected_memory_bytes=new.expectation.memory_bytes,
        expected_cpu_s=new.expectation.cpu_s,
        traceparent=current_traceparent(),
        name=new.words.name,
        labels=tuple(new.words.labels),
        cohort_id=None if new.membership is None else new.membership.cohort_id,
        subject=None if new.membership is None else new.membership.subject,
    )


def _row(job: Job, new: NewJob) -> dict[str, Any]:
    """Of the table of jobs: what a job of this kind has there; the rest is null."""
    row = {name: getattr(job, name) for name in _SAME}
    return row | {
        "labels": list(job.labels) or None,
        "fingerprint": new.fingerprint,
        "output_bytes": 0,
        "subscriber": None if new.subscriber is None else new.subscriber.describe(),
        "search_text": search_text(job.id, job.process, new.words, (mesh.name for mesh in job.mesh_inputs.values())),
    }


def _input(mesh: MeshInput) -> dict[str, Any]:
    return {name: getattr(mesh, name) for name in ("href", "name", "sha256", "media_type", "file_name", "source_sha256")}


_TABLES = Record.metadata.tables
_JOB, _INPUTS, _LABELS, _EVENT = (insert(_TABLES[name]) for name in ("jobs", "job_inputs", "job_labels", "job_events"))
_COLUMNS = (column.name for column in _TABLES["jobs"].columns)
_SAME = tuple(name for name in _COLUMNS if name in Job.__dataclass_fields__ and name != "labels")
