"""From what waits to the job a worker runs next, in one transaction. The order is that of `store.choice`."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from datetime import datetime

from sqlalchemy import Select, and_, exists, func, or_, select, update
from sqlalchemy.dialects.postgresql import insert as postgresql_insert
from sqlalchemy.dialects.sqlite import insert as sqlite_insert
from sqlalchemy.orm import Session, aliased

from core.schema.expectation import JobQueue
from store.choice import Head, Room, Running, in_turn, largest_admitted
from store.database import Database
from store.job import Job, JobStatus
from store.records import JobRow, TurnRow, WorkspaceRow
from store.taking import take
from store.transition import snapshot


class Admission:
    """The side of the job table that hands out work."""

    def __init__(self, db: Database) -> None:
        self._db = db

    def claim_next(self, worker: str, lease_s: float, room: Room) -> Job | None:
        """The job whose turn it is among those that fit, for `lease_s`; None if there is none.

        Processes of one host take turns here, so that they cannot both use what is left of its memory; hosts do not wait for each
        other: a job another one is just taking is passed over."""
        if not room.free or not self._anything_waits():
            return None
        with self._db.session() as session:
            if not self._db.is_sqlite:
                session.execute(select(func.pg_advisory_xact_lock(_lock_of(room.host))))
            now = self._db.now(session)
            running = [_running(*told, room=room) for told in session.execute(_RUNNING)]
            heads = [head for queue in sorted(room.queues) for head in _heads(session, queue, room)]
            limits = largest_admitted(room, heads, running, now)
            due = [head for head in in_turn(heads, running) if head.queue in limits]
            fits = any(head.need_bytes <= limits[head.queue] for head in due)
            if not due or not (fits or _anything_fits(session, limits)):
                return None
            for head in due:
                first = session.execute(_first_fitting(head, limits[head.queue], room)).one_or_none()
                if first is None:
                    continue
                row = take(session, first.id, first.attempt, worker, lease_s, now)
                if row is not None:
                    self._note_turn(session, head.workspace, now)
                    return snapshot(row)
        return None

    def _anything_waits(self) -> bool:
        with self._db.reading() as session:
            return bool(session.execute(select(exists().where(JobRow.status == JobStatus.ACCEPTED))).scalar_one())

    def _note_turn(self, session: Session, workspace: str, now: datetime) -> None:
        """A row somebody else holds says the same already: nobody waits for it."""
        free = select(TurnRow.workspace).where(TurnRow.workspace == workspace).with_for_update(skip_locked=True)
        noted = update(TurnRow).where(TurnRow.workspace.in_(free)).values(served_at=now).returning(TurnRow.workspace)
        if session.scalars(noted).one_or_none() is None:
            insert = sqlite_insert if self._db.is_sqlite else postgresql_insert
            session.execute(insert(TurnRow).values(workspace=workspace, served_at=now).on_conflict_do_nothing())


_RUNNING = select(JobRow.workspace, JobRow.queue, JobRow.lease_owner, JobRow.expected_memory_bytes).where(
    JobRow.status == JobStatus.RUNNING
)


def _running(workspace: str, queue: str, owner: str | None, expected_bytes: int, room: Room) -> Running:
    host = str(owner).rpartition(":")[0]
    return Running(workspace, JobQueue(queue), host, room.need_bytes(expected_bytes))


def _heads(session: Session, queue: JobQueue, room: Room) -> list[Head]:
    """One look into the index per workspace, however many jobs wait in it."""
    waiting = aliased(JobRow)
    first = (
        select(waiting.id)
        .where(waiting.workspace == WorkspaceRow.id, waiting.status == JobStatus.ACCEPTED, waiting.queue == queue)
        .order_by(waiting.queued_at, waiting.id)
        .limit(1)
        .correlate(WorkspaceRow)
        .scalar_subquery()
    )
    told = session.execute(
        select(JobRow.id, JobRow.workspace, JobRow.queued_at, JobRow.expected_memory_bytes, TurnRow.served_at)
        .select_from(WorkspaceRow)
        .join(JobRow, JobRow.id == first)
        .outerjoin(TurnRow, TurnRow.workspace == WorkspaceRow.id)
    )
    return [
        Head(row.id, row.workspace, queue, row.queued_at, room.need_bytes(row.expected_memory_bytes), row.served_at)
        for row in told
    ]


def _anything_fits(session: Session, limits: Mapping[JobQueue, int]) -> bool:
    """Asked once where no head fits, instead of once for each workspace."""
    fits = or_(*(and_(JobRow.queue == queue, JobRow.expected_memory_bytes <= limit) for queue, limit in limits.items()))
    return bool(session.execute(select(exists().where(JobRow.status == JobStatus.ACCEPTED, fits))).scalar_one())


def _first_fitting(head: Head, limit_bytes: int, room: Room) -> Select[str, int]:
    """Of the head's workspace and queue, the job that waits longest among those that fit and nobody else is taking."""
    query = select(JobRow.id, JobRow.attempt).where(
        JobRow.workspace == head.workspace, JobRow.status == JobStatus.ACCEPTED, JobRow.queue == head.queue
    )
    if limit_bytes < room.job_memory_bytes:  # else whatever it is expected to need, it cannot need more
        query = query.where(JobRow.expected_memory_bytes <= limit_bytes)
    return query.order_by(JobRow.queued_at, JobRow.id).limit(1).with_for_update(skip_locked=True)


def _lock_of(host: str) -> int:
    """PostgreSQL's advisory locks have numbers of 64 bits for names."""
    return int.from_bytes(hashlib.sha256(f"integument host {host}".encode()).digest()[:8], signed=True)
