"""The table of callbacks. One deliverer at a time holds a row, and a deliverer whose lease ran out changes nothing."""

from __future__ import annotations

from collections.abc import Mapping
from datetime import datetime, timedelta

from sqlalchemy import Select, func, or_, select, update
from sqlalchemy.orm import Session, aliased

from store.callback import Callback, CallbackEvent, CallbackState
from store.database import Database
from store.metric_family import CALLBACKS_ENDED
from store.metrics import note
from store.records import CallbackRow
from store.storable import storable_text
from store.tally import Tally
from store.transition import owned
from store.workspace import WorkspaceId

MAX_ERROR = 500


class Callbacks:
    """Thread-safe. Rows are written by `store.outbox` and go with their job."""

    def __init__(self, db: Database) -> None:
        self._db = db

    def of_job(self, workspace: WorkspaceId, job_id: str) -> tuple[Callback, ...]:
        """In the order they came about. Raises StateError `job.not_found`."""
        with self._db.reading() as session:
            owned(session, workspace, job_id)
            rows = session.scalars(
                select(CallbackRow).where(CallbackRow.job_id == job_id).order_by(CallbackRow.created_at, CallbackRow.id)
            )
            return tuple(_callback(row) for row in rows)

    def count(self) -> Mapping[CallbackState, int]:
        """How many of all workspaces wait, and how many were given up; the delivered ones, ever more, are not looked at."""
        counted = (CallbackState.PENDING, CallbackState.DEAD)
        query = select(CallbackRow.state, func.count()).where(CallbackRow.state.in_(counted)).group_by(CallbackRow.state)
        with self._db.reading() as session:
            found = session.execute(query).all()
        return dict.fromkeys(counted, 0) | {CallbackState(state): number for state, number in found}

    def any_due(self) -> bool:
        """Whether `claim` is worth a writing transaction."""
        with self._db.reading() as session:
            return session.scalars(_due(self._db.now(session)).limit(1)).first() is not None

    def claim(self, lease_s: float, max_attempts: int) -> Callback | None:
        """Take one that is due for `lease_s`, and count the attempt; None if there is none.

        Workspaces with fewer deliveries under way come first: receivers that do not answer hold up their own. A callback whose
        deliverer died in its last attempt is given up here, and nothing is taken."""
        with self._db.session() as session:
            now = self._db.now(session)
            other = aliased(CallbackRow)
            under_way = (
                select(func.count())
                .where(other.workspace == CallbackRow.workspace, other.lease_until >= now)
                .correlate(CallbackRow)
                .scalar_subquery()
            )
            row = session.scalars(
                _due(now)
                .order_by(under_way, CallbackRow.due_at, CallbackRow.id)
                .limit(1)
                .with_for_update(of=CallbackRow, skip_locked=True)
            ).first()
            if row is None:
                return None
            if row.attempts >= max_attempts:
                _end(session, row, CallbackState.DEAD)
                row.ended_at, row.last_error = now, "the deliverer was lost in the last attempt"
                return None
            row.attempts += 1
            row.lease_token += 1
            row.lease_until = now + timedelta(seconds=lease_s)
            return _callback(row)

    def deliver(self, callback: Callback, status: int) -> bool:
        """Answered by 2xx. False if the lease was lost meanwhile."""
        return self._settle(callback, CallbackState.DELIVERED, status, None)

    def bury(self, callback: Callback, status: int | None, error: str) -> bool:
        """Give it up. False if the lease was lost meanwhile."""
        return self._settle(callback, CallbackState.DEAD, status, error)

    def put_off(self, callback: Callback, status: int | None, error: str, wait_s: float) -> bool:
        """Try again later. False if the lease was lost meanwhile."""
        with self._db.session() as session:
            row = _held(session, callback)
            if row is None:
                return False
            row.lease_until, row.due_at = None, self._db.now(session) + timedelta(seconds=wait_s)
            row.last_status, row.last_error = status, storable_text(error, MAX_ERROR)
            return True

    def replay(self, workspace: WorkspaceId, job_id: str) -> int:
        """Let everything of a job that was given up be tried again from the start; returns how many.

        Raises StateError `job.not_found`."""
        with self._db.session() as session:
            owned(session, workspace, job_id)
            again = update(CallbackRow).where(CallbackRow.job_id == job_id, CallbackRow.state == CallbackState.DEAD)
            values = {"state": CallbackState.PENDING, "attempts": 0, "due_at": self._db.now(session), "ended_at": None}
            return len(session.scalars(again.values(**values).returning(CallbackRow.id)).all())

    def _settle(self, callback: Callback, state: CallbackState, status: int | None, error: str | None) -> bool:
        with self._db.session() as session:
            row = _held(session, callback)
            if row is None:
                return False
            _end(session, row, state)
            row.ended_at = self._db.now(session)
            row.last_status, row.last_error = status, None if error is None else storable_text(error, MAX_ERROR)
            return True


def _due(now: datetime) -> Select[CallbackRow]:
    """Those to be sent whom no living deliverer holds."""
    return select(CallbackRow).where(
        CallbackRow.state == CallbackState.PENDING,
        CallbackRow.due_at <= now,
        or_(CallbackRow.lease_until.is_(None), CallbackRow.lease_until < now),
    )


def _held(session: Session, callback: Callback) -> CallbackRow | None:
    """The locked row if the claim that gave out `callback` still holds it."""
    return session.scalars(
        select(CallbackRow)
        .where(
            CallbackRow.id == callback.id,
            CallbackRow.lease_token == callback.lease_token,
            CallbackRow.state == CallbackState.PENDING,
            CallbackRow.lease_until.is_not(None),
        )
        .with_for_update()
    ).one_or_none()


def _end(session: Session, row: CallbackRow, state: CallbackState) -> None:
    row.state, row.lease_until = state, None
    tally = Tally()
    tally.count(CALLBACKS_ENDED, state.value)
    note(session, tally)


def _callback(row: CallbackRow) -> Callback:
    return Callback(
        id=row.id,
        workspace=WorkspaceId(row.workspace),
        job_id=row.job_id,
        event=CallbackEvent(row.event),
        uri=row.uri,
        body=row.body,
        state=CallbackState(row.state),
        attempts=row.attempts,
        lease_token=row.lease_token,
        created_at=row.created_at,
        due_at=row.due_at,
        ended_at=row.ended_at,
        last_status=row.last_status,
        last_error=row.last_error,
    )
