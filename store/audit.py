"""The audit log: who did what, when, and how it ended. It tells of acts and of refusals, never of secrets or contents."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from datetime import datetime, timedelta
from typing import Any
from uuid import uuid4

from sqlalchemy import delete, insert, select

from store.database import Database
from store.group_commit import LAST, GroupCommit
from store.key_text import without_secrets
from store.records import AuditRow
from store.storable import storable_text
from store.workspace import WorkspaceId

DONE = "done"


@dataclass(frozen=True, slots=True)
class AuditEntry:
    """actor: `key` (then `key_id`), `loopback` (a server without keys), `unknown` (refused), `admin:{user}` (the command line).

    outcome: `done`, or the code of the problem."""

    at: datetime
    actor: str
    key_id: str | None
    workspace: WorkspaceId | None
    action: str
    subject: str
    outcome: str
    request_id: str | None = None

    def describe(self) -> dict[str, Any]:
        """One line of JSON."""
        return {
            "at": self.at.isoformat(timespec="milliseconds"),
            "actor": self.actor,
            "key": self.key_id,
            "workspace": self.workspace,
            "action": _plain(self.action, 64),
            "subject": _plain(self.subject, 200),
            "outcome": self.outcome[:100],
            "request_id": self.request_id,
        }


class Audit:
    """The table; rows are added and, after their time, removed, never changed."""

    def __init__(self, db: Database, commits: GroupCommit | None = None) -> None:
        """With `commits` entries go with what others commit at the same moment."""
        self._db = db
        self._commits = commits

    def write(self, entries: Iterable[AuditEntry]) -> None:
        """All of them in one transaction."""
        rows = [
            {
                "id": str(uuid4()),
                "at": entry.at,
                "actor": _plain(entry.actor, 200),
                "key_id": entry.key_id,
                "workspace": entry.workspace,
                "action": _plain(entry.action, 64),
                "subject": _plain(entry.subject, 200),
                "outcome": entry.outcome[:100],
                "request_id": entry.request_id,
            }
            for entry in entries
        ]
        if rows and self._commits is not None:
            self._commits.run(lambda session: session.execute(insert(AuditRow), rows), LAST)
        elif rows:
            with self._db.session() as session:
                session.execute(insert(AuditRow), rows)

    def list(
        self, *, workspace: WorkspaceId | None = None, since: datetime | None = None, limit: int = 1000
    ) -> Sequence[AuditEntry]:
        """The newest first."""
        query = select(AuditRow).order_by(AuditRow.at.desc(), AuditRow.id).limit(limit)
        if workspace is not None:
            query = query.where(AuditRow.workspace == workspace)
        if since is not None:
            query = query.where(AuditRow.at >= since)
        with self._db.reading() as session:
            return [_entry(row) for row in session.scalars(query)]

    def last(self, action: str) -> datetime | None:
        """When this was done for the last time; None: not within the days the log is kept."""
        with self._db.reading() as session:
            query = select(AuditRow.at).where(AuditRow.action == action, AuditRow.outcome == DONE)
            return session.scalars(query.order_by(AuditRow.at.desc()).limit(1)).first()

    def sweep(self, days: float) -> int:
        """Forget what is older; returns how many."""
        with self._db.session() as session:
            before = self._db.now(session) - timedelta(days=days)
            gone = session.scalars(delete(AuditRow).where(AuditRow.at < before).returning(AuditRow.id))
            return len(gone.all())


def _plain(text: str, limit: int) -> str:
    return storable_text(without_secrets(text), limit)


def _entry(row: AuditRow) -> AuditEntry:
    return AuditEntry(
        at=row.at,
        actor=row.actor,
        key_id=row.key_id,
        workspace=None if row.workspace is None else WorkspaceId(row.workspace),
        action=row.action,
        subject=row.subject,
        outcome=row.outcome,
        request_id=row.request_id,
    )
