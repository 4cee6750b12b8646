"""What a worker may do with a job. Every write names the fencing token of its claim; a stale one changes nothing."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from datetime import datetime, timedelta

from sqlalchemy import select
from sqlalchemy.orm import Session

from store.announcement import NewEvent, append_events
from store.database import Database
from store.job import Job, JobFailure, JobOutput, JobStatus
from store.larger_need import larger_need
from store.lost_attempt import DEADLY, LastWords, park_if_deadly, record_loss
from store.records import JobRow
from store.storable import storable, storable_text
from store.taking import take
from store.transition import (
    end,
    end_dismissed,
    end_failed,
    held,
    keep_outputs,
    queue_again,
    snapshot,
)


@dataclass(frozen=True, slots=True)
class Renewal:
    """`kept` False: the job belongs to somebody else now, kill the child and forget it."""

    kept: bool
    dismiss_requested: bool


NOTHING_SAID = LastWords()
LOST = Renewal(kept=False, dismiss_requested=False)


class Claims:
    """The worker's side of the job table."""

    def __init__(self, db: Database) -> None:
        self._db = db

    def claim(self, job_id: str, attempt: int, worker: str, lease_s: float) -> Job | None:
        """Take this accepted job for `lease_s`, whoever's turn it is; None if it is taken, gone, or waits for another attempt."""
        with self._db.session() as session:
            row = take(session, job_id, attempt, worker, lease_s, self._db.now(session))
            return None if row is None else snapshot(row)

    def renew(
        self,
        job_id: str,
        token: int,
        lease_s: float,
        progress: float | None = None,
        phase: str | None = None,
        message: str | None = None,
        events: Iterable[NewEvent] = (),
        peak_memory_bytes: int | None = None,
    ) -> Renewal:
        """Keep the lease and say how far the job is; what is None stays as it was.

        A change appends a `progress` event (after `events`). Progress never goes back within one attempt. The memory is all that
        is known of an attempt whose worker is lost."""
        with self._db.session() as session:
            row = held(session, job_id, token)
            if row is None:
                return LOST
            now = self._db.now(session)
            _hear(session, row, now, progress, phase, message, events)
            row.peak_memory_bytes = peak_memory_bytes or row.peak_memory_bytes
            row.lease_until = now + timedelta(seconds=lease_s)
            return Renewal(kept=True, dismiss_requested=row.dismiss_requested)

    def append_events(self, job_id: str, token: int, events: Iterable[NewEvent]) -> bool:
        """Add (type, data) events, `log` mostly; False if the lease is lost."""
        with self._db.session() as session:
            row = held(session, job_id, token)
            if row is None:
                return False
            append_events(session, row, events, self._db.now(session))
            return True

    def finish(
        self,
        job_id: str,
        token: int,
        *,
        verdict: str,
        summary: str,
        outputs: Mapping[str, JobOutput],
        timings_s: Mapping[str, float],
        peak_memory_bytes: int | None = None,
        progress: float | None = None,
        phase: str | None = None,
        message: str | None = None,
        events: Iterable[NewEvent] = (),
    ) -> bool:
        """Record success, and before it what was said last, as `renew` does; the blobs must be stored already.

        False if the lease is lost, or the user dismissed the job meanwhile: then it is recorded as dismissed. True, and nothing
        is written, if this very claim has recorded it before: the answer to that may have been lost on its way."""
        with self._db.session() as session:
            row = held(session, job_id, token)
            if row is None:
                return _has_finished(session, job_id, token)
            now = self._db.now(session)
            if row.dismiss_requested:
                end_dismissed(session, row, now)
                return False
            _hear(session, row, now, progress, phase, message, events)
            row.verdict, row.summary, row.progress = verdict, storable_text(summary), 100.0
            row.timings_s, row.peak_memory_bytes = storable(dict(timings_s)), peak_memory_bytes
            keep_outputs(row, outputs)
            end(session, row, JobStatus.SUCCESSFUL, summary, now)
            return True

    def fail(
        self,
        job_id: str,
        token: int,
        failure: JobFailure,
        *,
        outputs: Mapping[str, JobOutput] | None = None,
        timings_s: Mapping[str, float] | None = None,
        peak_memory_bytes: int | None = None,
        retry: bool = False,
        last_words: LastWords = NOTHING_SAID,
    ) -> Job | None:
        """Record a failure with the report it left. With `retry` and attempts left, the job is queued again instead.

        A failure that took down the child is kept as evidence with its `last_words`; the last one parks the request.

        Returns the job as it is now, dismissed if the user asked for that meanwhile; None if the lease is lost."""
        with self._db.session() as session:
            row = held(session, job_id, token)
            if row is None:
                return None
            now = self._db.now(session)
            if failure.code in DEADLY and not row.dismiss_requested:
                record_loss(session, row, failure.code, failure.message, last_words, now)
            row.expected_memory_bytes = larger_need(row.expected_memory_bytes, failure, peak_memory_bytes)
            if row.dismiss_requested:
                end_dismissed(session, row, now)
            elif retry and row.attempt < row.max_attempts:
                queue_again(session, row, row.attempt + 1, f"attempt {row.attempt} failed: {failure.message}", now)
            else:
                row.timings_s, row.peak_memory_bytes = storable(dict(timings_s or {})), peak_memory_bytes
                keep_outputs(row, outputs or {})
                end_failed(session, row, failure, now)
                park_if_deadly(session, row, failure.code, now)
            return snapshot(row)

    def release(self, job_id: str, token: int) -> bool:
        """Hand the job back unharmed, as when the worker is told to stop: the attempt does not count."""
        with self._db.session() as session:
            row = held(session, job_id, token)
            if row is None:
                return False
            now = self._db.now(session)
            if row.dismiss_requested:
                end_dismissed(session, row, now)
            else:
                queue_again(session, row, row.attempt, "worker is stopping, waits for another", now)
            return True

    def is_held(self, job_id: str, token: int) -> bool:
        """True while the attempt with this fencing token runs."""
        with self._db.reading() as session:
            held_now = select(JobRow.id).where(
                JobRow.id == job_id, JobRow.lease_token == token, JobRow.status == JobStatus.RUNNING
            )
            return session.scalars(held_now).one_or_none() is not None

    def confirm_dismissed(self, job_id: str, token: int) -> bool:
        """The child is dead, as the user asked. False if the lease is lost or nobody asked."""
        with self._db.session() as session:
            row = held(session, job_id, token)
            if row is None or not row.dismiss_requested:
                return False
            end_dismissed(session, row, self._db.now(session))
            return True


def _hear(
    session: Session,
    row: JobRow,
    now: datetime,
    progress: float | None,
    phase: str | None,
    message: str | None,
    events: Iterable[NewEvent],
) -> None:
    """Append the events, and one of type `progress` if anything has changed."""
    append_events(session, row, events, now)
    before = (row.progress, row.phase, row.message)
    if progress is not None:
        row.progress = max(row.progress, min(max(float(progress), 0.0), 100.0))
    row.phase = row.phase if phase is None else storable_text(phase)
    row.message = row.message if message is None else storable_text(message)
    if before != (row.progress, row.phase, row.message):
        data = {"progress": row.progress, "phase": row.phase, "message": row.message}
        append_events(session, row, [("progress", data)], now)


def _has_finished(session: Session, job_id: str, token: int) -> bool:
    finished = (JobRow.id == job_id, JobRow.lease_token == token, JobRow.status == JobStatus.SUCCESSFUL)
    return session.scalars(select(JobRow.id).where(*finished)).one_or_none() is not None
