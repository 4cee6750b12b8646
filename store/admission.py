"""From what waits to the job a worker runs next, in one transaction. The order is that of `store.choice`."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from datetime import datetime

from sqlalchemy import Row, and_, bindparam, exists, func, or_, select, update
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
                first = _first_fitting(session, head, limits[head.queue], room)
                if first is None:
                    continue
                row = take(session, first.id, first.attempt, worker, lease_s, now)
                if row is not None:
                    self._note_turn(session, head.workspace, now)
                    return snapshot(row)
        return None

    def _anything_waits(self) -> bool:
        with self._db.reading() as session:
            return bool(session.execute(_ANYTHING_WAITS).scalar_one())

    def _note_turn(self, session: Session, workspace: str, now: datetime) -> None:
        """A row somebody else holds says the same already: nobody waits for it."""
        served = {"workspace": workspace, "served_at": now}
        if session.execute(_NOTE_TURN, {"of": workspace, "at": now}).one_or_none() is None:
            insert = sqlite_insert if self._db.is_sqlite else postgresql_insert
            session.execute(insert(TurnRow).values(served).on_conflict_do_nothing())


# statements are made once: putting one together takes several times as long as carrying it out, and writers wait meanwhile
_ANYTHING_WAITS = select(exists().where(JobRow.status == JobStatus.ACCEPTED))
_RUNNING = select(JobRow.workspace, JobRow.queue, JobRow.lease_owner, JobRow.expected_memory_bytes).where(
    JobRow.status == JobStatus.RUNNING
)
_WAITING = aliased(JobRow)
_HEAD = (
    select(_WAITING.id)
    .where(_WAITING.workspace == WorkspaceRow.id, _WAITING.status == JobStatus.ACCEPTED, _WAITING.queue == bindparam("queue"))
    .order_by(_WAITING.queued_at, _WAITING.id)
    .limit(1)
    .correlate(WorkspaceRow)
    .scalar_subquery()
)
_HEADS = (
    select(JobRow.id, JobRow.workspace, JobRow.queued_at, JobRow.expected_memory_bytes, TurnRow.served_at)
    .select_from(WorkspaceRow)
    .join(JobRow, JobRow.id == _HEAD)
    .outerjoin(TurnRow, TurnRow.workspace == WorkspaceRow.id)
)
_FIRST = (
    select(JobRow.id, JobRow.attempt)
    .where(
        JobRow.workspace == bindparam("workspace"),
        JobRow.status == JobStatus.ACCEPTED,
        JobRow.queue == bindparam("queue"),
    )
    .order_by(JobRow.queued_at, JobRow.id)
    .limit(1)
    .with_for_update(skip_locked=True)
)
_FIRST_FITTING = _FIRST.where(JobRow.expected_memory_bytes <= bindparam("limit"))
_FREE_TURN = select(TurnRow.workspace).where(TurnRow.workspace == bindparam("of")).with_for_update(skip_locked=True)
_NOTE_TURN = (
    update(TurnRow)
    .where(TurnRow.workspace.in_(_FREE_TURN))
    .values(served_at=bindparam("at"))
    .returning(TurnRow.workspace)
    .execution_options(synchronize_session=False)
)


def _running(workspace: str, queue: str, owner: str | None, expected_bytes: int, room: Room) -> Running:
    host = str(owner).rpartition(":")[0]
    return Running(workspace, JobQueue(queue), host, room.need_bytes(expected_bytes))


def _heads(session: Session, queue: JobQueue, room: Room) -> list[Head]:
    """One look into the index per workspace, however many jobs wait in it."""
    return [
        Head(row.id, row.workspace, queue, row.queued_at, room.need_bytes(row.expected_memory_bytes), row.served_at)
        for row in session.execute(_HEADS, {"queue": queue})
    ]


def _anything_fits(session: Session, limits: Mapping[JobQueue, int]) -> bool:
    """Asked once where no head fits, instead of once for each workspace."""
    fits = or_(*(and_(JobRow.queue == queue, JobRow.expected_memory_bytes <= limit) for queue, limit in limits.items()))
    return bool(session.execute(select(exists().where(JobRow.status == JobStatus.ACCEPTED, fits))).scalar_one())


def _first_fitting(session: Session, head: Head, limit_bytes: int, room: Room) -> Row[str, int] | None:
    """(id, attempt) of the job of the head's workspace and queue that waits longest among those that fit and nobody is taking."""
    of = {"workspace": head.workspace, "queue": head.queue}
    if limit_bytes < room.job_memory_bytes:
        return session.execute(_FIRST_FITTING, {**of, "limit": limit_bytes}).one_or_none()
    return session.execute(_FIRST, of).one_or_none()  # whatever it is expected to need, it cannot need more


def _lock_of(host: str) -> int:
    """PostgreSQL's advisory locks have numbers of 64 bits for names."""
    return int.from_bytes(hashlib.sha256(f"integument host {host}".encode()).digest()[:8], signed=True)
