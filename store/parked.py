"""Requests that are refused because they took down their workers, until an operator releases them or they are old."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime, timedelta
from typing import Any

from sqlalchemy import bindparam, delete, select
from sqlalchemy.orm import Session

from core.errors import StateError
from store.database import Database
from store.lost_attempt import LostAttempt, lost_attempts
from store.records import JobRow, ParkedRow
from store.transition import owned
from store.workspace import WorkspaceId


@dataclass(frozen=True, slots=True)
class ParkedRequest:
    """One request. job_id: whose attempts were lost; evidence: each of them, kept even if that job is removed."""

    workspace: WorkspaceId
    fingerprint: str
    process: str
    job_id: str
    code: str
    evidence: tuple[Mapping[str, Any], ...]
    parked_at: datetime


def require_not_parked(session: Session, workspace: WorkspaceId, fingerprint: str | None) -> None:
    """Raises StateError `job.parked` with the job that has the evidence."""
    row = session.scalars(_PARKED, {"workspace": workspace, "fingerprint": fingerprint}).one_or_none()
    if row is not None:
        raise StateError(
            "job.parked",
            f"this request took down {len(row.evidence)} worker(s) or their children and is not tried again until an operator "
            f"releases it; the evidence is at /v1/jobs/{row.job_id}/attempts",
            job=row.job_id,
            attempts=len(row.evidence),
        )


_PARKED = select(ParkedRow).where(
    ParkedRow.workspace == bindparam("workspace"), ParkedRow.fingerprint == bindparam("fingerprint")
)


class Parked:
    """Thread-safe."""

    def __init__(self, db: Database) -> None:
        self._db = db

    def attempts(self, workspace: WorkspaceId, job_id: str) -> tuple[LostAttempt, ...]:
        """The lost attempts of a job. Raises StateError `job.not_found`."""
        with self._db.reading() as session:
            return lost_attempts(session, owned(session, workspace, job_id).id)

    def list(self, workspace: WorkspaceId | None = None) -> Sequence[ParkedRequest]:
        """The newest first; of all workspaces or one."""
        query = select(ParkedRow).order_by(ParkedRow.parked_at.desc(), ParkedRow.fingerprint)
        if workspace is not None:
            query = query.where(ParkedRow.workspace == workspace)
        with self._db.reading() as session:
            return [_request(row) for row in session.scalars(query)]

    def get(self, job_id: str) -> ParkedRequest:
        """By the job that was parked. Raises StateError `parked.not_found`."""
        with self._db.reading() as session:
            return _request(_row(session, job_id))

    def release(self, job_id: str) -> ParkedRequest:
        """Let the request be sent again. Raises StateError `parked.not_found`."""
        with self._db.session() as session:
            row = _row(session, job_id)
            session.delete(row)
            return _request(row)

    def sweep(self, days: float) -> int:
        """Forget those parked longer ago: whoever asks again may try; returns how many."""
        with self._db.session() as session:
            before = self._db.now(session) - timedelta(days=days)
            gone = session.scalars(delete(ParkedRow).where(ParkedRow.parked_at < before).returning(ParkedRow.job_id))
            return len(gone.all())


def _row(session: Session, job_id: str) -> ParkedRow:
    """Of that job, or of one that asked for the same."""
    asked = select(JobRow.fingerprint).where(JobRow.id == job_id).scalar_subquery()
    query = select(ParkedRow).where((ParkedRow.job_id == job_id) | (ParkedRow.fingerprint == asked))
    row = session.scalars(query.order_by(ParkedRow.job_id != job_id).limit(1)).first()
    if row is None:
        raise StateError("parked.not_found", f"no request is parked because of job {job_id}", job=job_id)
    return row


def _request(row: ParkedRow) -> ParkedRequest:
    return ParkedRequest(
        workspace=WorkspaceId(row.workspace),
        fingerprint=row.fingerprint,
        process=row.process,
        job_id=row.job_id,
        code=row.code,
        evidence=tuple(row.evidence),
        parked_at=row.parked_at,
    )
