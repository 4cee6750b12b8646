"""The tables. Rows stay inside `store`; everybody else sees frozen dataclasses."""

from __future__ import annotations

from datetime import datetime
from typing import Any

from sqlalchemy import BigInteger, CheckConstraint, ForeignKey, Index, String, Text, text
from sqlalchemy.orm import Mapped, mapped_column, relationship

from core.schema.expectation import UNKNOWN
from store.instant import Instant
from store.job_words import SEARCH_CHARACTERS
from store.record import Json, Record

Identifier = String(36)
Digest = String(64)
WorkspaceName = String(63)


class WorkspaceRow(Record):
    """Whose meshes and jobs are; the row is locked while its quota is compared and used."""

    __tablename__ = "workspaces"

    id: Mapped[str] = mapped_column(WorkspaceName, primary_key=True)
    created_at: Mapped[datetime] = mapped_column(Instant)
    quota_bytes: Mapped[int | None] = mapped_column(BigInteger)  # None: as the settings say; 0: no limit
    quota_jobs: Mapped[int | None]
    keep_jobs_days: Mapped[float | None]  # None: as the settings say; 0: for ever
    keep_meshes_days: Mapped[float | None]
    keep_events_days: Mapped[float | None]


class MeshRow(Record):
    """An uploaded mesh: the bytes as they came, and our canonical form of them."""

    __tablename__ = "meshes"
    __table_args__ = (Index(None, "workspace", "created_at", "id"), Index(None, "workspace", "size_bytes"))

    id: Mapped[str] = mapped_column(Identifier, primary_key=True)
    workspace: Mapped[str] = mapped_column(WorkspaceName, ForeignKey(WorkspaceRow.id))
    name: Mapped[str] = mapped_column(Text)
    file_name: Mapped[str] = mapped_column(Text)
    unit: Mapped[str] = mapped_column(String(8))
    format: Mapped[str] = mapped_column(String(32))
    size_bytes: Mapped[int] = mapped_column(BigInteger)
    sha256: Mapped[str] = mapped_column(Digest)
    canonical_sha256: Mapped[str] = mapped_column(Digest)
    vertices: Mapped[int] = mapped_column(BigInteger)
    faces: Mapped[int] = mapped_column(BigInteger)
    extents_mm: Mapped[list[float]] = mapped_column(Json)
    findings: Mapped[list[dict[str, Any]]] = mapped_column(Json)
    created_at: Mapped[datetime] = mapped_column(Instant)
    arrays: Mapped[list[dict[str, Any]] | None] = mapped_column(Json)  # numbers on vertices; null: taken in before they were kept
    volume: Mapped[dict[str, Any] | None] = mapped_column(Json)  # voxels and labels of a label volume; null: a mesh
    field: Mapped[dict[str, Any] | None] = mapped_column(Json)  # rows, nodes and data of a field; null: something else
    coil: Mapped[dict[str, Any] | None] = mapped_column(Json)  # dipoles of a coil; null: something else


class JobRow(Record):
    """One job: the truth about it."""

    __tablename__ = "jobs"
    __table_args__ = (
        CheckConstraint("status IN ('accepted', 'running', 'successful', 'failed', 'dismissed')", name="status_known"),
        CheckConstraint("(status = 'running') = (lease_until IS NOT NULL)", name="running_has_lease"),
        Index(None, "workspace", "created_at", "id", "search_text"),  # a search reads the index alone
        Index(None, "workspace", "status", "queue", "queued_at", "id"),
        Index(None, "workspace", "output_bytes"),
        Index(None, "workspace", "fingerprint"),
        Index(None, "status", "queued_at", "id"),
        Index(None, "workspace", "finished_at"),
        Index(None, "cohort_id", "created_at", "id"),
    )

    id: Mapped[str] = mapped_column(Identifier, primary_key=True)
    workspace: Mapped[str] = mapped_column(WorkspaceName, ForeignKey(WorkspaceRow.id))
    process: Mapped[str] = mapped_column(String(64))
    inputs: Mapped[dict[str, Any]] = mapped_column(Json)
    status: Mapped[str] = mapped_column(String(16))
    phase: Mapped[str] = mapped_column(Text)
    progress: Mapped[float]
    message: Mapped[str] = mapped_column(Text)
    attempt: Mapped[int]
    max_attempts: Mapped[int]
    lease_owner: Mapped[str | None] = mapped_column(Text)
    lease_token: Mapped[int]
    lease_until: Mapped[datetime | None] = mapped_column(Instant)
    dismiss_requested: Mapped[bool]
    created_at: Mapped[datetime] = mapped_column(Instant)
    queued_at: Mapped[datetime] = mapped_column(Instant)
    started_at: Mapped[datetime | None] = mapped_column(Instant)
    finished_at: Mapped[datetime | None] = mapped_column(Instant)
    updated_at: Mapped[datetime] = mapped_column(Instant)
    rung_at: Mapped[datetime | None] = mapped_column(Instant)
    failure: Mapped[dict[str, Any] | None] = mapped_column(Json)
    verdict: Mapped[str | None] = mapped_column(String(32))
    summary: Mapped[str | None] = mapped_column(Text)
    timings_s: Mapped[dict[str, float]] = mapped_column(Json)
    peak_memory_bytes: Mapped[int | None] = mapped_column(BigInteger)
    event_seq: Mapped[int]
    output_bytes: Mapped[int] = mapped_column(BigInteger)  # of all outputs, for the quota: an index holds the sum
    subscriber: Mapped[dict[str, Any] | None] = mapped_column(Json)  # whom to call back, None: nobody
    # the database's own defaults stand for what an API of the version before does not say
    queue: Mapped[str] = mapped_column(String(8), server_default=UNKNOWN.queue.value)
    expected_memory_bytes: Mapped[int] = mapped_column(BigInteger, server_default=text(str(UNKNOWN.memory_bytes)))
    expected_cpu_s: Mapped[float | None]
    events_trimmed_at: Mapped[datetime | None] = mapped_column(Instant)  # when progress and log lines were removed
    traceparent: Mapped[str | None] = mapped_column(String(64))  # W3C: the trace of the request that accepted it
    fingerprint: Mapped[str | None] = mapped_column(Digest)  # of what is asked for, by content; None: accepted by an older server
    name: Mapped[str | None] = mapped_column(Text)
    labels: Mapped[list[str] | None] = mapped_column(Json)  # to be shown; a list by label looks into `job_labels`
    cohort_id: Mapped[str | None] = mapped_column(Identifier)  # no foreign key: SQLite could not drop the column again
    subject: Mapped[str | None] = mapped_column(Text)
    search_text: Mapped[str] = mapped_column(String(SEARCH_CHARACTERS), server_default=text("''"))

    mesh_inputs: Mapped[list[JobInputRow]] = relationship(
        cascade="all, delete-orphan", passive_deletes=True, lazy="selectin", order_by="JobInputRow.href"
    )
    outputs: Mapped[list[JobOutputRow]] = relationship(
        cascade="all, delete-orphan", passive_deletes=True, lazy="selectin", order_by="JobOutputRow.position"
    )


class CohortRow(Record):
    """One request for many subjects. The jobs are rows of their own; this one says what they have in common."""

    __tablename__ = "cohorts"
    __table_args__ = (Index(None, "workspace", "created_at", "id"), Index(None, "finished_at"))

    id: Mapped[str] = mapped_column(Identifier, primary_key=True)
    workspace: Mapped[str] = mapped_column(WorkspaceName, ForeignKey(WorkspaceRow.id))
    process: Mapped[str] = mapped_column(String(64))
    name: Mapped[str | None] = mapped_column(Text)
    labels: Mapped[list[str] | None] = mapped_column(Json)
    inputs: Mapped[dict[str, Any]] = mapped_column(Json)  # what all subjects share
    subjects: Mapped[int]
    refused: Mapped[list[dict[str, str]]] = mapped_column(Json)  # subjects without a job, and why
    subscriber: Mapped[dict[str, Any] | None] = mapped_column(Json)  # of the summary
    round: Mapped[int]
    summary_job_id: Mapped[str | None] = mapped_column(Identifier)
    created_at: Mapped[datetime] = mapped_column(Instant)
    finished_at: Mapped[datetime | None] = mapped_column(Instant)  # the fence: set in the transaction that queues the summary


class JobLabelRow(Record):
    """A label of a job, with what a page of the jobs that have it is ordered by."""

    __tablename__ = "job_labels"
    __table_args__ = (Index(None, "workspace", "label", "created_at", "job_id"),)

    job_id: Mapped[str] = mapped_column(Identifier, ForeignKey("jobs.id", ondelete="CASCADE"), primary_key=True)
    label: Mapped[str] = mapped_column(String(64), primary_key=True)
    workspace: Mapped[str] = mapped_column(WorkspaceName)
    created_at: Mapped[datetime] = mapped_column(Instant)


class TurnRow(Record):
    """When a workspace was last given a worker; rows of its own, so that no claim waits for a request that counts a quota."""

    __tablename__ = "turns"

    workspace: Mapped[str] = mapped_column(WorkspaceName, ForeignKey(WorkspaceRow.id), primary_key=True)
    served_at: Mapped[datetime] = mapped_column(Instant)


class JobInputRow(Record):
    """A mesh a job reads, bound to its bytes when the job was accepted."""

    __tablename__ = "job_inputs"
    __table_args__ = (Index(None, "sha256"),)

    job_id: Mapped[str] = mapped_column(Identifier, ForeignKey("jobs.id", ondelete="CASCADE"), primary_key=True)
    href: Mapped[str] = mapped_column(String(500), primary_key=True)
    name: Mapped[str] = mapped_column(Text)
    sha256: Mapped[str] = mapped_column(Digest)
    media_type: Mapped[str] = mapped_column(String(100))
    file_name: Mapped[str] = mapped_column(Text)
    source_sha256: Mapped[str | None] = mapped_column(Digest)  # tells where it came from; that file may be gone


class JobOutputRow(Record):
    """A file a job made."""

    __tablename__ = "job_outputs"

    job_id: Mapped[str] = mapped_column(Identifier, ForeignKey("jobs.id", ondelete="CASCADE"), primary_key=True)
    name: Mapped[str] = mapped_column(String(64), primary_key=True)
    position: Mapped[int]
    sha256: Mapped[str] = mapped_column(Digest)
    size: Mapped[int] = mapped_column(BigInteger)
    media_type: Mapped[str] = mapped_column(String(100))
    file_name: Mapped[str] = mapped_column(Text)


class JobCheckpointRow(Record):
    """The output of a finished step of a job that has not succeeded yet."""

    __tablename__ = "job_checkpoints"

    job_id: Mapped[str] = mapped_column(Identifier, ForeignKey("jobs.id", ondelete="CASCADE"), primary_key=True)
    key: Mapped[str] = mapped_column(Digest, primary_key=True)
    stage: Mapped[str] = mapped_column(Text)
    sha256: Mapped[str] = mapped_column(Digest)
    size: Mapped[int] = mapped_column(BigInteger)
    created_at: Mapped[datetime] = mapped_column(Instant)


class JobAttemptRow(Record):
    """An attempt that took its worker or its child down."""

    __tablename__ = "job_attempts"

    job_id: Mapped[str] = mapped_column(Identifier, ForeignKey("jobs.id", ondelete="CASCADE"), primary_key=True)
    attempt: Mapped[int] = mapped_column(primary_key=True, autoincrement=False)
    worker: Mapped[str] = mapped_column(Text)
    code: Mapped[str] = mapped_column(String(64))
    message: Mapped[str] = mapped_column(Text)
    signal: Mapped[str | None] = mapped_column(String(32))
    phase: Mapped[str] = mapped_column(Text)
    progress: Mapped[float]
    peak_memory_bytes: Mapped[int | None] = mapped_column(BigInteger)
    log: Mapped[str] = mapped_column(Text)
    started_at: Mapped[datetime | None] = mapped_column(Instant)
    ended_at: Mapped[datetime] = mapped_column(Instant)


class ParkedRow(Record):
    """A request that is refused because it took its workers down. Refers to no job: it stays when that is removed."""

    __tablename__ = "parked"

    workspace: Mapped[str] = mapped_column(WorkspaceName, ForeignKey(WorkspaceRow.id), primary_key=True)
    fingerprint: Mapped[str] = mapped_column(Digest, primary_key=True)
    process: Mapped[str] = mapped_column(String(64))
    job_id: Mapped[str] = mapped_column(Identifier, index=True)
    code: Mapped[str] = mapped_column(String(64))
    evidence: Mapped[list[dict[str, Any]]] = mapped_column(Json)
    parked_at: Mapped[datetime] = mapped_column(Instant)


class EventRow(Record):
    """What a client sees of a job while it runs; `seq` counts 1, 2, 3, … within the job."""

    __tablename__ = "job_events"

    job_id: Mapped[str] = mapped_column(Identifier, ForeignKey("jobs.id", ondelete="CASCADE"), primary_key=True)
    seq: Mapped[int] = mapped_column(primary_key=True, autoincrement=False)
    type: Mapped[str] = mapped_column(String(16))
    data: Mapped[dict[str, Any]] = mapped_column(Json)
    at: Mapped[datetime] = mapped_column(Instant)


class IdempotencyRow(Record):
    """A request that must not be done twice, and its reply once there is one."""

    __tablename__ = "idempotency_keys"

    workspace: Mapped[str] = mapped_column(WorkspaceName, ForeignKey(WorkspaceRow.id), primary_key=True)
    key: Mapped[str] = mapped_column(String(255), primary_key=True)
    fingerprint: Mapped[str] = mapped_column(Digest)
    reply: Mapped[dict[str, Any] | None] = mapped_column(Json)
    created_at: Mapped[datetime] = mapped_column(Instant, index=True)


class ApiKeyRow(Record):
    """A key and what it allows; of its text only the SHA-256."""

    __tablename__ = "api_keys"

    id: Mapped[str] = mapped_column(String(16), primary_key=True)
    workspace: Mapped[str] = mapped_column(WorkspaceName, ForeignKey(WorkspaceRow.id))
    name: Mapped[str] = mapped_column(Text)
    scopes: Mapped[list[str]] = mapped_column(Json)
    digest: Mapped[str] = mapped_column(Digest)
    created_at: Mapped[datetime] = mapped_column(Instant)
    expires_at: Mapped[datetime | None] = mapped_column(Instant)
    last_used_at: Mapped[datetime | None] = mapped_column(Instant)
    revoked_at: Mapped[datetime | None] = mapped_column(Instant)
    replaced_by: Mapped[str | None] = mapped_column(String(16))


class AuditRow(Record):
    """Who did what, when, and how it ended. Refers to nothing: it outlives what it tells of."""

    __tablename__ = "audit"
    __table_args__ = (Index(None, "at"), Index(None, "workspace", "at"))

    id: Mapped[str] = mapped_column(Identifier, primary_key=True)
    at: Mapped[datetime] = mapped_column(Instant)
    actor: Mapped[str] = mapped_column(Text)
    key_id: Mapped[str | None] = mapped_column(String(16))
    workspace: Mapped[str | None] = mapped_column(WorkspaceName)
    action: Mapped[str] = mapped_column(String(64))
    subject: Mapped[str] = mapped_column(Text)
    outcome: Mapped[str] = mapped_column(String(100))
    request_id: Mapped[str | None] = mapped_column(String(64))


class UploadRow(Record):
    """A file that comes in pieces."""

    __tablename__ = "uploads"
    __table_args__ = (Index(None, "workspace"), Index(None, "expires_at"))

    id: Mapped[str] = mapped_column(Identifier, primary_key=True)
    workspace: Mapped[str] = mapped_column(WorkspaceName, ForeignKey(WorkspaceRow.id))
    file_name: Mapped[str] = mapped_column(Text)
    fields: Mapped[dict[str, str]] = mapped_column(Json)
    length: Mapped[int] = mapped_column(BigInteger)
    received: Mapped[int] = mapped_column(BigInteger)
    mesh_id: Mapped[str | None] = mapped_column(Identifier)
    created_at: Mapped[datetime] = mapped_column(Instant)
    expires_at: Mapped[datetime] = mapped_column(Instant)


class UploadPartRow(Record):
    """A stretch of an upload that is a blob of its own: where API hosts share no disk."""

    __tablename__ = "upload_parts"

    upload_id: Mapped[str] = mapped_column(Identifier, ForeignKey(UploadRow.id, ondelete="CASCADE"), primary_key=True)
    start: Mapped[int] = mapped_column(BigInteger, primary_key=True, autoincrement=False)
    size: Mapped[int] = mapped_column(BigInteger)
    sha256: Mapped[str] = mapped_column(Digest)


class CallbackRow(Record):
    """What a subscriber is to be told: written with the state change it tells of, sent by a worker."""

    __tablename__ = "callbacks"
    __table_args__ = (Index(None, "job_id"), Index(None, "state", "due_at"))

    id: Mapped[str] = mapped_column(Identifier, primary_key=True)
    workspace: Mapped[str] = mapped_column(WorkspaceName, ForeignKey(WorkspaceRow.id))
    job_id: Mapped[str] = mapped_column(Identifier, ForeignKey(JobRow.id, ondelete="CASCADE"))
    event: Mapped[str] = mapped_column(String(16))
    uri: Mapped[str] = mapped_column(Text)
    body: Mapped[str] = mapped_column(Text)  # the very characters that are signed and sent, in every attempt
    state: Mapped[str] = mapped_column(String(16))
    attempts: Mapped[int]
    lease_token: Mapped[int]
    lease_until: Mapped[datetime | None] = mapped_column(Instant)
    created_at: Mapped[datetime] = mapped_column(Instant)
    due_at: Mapped[datetime] = mapped_column(Instant)
    ended_at: Mapped[datetime | None] = mapped_column(Instant)
    last_status: Mapped[int | None]
    last_error: Mapped[str | None] = mapped_column(Text)
