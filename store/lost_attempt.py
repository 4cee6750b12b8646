"""What is known of an attempt that took its worker or its child down: the evidence against an input."""

from __future__ import annotations

from dataclasses import dataclass
from datetime import datetime
from typing import Any

from sqlalchemy import func, select
from sqlalchemy.orm import Session

from store.records import JobAttemptRow, JobRow, ParkedRow
from store.storable import storable_text

DEADLY = frozenset({"worker.lost", "child.crashed", "nursery.lost"})
"""Failures that an input may cause by taking down what works on it."""

ENOUGH = 2  # losses after which an input is parked, even if a job may be tried more often
MAX_LOG = 8_000


@dataclass(frozen=True, slots=True)
class LastWords:
    """What a worker that outlived the child can add. phase: the child's last; signal: SIGSEGV; log: the end of its log."""

    phase: str | None = None
    signal: str | None = None
    peak_memory_bytes: int | None = None
    log: str = ""


@dataclass(frozen=True, slots=True)
class LostAttempt:
    """One attempt that ended in a crash. phase, progress: how far it was; worker: host and process."""

    attempt: int
    worker: str
    code: str
    message: str
    signal: str | None
    phase: str
    progress: float
    peak_memory_bytes: int | None
    log: str
    started_at: datetime | None
    ended_at: datetime

    def describe(self) -> dict[str, Any]:
        """Plain JSON; times in ISO 8601."""
        return {
            "attempt": self.attempt,
            "worker": self.worker,
            "code": self.code,
            "message": self.message,
            "signal": self.signal,
            "phase": self.phase,
            "progress": self.progress,
            "peak_memory_bytes": self.peak_memory_bytes,
            "log": self.log,
            "started_at": None if self.started_at is None else self.started_at.isoformat(),
            "ended_at": self.ended_at.isoformat(),
        }


def record_loss(session: Session, row: JobRow, code: str, message: str, words: LastWords, now: datetime) -> None:
    """To be called while the row still says who held it."""
    session.merge(
        JobAttemptRow(
            job_id=row.id,
            attempt=row.attempt,
            worker=row.lease_owner or "",
            code=code,
            message=storable_text(message),
            signal=words.signal,
            phase=row.phase if words.phase is None else storable_text(words.phase),
            progress=row.progress,
            peak_memory_bytes=words.peak_memory_bytes or row.peak_memory_bytes,
            log=storable_text(words.log, MAX_LOG),
            started_at=row.started_at,
            ended_at=now,
        )
    )


def lost_attempts(session: Session, job_id: str) -> tuple[LostAttempt, ...]:
    """In their order."""
    rows = session.scalars(select(JobAttemptRow).where(JobAttemptRow.job_id == job_id).order_by(JobAttemptRow.attempt))
    return tuple(
        LostAttempt(
            attempt=row.attempt,
            worker=row.worker,
            code=row.code,
            message=row.message,
            signal=row.signal,
            phase=row.phase,
            progress=float(row.progress),
            peak_memory_bytes=row.peak_memory_bytes,
            log=row.log,
            started_at=row.started_at,
            ended_at=row.ended_at,
        )
        for row in rows
    )


def park_if_deadly(session: Session, row: JobRow, code: str, now: datetime) -> None:
    """Refuse the same request from now on, if its job just failed because its attempts were lost."""
    if code not in DEADLY or row.fingerprint is None:
        return
    session.flush()
    count = select(func.count()).select_from(JobAttemptRow).where(JobAttemptRow.job_id == row.id)
    if session.execute(count).scalar_one() < min(ENOUGH, row.max_attempts):
        return
    evidence = [attempt.describe() for attempt in lost_attempts(session, row.id)]
    session.merge(
        ParkedRow(
            workspace=row.workspace,
            fingerprint=row.fingerprint,
            process=row.process,
            job_id=row.id,
            code=code,
            evidence=evidence,
            parked_at=now,
        )
    )
