"""A job comes into the table: its row, its labels and its first event."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from datetime import datetime
from typing import Any
from uuid import uuid4

from sqlalchemy.orm import Session

from core.schema.expectation import UNKNOWN, Expectation
from store.announcement import announce
from store.callback import Subscriber
from store.fingerprint import fingerprint_of
from store.job import JobStatus, MeshInput
from store.job_words import NO_WORDS, JobWords
from store.labelling import index_labels, label_job
from store.records import JobInputRow, JobRow
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
        return fingerprint_of(self.process, self.inputs, self._meshes())

    def input_rows(self) -> list[JobInputRow]:
        """One per link, the last of equal ones."""
        return [
            JobInputRow(
                href=mesh.href,
                name=mesh.name,
                sha256=mesh.sha256,
                media_type=mesh.media_type,
                file_name=mesh.file_name,
                source_sha256=mesh.source_sha256,
            )
            for mesh in self._meshes()
        ]

    def _meshes(self) -> Iterable[MeshInput]:
        return {mesh.href: mesh for mesh in self.mesh_inputs}.values()


def accept_job(session: Session, workspace: WorkspaceId, new: NewJob, max_attempts: int, now: datetime) -> JobRow:
    """Once `session` commits the job survives everything. Quotas are compared before."""
    row = JobRow(
        id=str(uuid4()),
        workspace=workspace,
        process=new.process,
        inputs=dict(new.inputs),
        fingerprint=new.fingerprint,
        status=JobStatus.ACCEPTED,
        phase="",
        progress=0.0,
        message="waits for a worker",
        attempt=1,
        max_attempts=max_attempts,
        lease_token=0,
        dismiss_requested=False,
        created_at=now,
        queued_at=now,
        updated_at=now,
        timings_s={},
        event_seq=0,
        output_bytes=0,
        outputs=[],  # said, or they are looked for
        subscriber=None if new.subscriber is None else new.subscriber.describe(),
        traceparent=current_traceparent(),
        queue=new.expectation.queue,
        expected_memory_bytes=new.expectation.memory_bytes,
        expected_cpu_s=new.expectation.cpu_s,
        cohort_id=None if new.membership is None else new.membership.cohort_id,
        subject=None if new.membership is None else new.membership.subject,
        mesh_inputs=new.input_rows(),
    )
    label_job(row, new.words)
    session.add(row)
    session.flush()  # the job before its event and labels, which refer to it
    index_labels(session, row)
    announce(session, row, now)
    session.flush()
    return row
