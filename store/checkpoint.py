"""The output of one step of a job, kept as a blob until the job has succeeded."""

from __future__ import annotations

from dataclasses import dataclass

from sqlalchemy import BindParameter, ColumnElement, bindparam, delete, exists, or_, select
from sqlalchemy.orm import Session

from store.job import JobStatus
from store.records import JobCheckpointRow, JobInputRow, JobRow

Value = str | BindParameter[str]
CORRECTED = 8  # failed requests that one may go on from


@dataclass(frozen=True, slots=True)
class Checkpoint:
    """key: SHA-256 of all that decides about the bytes, see `core.processes.checkpoints.key`; the bytes themselves are a blob."""

    key: str
    stage: str
    sha256: str
    size: int


def of_same_request(row: JobRow) -> ColumnElement[bool]:
    """The checkpoints of a job, and of jobs of its workspace that asked for the very same."""
    if row.fingerprint is None:  # accepted by an older server
        return JobCheckpointRow.job_id == row.id
    return _of_alike(row.id, row.workspace, row.fingerprint)


def _of_alike(job_id: Value, workspace: Value, fingerprint: Value) -> ColumnElement[bool]:
    alike = select(JobRow.id).where(JobRow.workspace == workspace, JobRow.fingerprint == fingerprint)
    return or_(JobCheckpointRow.job_id == job_id, JobCheckpointRow.job_id.in_(alike))


def usable_by(row: JobRow) -> ColumnElement[bool]:
    """The checkpoints a job may use: those of the same request, and those of jobs it corrects: of its workspace and process,
    failed, and with no file that it does not read itself.

    No others: a child reads hostile files, and what it kept must not reach a request that never saw them. Only the last
    `CORRECTED` of them, since all are fetched before it is known which fit."""
    read = {mesh.sha256 for mesh in row.mesh_inputs}
    if not read:
        return of_same_request(row)
    has_steps = exists().where(JobCheckpointRow.job_id == JobRow.id)
    other_file = exists().where(JobInputRow.job_id == JobRow.id, JobInputRow.sha256.not_in(read))
    corrected = (
        select(JobRow.id)
        .where(JobRow.workspace == row.workspace, JobRow.process == row.process, JobRow.status == JobStatus.FAILED)
        .where(has_steps, exists().where(JobInputRow.job_id == JobRow.id), ~other_file)
        .order_by(JobRow.finished_at.desc())
        .limit(CORRECTED)
    )
    return or_(of_same_request(row), JobCheckpointRow.job_id.in_(corrected))


def forget_checkpoints(session: Session, row: JobRow, *, of_all: bool) -> None:
    """Nobody needs those of this job any more, or `of_all` who asked for the same; the bytes go with the next sweep."""
    if of_all and row.fingerprint is not None:
        session.execute(_FORGET_ALIKE, {"of": row.id, "of_workspace": row.workspace, "asked": row.fingerprint})
    else:
        session.execute(_FORGET, {"of": row.id})


# made once: see `store.admission`
_FORGET = delete(JobCheckpointRow).where(JobCheckpointRow.job_id == bindparam("of")).execution_options(synchronize_session=False)
_FORGET_ALIKE = (
    delete(JobCheckpointRow)
    .where(_of_alike(bindparam("of"), bindparam("of_workspace"), bindparam("asked")))
    .execution_options(synchronize_session=False)
)
