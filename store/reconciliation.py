"""What puts right what workers, brokers and power cuts left behind. Safe to run in several places at once."""

from __future__ import annotations

import math
import time
from collections.abc import Iterable
from datetime import datetime, timedelta

from sqlalchemy import or_, select, tuple_, update
from sqlalchemy.orm import Session

from core.errors import InternalError
from store.database import Database
from store.job import Job, JobFailure, JobStatus
from store.job_tally import count_expiry
from store.larger_need import larger_need
from store.lost_attempt import LastWords, park_if_deadly, record_loss
from store.records import JobRow
from store.transition import end_dismissed, end_failed, queue_again, snapshot

HEAD_OF_QUEUE = 100  # of a long queue only those next in line are announced again, or the broker would fill with copies


class Reconciliation:
    """The reconciler's side of the job table."""

    def __init__(self, db: Database) -> None:
        self._db = db

    def due_to_ring(self, older_than_s: float) -> list[tuple[str, int]]:
        """(job id, attempt) of accepted jobs never announced, and of those next in line announced longer ago than that."""
        with self._db.reading() as session:
            before = self._db.now(session) - timedelta(seconds=older_than_s)
            head = (
                select(JobRow.id, JobRow.attempt, JobRow.rung_at)
                .where(JobRow.status == JobStatus.ACCEPTED)
                .order_by(JobRow.queued_at, JobRow.id)
                .limit(HEAD_OF_QUEUE)
                .subquery()
            )
            waiting = session.execute(
                select(head.c.id, head.c.attempt).where(or_(head.c.rung_at.is_(None), head.c.rung_at < before))
            ).all()
            unheard = session.execute(
                select(JobRow.id, JobRow.attempt)
                .where(JobRow.status == JobStatus.ACCEPTED, JobRow.rung_at.is_(None))
                .order_by(JobRow.queued_at, JobRow.id)
                .limit(HEAD_OF_QUEUE)
            ).all()
            return list(dict.fromkeys((str(job_id), int(attempt)) for job_id, attempt in [*waiting, *unheard]))

    def mark_all_rung(self, attempts: Iterable[tuple[str, int]], session: Session | None = None) -> None:
        """The messages of these (job id, attempt) are with the broker: in one transaction, or in that of `session`.

        Who is just being taken is left out: nobody waits for a worker here."""
        waiting = select(JobRow.id).where(
            tuple_(JobRow.id, JobRow.attempt).in_(list(attempts)), JobRow.status == JobStatus.ACCEPTED
        )
        with self._db.session(session) as work:
            rung = update(JobRow).where(JobRow.id.in_(waiting.with_for_update(skip_locked=True)))
            work.execute(rung.values(rung_at=self._db.now(work)), execution_options={"synchronize_session": False})

    def expire_leases(self, now: datetime | None = None, within_s: float = math.inf) -> list[Job]:
        """Take jobs from workers that fell silent: queue them again, or fail those out of attempts with `worker.lost`.

        Nobody if the database takes longer than `within_s` to tell the time: while it hung nobody could renew his lease."""
        asked_at = time.monotonic()
        with self._db.session() as session:
            moment = now or self._db.now(session)
            return self._expire(session, moment, moment) if time.monotonic() - asked_at <= within_s else []

    def expire_all_leases(self, *, worker_crashed: bool = False) -> list[Job]:
        """The same for every running job, where no worker is alive: in a service that has its database for itself.

        Unless its worker alone crashed, no request is parked: a power cut is no evidence against any."""
        with self._db.session() as session:
            return self._expire(session, self._db.now(session), None, may_park=worker_crashed)

    def _expire(self, session: Session, now: datetime, lapsed_at: datetime | None, *, may_park: bool = True) -> list[Job]:
        lapsed = select(JobRow).where(JobRow.status == JobStatus.RUNNING).order_by(JobRow.id)
        if lapsed_at is not None:
            lapsed = lapsed.where(JobRow.lease_until < lapsed_at)
        rows = session.scalars(lapsed.with_for_update(skip_locked=True)).all()
        for row in rows:
            count_expiry(session, row)
            if not row.dismiss_requested:
                record_loss(session, row, "worker.lost", "its worker fell silent", LastWords(), now)
            if row.dismiss_requested:
                end_dismissed(session, row, now)
            elif row.attempt < row.max_attempts:
                row.expected_memory_bytes = larger_need(row.expected_memory_bytes, _lost(row), None)
                queue_again(session, row, row.attempt + 1, f"worker of attempt {row.attempt} was lost", now)
            else:
                end_failed(session, row, _lost(row), now)
                if may_park:
                    park_if_deadly(session, row, "worker.lost", now)
        return [snapshot(row) for row in rows]


def _lost(row: JobRow) -> JobFailure:
    error = InternalError(
        "worker.lost",
        f"{row.attempt} worker(s) died while running this job; it is not tried again by itself",
        attempts=row.attempt,
        worker=str(row.lease_owner),
    )
    return JobFailure.of(error)
