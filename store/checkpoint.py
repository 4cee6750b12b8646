"""The output of one step of a job, kept as a blob until the job has succeeded."""

from __future__ import annotations

from dataclasses import dataclass

from sqlalchemy import ColumnElement, delete, or_, select
from sqlalchemy.orm import Session

from store.records import JobCheckpointRow, JobRow


@dataclass(frozen=True, slots=True)
class Checkpoint:
    """key: SHA-256 of all that decides about the bytes, see `core.processes.checkpoints.key`; the bytes themselves are a blob."""

    key: str
    stage: str
    sha256: str
    size: int


def of_same_request(row: JobRow) -> ColumnElement[bool]:
    """The checkpoints a job may use: its own, and those of jobs of its workspace that asked for the very same.

    No others: a child reads hostile files, and what it kept must not reach a request that never saw them."""
    if row.fingerprint is None:  # accepted by an older server
        return JobCheckpointRow.job_id == row.id
    alike = select(JobRow.id).where(JobRow.workspace == row.workspace, JobRow.fingerprint == row.fingerprint)
    return or_(JobCheckpointRow.job_id == row.id, JobCheckpointRow.job_id.in_(alike))


def forget_checkpoints(session: Session, row: JobRow, *, of_all: bool) -> None:
    """Nobody needs those of this job any more, or `of_all` who asked for the same; the bytes go with the next sweep."""
    chosen = of_same_request(row) if of_all else JobCheckpointRow.job_id == row.id
    session.execute(delete(JobCheckpointRow).where(chosen))
