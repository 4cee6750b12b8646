"""Idempotency keys: a request sent twice is done once (draft-ietf-httpapi-idempotency-key-header)."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from datetime import timedelta
from typing import Any

from sqlalchemy import delete
from sqlalchemy.exc import IntegrityError
from sqlalchemy.orm import Session

from core.errors import StateError
from store.database import Database
from store.records import IdempotencyRow
from store.workspace import WorkspaceId

IN_FLIGHT_S = 600.0  # a request without a reply after this long died with its server


@dataclass(frozen=True, slots=True)
class Reply:
    """What was answered the first time."""

    status: int
    headers: Mapping[str, str]
    body: Any


class IdempotencyKeys:
    """`begin`, do the work, `complete` in the transaction of the work; `abandon` if it failed.

    Each workspace has keys of its own."""

    def __init__(self, db: Database, hours: float = 24.0) -> None:
        self._db = db
        self._hours = hours

    def begin(self, workspace: WorkspaceId, key: str, fingerprint: str) -> Reply | None:
        """None: go on, the key is yours. A Reply: send it again.

        `fingerprint` is a hash of method, path and body, up to 64 characters.

        Raises StateError `idempotency.mismatch` (same key, other request) or `idempotency.in_flight`."""
        try:
            with self._db.session() as session:
                now = self._db.now(session)
                session.add(IdempotencyRow(workspace=workspace, key=key, fingerprint=fingerprint, reply=None, created_at=now))
        except IntegrityError:
            return self._meet(workspace, key, fingerprint)
        return None

    def _meet(self, workspace: WorkspaceId, key: str, fingerprint: str) -> Reply | None:
        with self._db.session() as session:
            row = session.get(IdempotencyRow, (workspace, key), with_for_update=True)
            now = self._db.now(session)
            if row is None:
                raise StateError("idempotency.in_flight", "a request with this Idempotency-Key just ended; send it again")
            age = now - row.created_at
            abandoned = row.reply is None and age > timedelta(seconds=IN_FLIGHT_S)
            if abandoned or age > timedelta(hours=self._hours):
                row.fingerprint, row.reply, row.created_at = fingerprint, None, now
                return None
            if row.fingerprint != fingerprint:
                raise StateError("idempotency.mismatch", "this Idempotency-Key was used for another request; use a new one")
            if row.reply is None:
                raise StateError("idempotency.in_flight", "the first request with this Idempotency-Key is still at work")
            return Reply(**row.reply)

    def complete(self, workspace: WorkspaceId, key: str, reply: Reply, *, session: Session | None = None) -> None:
        """Remember the reply. Pass the `session` that makes the resource: then there is never one without the other."""
        with self._db.session(session) as work:
            row = work.get(IdempotencyRow, (workspace, key), with_for_update=True)
            if row is not None:
                row.reply = {"status": reply.status, "headers": dict(reply.headers), "body": reply.body}

    def abandon(self, workspace: WorkspaceId, key: str) -> None:
        """Forget a request that failed, so that it may be sent again."""
        with self._db.session() as session:
            session.execute(
                delete(IdempotencyRow).where(
                    IdempotencyRow.workspace == workspace, IdempotencyRow.key == key, IdempotencyRow.reply.is_(None)
                )
            )

    def sweep(self) -> int:
        """Forget keys older than they are promised to be kept; returns how many."""
        with self._db.session() as session:
            before = self._db.now(session) - timedelta(hours=self._hours)
            removed = session.scalars(
                delete(IdempotencyRow).where(IdempotencyRow.created_at < before).returning(IdempotencyRow.key)
            )
            return len(removed.all())
