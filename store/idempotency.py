"""Idempotency keys: a request sent twice is done once (draft-ietf-httpapi-idempotency-key-header)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from datetime import datetime, timedelta
from typing import Any

from sqlalchemy import delete
from sqlalchemy.exc import IntegrityError
from sqlalchemy.orm import Session

from core.errors import StateError
from store.database import Database
from store.records import IdempotencyRow
from store.workspace import WorkspaceId


@dataclass(frozen=True, slots=True)
class Reply:
    """What was answered the first time."""

    status: int
    headers: Mapping[str, str]
    body: Any


class OvertakenError(Exception):
    """The same request was done by somebody else meanwhile: undo the work, and find his reply."""


class IdempotencyKeys:
    """`find`, and if there is nothing do the work and `keep` the reply in its transaction: there is never one without the other.

    Nothing is written down before the work is done, so a server that dies in the middle leaves no key behind. Each workspace has
    keys of its own."""

    def __init__(self, db: Database, hours: float = 24.0) -> None:
        self._db = db
        self._hours = hours

    def find(self, workspace: WorkspaceId, key: str, fingerprint: str) -> Reply | None:
        """The reply to the first request with this key; None if it is still to be done.

        `fingerprint` is a hash of method, path and body, up to 64 characters.

        Raises StateError `idempotency.mismatch` (same key, other request)."""
        with self._db.reading() as session:
            row = session.get(IdempotencyRow, (workspace, key))
            if row is None or self._is_free(row, self._db.now(session)):
                return None
            if row.fingerprint != fingerprint:
                raise StateError("idempotency.mismatch", "this Idempotency-Key was used for another request; use a new one")
            return Reply(**row.reply) if row.reply else None

    def keep(self, workspace: WorkspaceId, key: str, fingerprint: str, reply: Reply, session: Session) -> None:
        """Remember the reply in the transaction that does the work; of several at once the second waits for the first.

        Raises OvertakenError, which has to leave the block of `session`."""
        now = self._db.now(session)
        told = {"status": reply.status, "headers": dict(reply.headers), "body": reply.body}
        row = session.get(IdempotencyRow, (workspace, key), with_for_update=True)
        if row is not None:
            if not self._is_free(row, now):
                raise OvertakenError
            row.fingerprint, row.reply, row.created_at = fingerprint, told, now
            return
        session.add(IdempotencyRow(workspace=workspace, key=key, fingerprint=fingerprint, reply=told, created_at=now))
        try:
            session.flush()
        except IntegrityError:
            raise OvertakenError from None

    def _is_free(self, row: IdempotencyRow, now: datetime) -> bool:
        """Too old; or without a reply, as versions before this one left them when they were killed."""
        return row.reply is None or now - row.created_at > timedelta(hours=self._hours)

    def sweep(self) -> int:
        """Forget keys older than they are promised to be kept; returns how many."""
        with self._db.session() as session:
            before = self._db.now(session) - timedelta(hours=self._hours)
            removed = session.scalars(
                delete(IdempotencyRow).where(IdempotencyRow.created_at < before).returning(IdempotencyRow.key)
            )
            return len(removed.all())
