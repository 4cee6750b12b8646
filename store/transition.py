"""The moves a job can make, on a locked row inside a transaction; each leaves its event.

accepted ── claim ──> running ── finish ──> successful
   ^  ^                 │ │ └──── fail ───> failed ──────┐
   │  └── release/expire┘ └─ confirm ─> dismissed <─ dismiss (accepted)
   └───────────────── retry ─────────────────┴───────────┘
"""

from __future__ import annotations

from collections.abc import Mapping
from datetime import datetime

from sqlalchemy import bindparam, select
from sqlalchemy.orm import Session

from core.errors import StateError
from core.schema.expectation import JobQueue
from store.announcement import announce
from store.checkpoint import forget_checkpoints
from store.cohort_end import close_cohort
from store.job import Job, JobFailure, JobOutput, JobStatus, MeshInput
from store.job_tally import count_end
from store.outbox import tell_subscriber
from store.records import JobOutputRow, JobRow
from store.storable import storable, storable_text
from store.workspace import WorkspaceId


def owned(session: Session, workspace: WorkspaceId, job_id: str, *, lock: bool = False) -> JobRow:
    """The row, if it is that workspace's; with `lock` held against every other writer until the transaction ends.

    Raises StateError `job.not_found`."""
    query = select(JobRow).where(JobRow.id == job_id, JobRow.workspace == workspace)
    row = session.scalars(query.with_for_update() if lock else query).one_or_none()
    if row is None:
        raise no_such_job(job_id)
    return row


def no_such_job(job_id: str) -> StateError:
    """The same words for what is foreign and for what is not there."""
    return StateError("job.not_found", f"there is no job {job_id}", job=job_id)


def held(session: Session, job_id: str, token: int) -> JobRow | None:
    """The locked row if `token` is the one of its running attempt: whoever lost the lease gets None and may write nothing."""
    return session.scalars(_HELD, {"of": job_id, "token": token}).one_or_none()


_HELD = (
    select(JobRow)
    .where(JobRow.id == bindparam("of"), JobRow.lease_token == bindparam("token"), JobRow.status == JobStatus.RUNNING)
    .with_for_update()
)  # made once: see `store.admission`


def queue_again(session: Session, row: JobRow, attempt: int, message: str, now: datetime) -> None:
    """Back to accepted, and due to ring at once; a retry forgets the earlier result.

    It keeps its place in the queue: whoever lost a worker has waited already."""
    row.status, row.attempt, row.phase, row.progress, row.message = JobStatus.ACCEPTED, attempt, "", 0.0, message
    row.lease_owner = row.lease_until = row.rung_at = row.finished_at = row.started_at = None
    row.failure = row.verdict = row.summary = row.peak_memory_bytes = None
    row.timings_s = {}
    drop_outputs(row)
    announce(session, row, now)


def end(session: Session, row: JobRow, status: JobStatus, message: str, now: datetime) -> None:
    """Give up the lease for good."""
    row.status, row.message, row.finished_at = status, storable_text(message), now
    row.lease_owner = row.lease_until = None
    row.dismiss_requested = False
    if status is not JobStatus.FAILED:  # that may be retried
        forget_checkpoints(session, row, of_all=status is JobStatus.SUCCESSFUL)
    announce(session, row, now)
    tell_subscriber(session, row, now)
    count_end(session, row, now)
    if row.cohort_id is not None:
        close_cohort(session, row.cohort_id, now)


def end_failed(session: Session, row: JobRow, failure: JobFailure, now: datetime) -> None:
    """Failed, with the reason."""
    row.failure = storable(failure.describe())
    end(session, row, JobStatus.FAILED, failure.message, now)


def end_dismissed(session: Session, row: JobRow, now: datetime) -> None:
    """Dismissed: once that was asked for, no job turns out successful."""
    drop_outputs(row)
    end(session, row, JobStatus.DISMISSED, "dismissed on request", now)


def keep_outputs(row: JobRow, outputs: Mapping[str, JobOutput]) -> None:
    """Link the files the job made; their order is kept."""
    row.output_bytes += sum(output.size for output in outputs.values())
    row.outputs.extend(
        JobOutputRow(
            name=name,
            position=position,
            sha256=output.sha256,
            size=output.size,
            media_type=output.media_type,
            file_name=storable_text(output.file_name),
        )
        for position, (name, output) in enumerate(outputs.items())
    )


def drop_outputs(row: JobRow) -> None:
    """Unlink them; the bytes go with the next sweep."""
    row.outputs.clear()
    row.output_bytes = 0


def snapshot(row: JobRow) -> Job:
    """The row as a frozen value."""
    return Job(
        id=row.id,
        workspace=WorkspaceId(row.workspace),
        process=row.process,
        inputs=row.inputs,
        mesh_inputs={
            mesh.href: MeshInput(mesh.href, mesh.name, mesh.sha256, mesh.media_type, mesh.file_name, mesh.source_sha256)
            for mesh in row.mesh_inputs
        },
        status=JobStatus(row.status),
        phase=row.phase,
        progress=float(row.progress),  # RETURNING of SQLite gives whole numbers as int
        message=row.message,
        attempt=row.attempt,
        max_attempts=row.max_attempts,
        lease_owner=row.lease_owner,
        lease_token=row.lease_token,
        lease_until=row.lease_until,
        dismiss_requested=row.dismiss_requested,
        created_at=row.created_at,
        queued_at=row.queued_at,
        started_at=row.started_at,
        finished_at=row.finished_at,
        updated_at=row.updated_at,
        rung_at=row.rung_at,
        failure=JobFailure.read(row.failure) if row.failure else None,
        verdict=row.verdict,
        summary=row.summary,
        outputs={
            output.name: JobOutput(output.sha256, output.size, output.media_type, output.file_name) for output in row.outputs
        },
        timings_s=row.timings_s,
        peak_memory_bytes=row.peak_memory_bytes,
        event_seq=row.event_seq,
        queue=JobQueue(row.queue),
        expected_memory_bytes=row.expected_memory_bytes,
        expected_cpu_s=row.expected_cpu_s,
        traceparent=row.traceparent,
        name=row.name,
        labels=tuple(row.labels or ()),
        cohort_id=row.cohort_id,
        subject=row.subject,
    )
